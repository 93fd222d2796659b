// The accelerator bvh2: a binary tree of 64-byte nodes with both children's bounding boxes, so that one read decides on
// two; the nearer child comes first. Aila and Laine, "Understanding the Efficiency of Ray Traversal on GPUs", 2009.
#pragma once

#include "kernels/math.h"
#include "variants/bvh/box_ray.h"
#include "variants/bvh/encoded_tree.h"
#include "variants/bvh/walk.h"

namespace pt::accelerator::bvh2 {

struct alignas(16) Node {
    float low_x[2], high_x[2], low_y[2], high_y[2], low_z[2], high_z[2];  // bounding boxes of the two children
    std::uint32_t link[2];  // links to the two children, as in variants/bvh/link.h
    std::uint32_t padding[2];
};
static_assert(sizeof(Node) == 64);

// Entries of the traversal stack: each inner node on the way to the deepest leaf leaves one child on the stack.
inline constexpr std::uint32_t stack_size = 64;

#if !defined(__CUDACC_RTC__)
// Encodes a binary tree as bvh2 nodes. Throws std::length_error for one too deep, too large, or with too large leaves.
EncodedTree encode(const BinaryTree& tree);
#endif

template <class Real>
PT_HD inline BoxRay<Real> box_ray(const Node& root, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const BoxSpan spans[3] = {{min(root.low_x[0], root.low_x[1]), max(root.high_x[0], root.high_x[1])},
                              {min(root.low_y[0], root.low_y[1]), max(root.high_y[0], root.high_y[1])},
                              {min(root.low_z[0], root.low_z[1]), max(root.high_z[0], root.high_z[1])}};
    return BoxRay<Real>::of(origin, direction, spans);
}

template <class Real>
PT_HD inline Real child_entry(const Node& node, int child, const BoxRay<Real>& ray, const Real& best_t) {
    const Vec3<Real> low{Real(node.low_x[child]), Real(node.low_y[child]), Real(node.low_z[child])};
    const Vec3<Real> high{Real(node.high_x[child]), Real(node.high_y[child]), Real(node.high_z[child])};
    const bool x = ray.is_reversed(0), y = ray.is_reversed(1), z = ray.is_reversed(2);
    return ray.entry({x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z},
                     {x ? low.x : high.x, y ? low.y : high.y, z ? low.z : high.z}, best_t);
}

// Calls leaf(first_slot, count) for each leaf that the ray enters before best_t, nearer child first. The callback may
// lower best_t to a closer hit; a best_t below 0 ends the traversal.
template <class Real, class Leaf, class Counter>
PT_HD void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction, const Real& best_t,
                    Leaf&& leaf, Counter& counter) {
    if (tree.node_count == 0) {
        return;
    }
    const Node* nodes = static_cast<const Node*>(tree.nodes);
    const BoxRay<Real> ray = box_ray(nodes[0], origin, direction);
    std::uint32_t link_stack[stack_size];
    Real entry_stack[stack_size];
    std::uint32_t waiting = 0, link = 0;
    while (true) {
        if (is_leaf_link(link)) {
            counter.primitives(slot_count(link));
            leaf(first_slot(link), slot_count(link));
        } else {
            const Node& node = nodes[link];
            counter.node();
            counter.boxes(2);
            const Real left = child_entry(node, 0, ray, best_t), right = child_entry(node, 1, ray, best_t);
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

template <class Real>
class Walk : public LinkWalk<Real> {
public:
    static constexpr std::uint32_t most_open = stack_size;

    Walk() = default;
    PT_HD Walk(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction)
        : nodes_(static_cast<const Node*>(tree.nodes)), ray_(box_ray(nodes_[0], origin, direction)) {
        this->link_ = 0;
    }

    template <class Stack, class Counter>
    PT_HD void visit_node(const Real& best_t, Stack& stack, Counter& counter) {
        const Node& node = nodes_[this->link_];
        counter.node();
        counter.boxes(2);
        const Real left = child_entry(node, 0, ray_, best_t), right = child_entry(node, 1, ray_, best_t);
        const bool meets_left = left >= Real(0), meets_right = right >= Real(0);
        if (meets_left && meets_right) {
            const std::uint32_t nearer = right < left ? 1u : 0u;
            const OpenLink<Real> further{nearer == 0 ? right : left, node.link[1u - nearer]};
            this->link_ = stack.enters_nearer(further) ? node.link[nearer] : further.link;
        } else if ((meets_left || meets_right) && stack.enters_only_child()) {
            this->link_ = node.link[meets_left ? 0 : 1];
        } else {
            this->take_open(best_t, stack);
        }
    }

private:
    const Node* nodes_;
    BoxRay<Real> ray_;
};

struct Traversal {
    static constexpr bool is_chosen_at_run_time = false;
    template <class Real>
    using Walk = bvh2::Walk<Real>;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                               const Real& best_t, Leaf&& leaf, Counter& counter) {
        bvh2::traverse(tree, origin, direction, best_t, leaf, counter);
    }
};

}  // namespace pt::accelerator::bvh2

#if defined(PT_HOST)

#include "variants/bvh/binary_nodes.h"
#include "variants/bvh/encoding.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh2 {

EncodedTree encode(const BinaryTree& tree) {
    require_encodable(tree, stack_size);
    const auto link_of = [](const BinaryTree::Node& leaf) { return leaf_link(leaf.first, leaf.count); };
    return encoded(binary_nodes<Node>(tree, link_of), tree.references);
}

namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh2",
        .summary = "binary tree, 64-byte nodes with both children's boxes",
        .origin = "Aila and Laine 2009",
        .traits = AcceleratorTraits{.checks_large_scenes = true, .has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = accelerator_hook<Traversal>(encode)});

}  // namespace

}  // namespace pt::accelerator::bvh2

#endif
