// The top-level tree (TLAS) over mesh instances: a binary tree whose leaves are instances with trees of their own. Slab
// tests err only towards a hit, as in variants/bvh/box_ray.h (Ize, "Robust BVH Ray Traversal", JCGT 2 (2), 2013); the
// rounding that an instance's own space adds is in the bounding boxes and in `margin`.
#pragma once

#include "kernels/math.h"

namespace pt {

// A node of the top-level tree (TLAS). It holds both children's bounding boxes, so that one read decides on two.
struct alignas(16) ObjectNode {
    float low_x[2], high_x[2], low_y[2], high_y[2], low_z[2], high_z[2];
    std::uint32_t link[2];  // number of a child node, or leaf_bit and the index of a mesh instance
    std::uint32_t unused[2];

    static constexpr std::uint32_t leaf_bit = 0x80000000u;
    PT_HD static constexpr bool is_leaf(std::uint32_t link) { return (link & leaf_bit) != 0; }
};
static_assert(sizeof(ObjectNode) == 64);

struct ObjectTree {
    const ObjectNode* nodes = nullptr;  // nodes of the tree over mesh instances, root first
    std::uint32_t node_count = 0;
    float margin = 0;  // growth of the tree's boxes for rounding, in multiples of the ray origin's largest coordinate

    // Size of the traversal stack: each inner node on the way to the deepest leaf leaves one child on it.
    static constexpr std::uint32_t most_levels = 64;
};

template <class Real>
struct ObjectTreeRay {
    Vec3<Real> near_origin, far_origin;  // origins for entry and exit planes, shifted by the tree's margin for rounding
    Vec3<Real> inverse;                  // reciprocal ray direction; infinite along axes on which the ray does not move

    PT_HD static ObjectTreeRay of(const Vec3<Real>& origin, const Vec3<Real>& direction, float margin) {
        const Real largest = max(absolute(origin.x), max(absolute(origin.y), absolute(origin.z)));
        const Real shift = static_cast<Real>(margin) * largest;
        ObjectTreeRay ray{origin, origin, {Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z}};
        for (int axis = 0; axis < 3; ++axis) {
            const Real along = ray.inverse[axis] < Real(0) ? -shift : shift;
            ray.near_origin[axis] += along;
            ray.far_origin[axis] -= along;
        }
        return ray;
    }

    // Ray parameter, at least 0, at which the ray enters a child's bounding box, or `no_entry` if it misses the box or
    // enters it beyond best_t (not at best_t). A NaN (0 * infinity, on a side's plane) is ignored.
    static constexpr Real no_entry = Real(-1);
    PT_HD Real entry(const ObjectNode& node, int child, const Real& best_t) const {
        Real nearest = Real(0), farthest = best_t;
        const auto cut = [&](float low, float high, int axis) {
            const bool is_reversed = inverse[axis] < Real(0);
            const Real in = static_cast<Real>(is_reversed ? high : low);
            const Real out = static_cast<Real>(is_reversed ? low : high);
            nearest = keep_larger(nearest, (in - near_origin[axis]) * inverse[axis]);
            farthest = keep_smaller(farthest, (out - far_origin[axis]) * inverse[axis]);
        };
        cut(node.low_x[child], node.high_x[child], 0);
        cut(node.low_y[child], node.high_y[child], 1);
        cut(node.low_z[child], node.high_z[child], 2);
        // The entry distance is lowered by the rounding errors of the slab test and of a hit triangle's t.
        nearest = nearest * (Real(1) - gamma<Real>(16));
        return nearest <= farthest ? nearest : no_entry;
    }
};

// Traverses the top-level tree, nearer child first: calls meet(object) for all instances that the ray may hit no
// farther than best_t, which `meet` may lower.
template <class Real, class Meet>
PT_HD inline void traverse(const ObjectTree& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                           const Real& best_t, Meet&& meet) {
    if (tree.node_count == 0) {
        return;
    }
    const auto ray = ObjectTreeRay<Real>::of(origin, direction, tree.margin);
    std::uint32_t link_stack[ObjectTree::most_levels];
    Real entry_stack[ObjectTree::most_levels];
    std::uint32_t waiting = 0, link = 0;
    while (true) {
        if (ObjectNode::is_leaf(link)) {
            meet(link & ~ObjectNode::leaf_bit);
        } else {
            const ObjectNode& node = tree.nodes[link];
            const Real left = ray.entry(node, 0, best_t), right = ray.entry(node, 1, best_t);
            const bool meets_left = left >= Real(0), meets_right = right >= Real(0);
            if (meets_left && meets_right) {
                const std::uint32_t nearer = right < left ? 1u : 0u;
                link_stack[waiting] = node.link[1u - nearer];
                entry_stack[waiting++] = nearer == 0 ? right : left;
                link = node.link[nearer];
                continue;
            }
            if (meets_left || meets_right) {
                link = node.link[meets_left ? 0 : 1];
                continue;
            }
        }
        do {
            if (waiting == 0) {
                return;
            }
            link = link_stack[--waiting];
        } while (entry_stack[waiting] > best_t);
    }
}

}  // namespace pt
