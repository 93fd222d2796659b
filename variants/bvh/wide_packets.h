// Wide trees on the host for packets of rays. All lanes are prepared at once; the rays that may enter the root then go
// through the tree one by one or, in a tree too large for the caches near a core, by turns: while a ray waits for its
// next node, others are at work. Each ray visits what it visits alone.
#pragma once

#include "variants/bvh/wide_lanes.h"
#include "variants/cpu/lanes.h"

namespace pt::lanes {

// The rays of a packet in the space of a mesh, with the numbers of MeshRay and BoxRay, one ray a lane.
struct MeshRays {
    Vectors<float> origin, direction, along, shear;
    Lanes<std::uint32_t> kx, ky, kz;
    Vectors<float> near_origin, far_origin, inverse;
    Flags enters;  // whether the lane's ray may enter the root of the tree

    MeshRay<float> ray(std::uint32_t l, std::uint32_t object, std::uint32_t passed_over) const {
        return {origin[l], direction[l], {kx[l], ky[l], kz[l], shear[l]}, along[l], object, passed_over};
    }
    BoxRay<float> box_ray(std::uint32_t l) const { return {near_origin[l], far_origin[l], inverse[l]}; }
};

// Takes a packet's rays into a mesh's space by the operations of MeshRay::of, in their order, with no branch.
template <bool is_placed>
inline void to_mesh(MeshRays& rays, const MeshInstance<float>& instance, const Vectors<float>& origin,
                    const Vectors<float>& direction) {
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < lanes::width; ++l) {
        const Vec3<float> o = is_placed ? origin[l] : instance.point_in(origin[l]);
        const Vec3<float> d = is_placed ? direction[l] : instance.direction_in(direction[l]);
        const Vec3<float> size{absolute(d.x), absolute(d.y), absolute(d.z)};
        // The axis kz as in ShearedDirection::of: that of a direction's largest component, of equal ones the later.
        const float before_z = size.x > size.y ? size.x : size.y;
        const bool is_z = !(before_z > size.z);
        const bool is_x = (before_z > size.z) & (size.x > size.y);
        // The axes kx, ky and kz of ShearedDirection are xyz, yzx or zxy.
        const auto turned = [&](const Vec3<float>& v) {
            return Vec3<float>{is_z   ? v.x
                               : is_x ? v.y
                                      : v.z,
                               is_z   ? v.y
                               : is_x ? v.z
                                      : v.x,
                               is_z   ? v.z
                               : is_x ? v.x
                                      : v.y};
        };
        const Vec3<float> turned_direction = turned(d);
        rays.origin.set(l, o);
        rays.direction.set(l, d);
        rays.along.set(l, turned(o));
        rays.shear.set(l, {turned_direction.x / turned_direction.z, turned_direction.y / turned_direction.z,
                           1.0f / turned_direction.z});
        rays.kx[l] = is_z ? 0u : is_x ? 1u : 2u;
        rays.ky[l] = is_z ? 1u : is_x ? 2u : 0u;
        rays.kz[l] = is_z ? 2u : is_x ? 0u : 1u;
    }
}

// Prepares a packet's rays for box tests as BoxRay::of does, and finds those that may enter the tree's root.
inline void to_boxes(MeshRays& rays, const BoxSpan (&spans)[3], const Hits<float>& hits) {
    const Vec3<float> low{spans[0].low, spans[1].low, spans[2].low}, high{spans[0].high, spans[1].high, spans[2].high};
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < lanes::width; ++l) {
        const Vec3<float> o = rays.origin[l], d = rays.direction[l], shear = rays.shear[l];
        const Vec3<float> reach{max(absolute(low.x - o.x), absolute(high.x - o.x)),
                                max(absolute(low.y - o.y), absolute(high.y - o.y)),
                                max(absolute(low.z - o.z), absolute(high.z - o.z))};
        const std::uint32_t kx = rays.kx[l], kz = rays.kz[l];
        const float along = kz == 0 ? reach.x : kz == 1 ? reach.y : reach.z;
        const Vec3<float> inverse{1.0f / d.x, 1.0f / d.y, 1.0f / d.z};
        const auto shift = [&](std::uint32_t axis, float reach_along, float from, float inverse_along) {
            const float sheared = absolute(axis == kx ? shear.x : shear.y) * along;
            const float margin = gamma<float>(8) * (reach_along + sheared) + gamma<float>(2) * absolute(from);
            const float directed = inverse_along < 0.0f ? -margin : margin;
            return axis == kz ? 0.0f : directed;
        };
        const Vec3<float> shifts{shift(0, reach.x, o.x, inverse.x), shift(1, reach.y, o.y, inverse.y),
                                 shift(2, reach.z, o.z, inverse.z)};
        const Vec3<float> near = o + shifts, far = o - shifts;
        float nearest = 0.0f, farthest = hits.t[l];
        const auto cut = [&](float low_side, float high_side, float from_near, float from_far, float inverse_along) {
            const bool is_reversed = inverse_along < 0.0f;
            const float in = is_reversed ? high_side : low_side, out = is_reversed ? low_side : high_side;
            nearest = keep_larger(nearest, (in - from_near) * inverse_along);
            farthest = keep_smaller(farthest, (out - from_far) * inverse_along);
        };
        cut(low.x, high.x, near.x, far.x, inverse.x);
        cut(low.y, high.y, near.y, far.y, inverse.y);
        cut(low.z, high.z, near.z, far.z, inverse.z);
        rays.near_origin.set(l, near);
        rays.far_origin.set(l, far);
        rays.inverse.set(l, inverse);
        rays.enters[l] = nearest * (1.0f - gamma<float>(16)) <= farthest ? 1u : 0u;
    }
}

// A ray's traversal that stops after each node and each leaf, so that several rays take turns: while one waits for its
// next node to come from memory, the others are at work.
template <int width>
class Walk {
public:
    void start(const Mesh<width>& mesh, const MeshRay<float>& ray, const BoxRay<float>& box_ray, const Hit<float>& best,
               float enough) {
        mesh_ = &mesh;
        ray_ = ray;
        box_ray_ = box_ray;
        for (int axis = 0; axis < 3; ++axis) {
            near_row_[axis] = 2 * axis + (box_ray.is_reversed(axis) ? 1 : 0);
        }
        best_ = best;
        enough_ = enough;
        top_ = stack_;
        link_ = 0;
    }
    const Hit<float>& best() const { return best_; }

    // Visits a node or a leaf of the tree for one ray. Returns whether there is more to visit.
    bool step() {
        if (is_leaf_link(link_)) {
            meet_leaf(best_, mesh_->blocks.data(), link_, TriangleLanes::of(ray_), ray_);
            return !NearerThan<float>{enough_}.end_if_met(best_) && take_waiting();
        }
        return visit(mesh_->nodes[link_]) || take_waiting();
    }

private:
    // Goes to the nearest child that the ray enters, and stacks the others. Returns false if the ray enters none.
    bool visit(const Node<width>& node) {
        alignas(sizeof(Floats<width>)) float entries[width];
        const std::uint32_t found = entered(node, *reinterpret_cast<Floats<width>*>(entries));
        if (found == 0) {
            return false;
        }
        go_to(take_nearest<width>(found, entries, node, top_));
        return true;
    }
    // BoxRay::entry for every child of a node: sets `entries` to the distances; returns a mask of the children entered.
    std::uint32_t entered(const Node<width>& node, Floats<width>& entries) const {
        Floats<width> nearest{}, farthest = broadcast<width>(best_.t);
        for (int axis = 0; axis < 3; ++axis) {
            const Floats<width> inverse = broadcast<width>(box_ray_.inverse[axis]);
            const Floats<width> in =
                (loaded<width>(node.side[near_row_[axis]]) - broadcast<width>(box_ray_.near_origin[axis])) * inverse;
            const Floats<width> out =
                (loaded<width>(node.side[near_row_[axis] ^ 1]) - broadcast<width>(box_ray_.far_origin[axis])) * inverse;
            nearest = in > nearest ? in : nearest;
            farthest = out < farthest ? out : farthest;
        }
        entries = nearest * (1.0f - gamma<float>(16));
        return bits_of<width>(entries <= farthest);
    }
    bool take_waiting() {
        do {
            if (top_ == stack_) {
                return false;
            }
            --top_;
        } while (top_->entry() > best_.t);
        go_to(top_->link());
        return true;
    }
    void go_to(std::uint32_t link) {
        link_ = link;
        const bool is_leaf = is_leaf_link(link);
        const auto* const from = is_leaf ? reinterpret_cast<const char*>(&mesh_->blocks[first_slot(link)])
                                         : reinterpret_cast<const char*>(&mesh_->nodes[link]);
        for (std::size_t line = 0; line < (is_leaf ? sizeof(TriangleBlock) : sizeof(Node<width>)); line += 64) {
            __builtin_prefetch(from + line);
        }
    }

    const Mesh<width>* mesh_;
    MeshRay<float> ray_;
    BoxRay<float> box_ray_;
    int near_row_[3];
    Hit<float> best_;
    float enough_;
    std::uint32_t link_;
    Waiting* top_;
    Waiting stack_[wide_stack_size<width>];
};

// Number of rays that traverse a tree by turns, and bytes above which a tree is too large for caches near a core.
inline constexpr std::uint32_t walks_at_once = 8;
inline constexpr std::size_t most_bytes_at_hand = 1u << 19;

template <int width>
class PacketSearch {
public:
    PacketSearch(Hits<float>& hits, const Flags& asks, const MeshInstance<float>& instance, std::uint32_t object,
                 const Vectors<float>& origin, const Paths<float>& paths, const Lanes<float>& enough)
        : hits_(hits), paths_(paths), enough_(enough), mesh_(mesh_of<Mesh<width>>(instance)), object_(object) {
        instance.is_placed != 0 ? to_mesh<true>(rays_, instance, origin, paths.direction)
                                : to_mesh<false>(rays_, instance, origin, paths.direction);
        to_boxes(rays_, mesh_.spans, hits);
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            rays_.enters[l] &= asks[l];
        }
    }

    void in_turn() {
        for (const std::uint32_t l : LaneList(rays_.enters)) {
            Hit<float> best = hits_[l];
            traverse(best, mesh_, ray(l), rays_.box_ray(l), enough_[l]);
            hits_.set(l, best);
        }
    }
    void by_turns() {
        Walk<width> walks[walks_at_once];
        std::uint32_t lane[walks_at_once], place[walks_at_once];
        const LaneList list(rays_.enters);
        const std::uint32_t* next = list.begin();
        std::uint32_t active = 0;
        const auto start = [&](std::uint32_t i) {
            lane[i] = *next++;
            walks[place[i]].start(mesh_, ray(lane[i]), rays_.box_ray(lane[i]), hits_[lane[i]], enough_[lane[i]]);
        };
        for (; active < walks_at_once && next != list.end(); ++active) {
            place[active] = active;
            start(active);
        }
        while (active != 0) {
            for (std::uint32_t i = 0; i < active;) {
                if (walks[place[i]].step()) {
                    ++i;
                    continue;
                }
                hits_.set(lane[i], walks[place[i]].best());
                if (next != list.end()) {
                    start(i++);
                } else {
                    --active;
                    std::swap(place[i], place[active]);
                    lane[i] = lane[active];
                }
            }
        }
    }

private:
    MeshRay<float> ray(std::uint32_t l) const {
        const bool starts_here = SurfaceId{paths_.origin_surface[l]}.is_of(object_);
        return rays_.ray(l, object_, starts_here ? paths_.primitive[l] : MeshRay<float>::nothing);
    }

    Hits<float>& hits_;
    const Paths<float>& paths_;
    const Lanes<float>& enough_;
    const Mesh<width>& mesh_;
    const std::uint32_t object_;
    MeshRays rays_;
};

template <int width>
void meet_in_lanes(Hits<float>& hits, const Flags& asks, const MeshInstance<float>& instance, std::uint32_t object,
                   const Vectors<float>& origin, const Paths<float>& rays, const Lanes<float>& enough) {
    const auto& mesh = mesh_of<Mesh<width>>(instance);
    if (!mesh.nodes.empty()) {
        PacketSearch<width> search(hits, asks, instance, object, origin, rays, enough);
        mesh.bytes() > most_bytes_at_hand ? search.by_turns() : search.in_turn();
    }
}

template <int width>
NativeMesh prepare(const EncodedTree& tree, std::span<const LeafTriangle> leaves) {
    const std::span nodes{reinterpret_cast<const WideNode<width>*>(tree.nodes.data()), tree.node_count};
    const auto mesh = std::make_shared<Mesh<width>>(MeshBuilder<width>(nodes, leaves).build());
    mesh->meet_in_lanes = &meet_in_lanes<width>;
    return {mesh, mesh->bytes()};
}

// The functions of an accelerator on the host. `Traversal` is for rays in double, and for one tree over all objects.
template <int width, class Traversal>
AcceleratorHook accelerator_hook(EncodedTree (*encode)(const BinaryTree& tree)) {
    return {encode,
            &prepare<width>,
            &meet_mesh<width>,
            &pt::meet_mesh<Traversal, double>,
            &pt::meet_flat<Traversal, float>,
            &pt::meet_flat<Traversal, double>};
}

}  // namespace pt::lanes
