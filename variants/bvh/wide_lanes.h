// Wide trees on the host: one ray against all boxes of a node, or four triangles of a leaf, in one vector. Only what
// certainly misses is left out; the triangles that remain take the one test (kernels/triangle.h), so the bits stay.
// Wald, Benthin, Boulos, "Getting Rid of Packets", RT 2008; boxes and stack as in Wald et al., "Embree", SIGGRAPH 2014.
#pragma once

#include <bit>
#include <limits>
#include <vector>

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "kernels/intersect.h"
#include "variants/bvh/hooks.h"
#include "variants/bvh/wide_nodes.h"
#include "variants/cpu/lanes.h"

namespace pt::lanes {

// GNU vectors (g++, clang): an operation is one of each lane, by IEEE; a comparison is -1 or 0 in each.
template <int width>
struct VectorOf {
    typedef float Floats __attribute__((vector_size(width * sizeof(float))));
    typedef std::int32_t Truths __attribute__((vector_size(width * sizeof(float))));
};
template <int width>
using Floats = typename VectorOf<width>::Floats;
template <int width>
using Truths = typename VectorOf<width>::Truths;

template <int width>
inline Floats<width> broadcast(float value) {
    return Floats<width>{} + value;
}
template <int width>
inline Floats<width> loaded(const float* from) {
    return *reinterpret_cast<const Floats<width>*>(from);
}
// The lanes' truth values as a mask, one bit a lane.
template <int width>
inline std::uint32_t bits_of(const Truths<width>& truths) {
#if defined(__AVX__)
    if constexpr (width == 8) {
        return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(truths)));
    } else if constexpr (width == 4) {
        return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(truths)));
    }
#endif
    std::uint32_t bits = 0;
    for (int lane = 0; lane < width; ++lane) {
        bits |= (truths[lane] != 0 ? 1u : 0u) << lane;
    }
    return bits;
}

// Up to four triangles of a leaf by axis, vertex and lane, so that a ray's permutation of the axes chooses rows.
inline constexpr int block_width = 4;
struct alignas(32) TriangleBlock {
    float row[3][3][block_width];
    std::uint32_t primitive[block_width];
};
static_assert(sizeof(TriangleBlock) == 160);

// Aligned for whole vectors. A leaf's link holds the number of its first block and its count of triangles.
template <int width>
struct alignas(64) Node : WideNode<width> {};

template <int width>
struct Mesh : HostMesh {
    std::vector<Node<width>> nodes;
    std::vector<TriangleBlock> blocks;
    BoxSpan spans[3];  // of the root
};

inline void set_lane(TriangleBlock& block, std::uint32_t lane, const LeafTriangle& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
        block.row[axis][0][lane] = leaf.row[axis].a;
        block.row[axis][1][lane] = leaf.row[axis].b;
        block.row[axis][2][lane] = leaf.row[axis].c;
    }
    block.primitive[lane] = leaf.primitive();
}
inline LeafTriangle triangle_in(const TriangleBlock& block, std::uint32_t lane) {
    const auto row = [&](int axis) {
        return LeafTriangle::Row{block.row[axis][0][lane], block.row[axis][1][lane], block.row[axis][2][lane],
                                 block.primitive[lane]};
    };
    return {{row(0), row(1), row(2)}};
}

// The slots of triangles that one block takes: a leaf's, or a whole subtree's if it has no more than a block holds.
struct BlockSlots {
    std::uint32_t count = 0;  // 0: more than a block's
    std::uint32_t slot[block_width];

    // Adds `slots` slots; false if there would be more than a block holds.
    bool take(std::uint32_t first, std::uint32_t slots) {
        if (count + slots > block_width) {
            return false;
        }
        for (std::uint32_t i = 0; i < slots; ++i) {
            slot[count++] = first + i;
        }
        return true;
    }
};

// For each node the slots of its subtree where they fit one block: then the block's test costs less than the visit of
// the node. The root is never taken so.
template <int width>
std::vector<BlockSlots> subtrees_of_a_block(std::span<const WideNode<width>> nodes) {
    std::vector<BlockSlots> fits(nodes.size());
    const auto gather = [&](const WideNode<width>& node) {
        BlockSlots all;
        for (int child = 0; child < width && node.has_child(child); ++child) {
            const std::uint32_t link = node.link[child];
            if (is_leaf_link(link)) {
                if (!all.take(first_slot(link), slot_count(link))) {
                    return BlockSlots{};
                }
            } else {
                const BlockSlots& below = fits[link];
                if (below.count == 0 || all.count + below.count > block_width) {
                    return BlockSlots{};
                }
                for (std::uint32_t i = 0; i < below.count; ++i) {
                    all.slot[all.count++] = below.slot[i];
                }
            }
        }
        return all;
    };
    for (std::size_t i = nodes.size(); i-- > 1;) {  // an inner child has a larger number than its parent
        fits[i] = gather(nodes[i]);
    }
    return fits;
}

template <int width>
void meet_in_lanes(Hits<float>& hits, const Flags& asks, const MeshInstance<float>& instance, std::uint32_t object,
                   const Vectors<float>& origin, const Paths<float>& rays, const Lanes<float>& enough);

// Builds the host's tree from the one that the device gets: leaves become blocks of triangles, and small subtrees
// become leaves.
template <int width>
class MeshBuilder {
public:
    MeshBuilder(std::span<const WideNode<width>> nodes, std::span<const LeafTriangle> leaves)
        : nodes_(nodes), leaves_(leaves), fits_(subtrees_of_a_block<width>(nodes)), number_(nodes.size()) {}

    Mesh<width> build() {
        mesh_.meet_in_lanes = &meet_in_lanes<width>;
        for (int axis = 0; axis < 3 && !nodes_.empty(); ++axis) {
            mesh_.spans[axis] = nodes_[0].span(axis);
        }
        std::uint32_t kept = 0;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            number_[i] = fits_[i].count == 0 ? kept++ : 0;
        }
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (fits_[i].count == 0) {
                mesh_.nodes.push_back({nodes_[i]});
                for (int child = 0; child < width && nodes_[i].has_child(child); ++child) {
                    mesh_.nodes.back().link[child] = new_link(nodes_[i].link[child]);
                }
            }
        }
        return std::move(mesh_);
    }

private:
    std::uint32_t new_link(std::uint32_t link) {
        const auto first_block = static_cast<std::uint32_t>(mesh_.blocks.size());
        if (is_leaf_link(link)) {
            for (std::uint32_t i = 0; i < slot_count(link); ++i) {
                add(i, first_slot(link) + i);
            }
            return leaf_link(first_block, slot_count(link));
        }
        const BlockSlots& whole = fits_[link];
        for (std::uint32_t i = 0; i < whole.count; ++i) {
            add(i, whole.slot[i]);
        }
        return whole.count != 0 ? leaf_link(first_block, whole.count) : number_[link];
    }
    void add(std::uint32_t i, std::uint32_t slot) {
        if (i % block_width == 0) {
            mesh_.blocks.emplace_back();
        }
        set_lane(mesh_.blocks.back(), i % block_width, leaves_[slot]);
    }

    std::span<const WideNode<width>> nodes_;
    std::span<const LeafTriangle> leaves_;
    std::vector<BlockSlots> fits_;
    std::vector<std::uint32_t> number_;
    Mesh<width> mesh_;
};

template <int width>
NativeMesh prepare(const EncodedTree& tree, std::span<const LeafTriangle> leaves) {
    const std::span nodes{reinterpret_cast<const WideNode<width>*>(tree.nodes.data()), tree.node_count};
    const auto mesh = std::make_shared<const Mesh<width>>(MeshBuilder<width>(nodes, leaves).build());
    const std::uint64_t bytes = mesh->nodes.size() * sizeof(Node<width>) + mesh->blocks.size() * sizeof(TriangleBlock);
    return {mesh, bytes};
}

// What the box tests of a ray need, one lane a child; the numbers are BoxRay's.
template <int width>
struct BoxLanes {
    Floats<width> near_origin[3], far_origin[3], inverse[3];
    int near_row[3], far_row[3];

    static BoxLanes of(const BoxRay<float>& ray) {
        BoxLanes lanes;
        for (int axis = 0; axis < 3; ++axis) {
            lanes.near_origin[axis] = broadcast<width>(ray.near_origin[axis]);
            lanes.far_origin[axis] = broadcast<width>(ray.far_origin[axis]);
            lanes.inverse[axis] = broadcast<width>(ray.inverse[axis]);
            lanes.near_row[axis] = 2 * axis + (ray.is_reversed(axis) ? 1 : 0);
            lanes.far_row[axis] = 2 * axis + (ray.is_reversed(axis) ? 0 : 1);
        }
        return lanes;
    }

    // BoxRay::entry of every child: where it enters, and a bit for each that it does.
    std::uint32_t entered(const Node<width>& node, float best_t, Floats<width>& entries) const {
        Floats<width> nearest{}, farthest = broadcast<width>(best_t);
        for (int axis = 0; axis < 3; ++axis) {
            const Floats<width> in = (loaded<width>(node.side[near_row[axis]]) - near_origin[axis]) * inverse[axis];
            const Floats<width> out = (loaded<width>(node.side[far_row[axis]]) - far_origin[axis]) * inverse[axis];
            nearest = in > nearest ? in : nearest;
            farthest = out < farthest ? out : farthest;
        }
        entries = nearest * (1.0f - gamma<float>(16));
        return bits_of<width>(entries <= farthest);
    }
};

// What the triangle tests of a ray need, one lane a triangle.
struct TriangleLanes {
    using Lane = Floats<block_width>;
    Lane origin[3], shear_x, shear_y;  // the origin along kx, ky, kz
    std::uint32_t axis[3];

    static TriangleLanes of(const MeshRay<float>& ray) {
        const ShearedDirection<float>& s = ray.sheared;
        TriangleLanes lanes{
            {}, broadcast<block_width>(s.shear.x), broadcast<block_width>(s.shear.y), {s.kx, s.ky, s.kz}};
        for (int i = 0; i < 3; ++i) {
            lanes.origin[i] = broadcast<block_width>(component_of(ray.origin, lanes.axis[i]));
        }
        return lanes;
    }

    // A bit for each triangle whose rounded edge functions are not of both signs, none being zero: the first
    // operations of `intersect`, which turns all others away.
    std::uint32_t candidates(const TriangleBlock& block) const {
        Lane x[3], y[3];
        for (int k = 0; k < 3; ++k) {
            const Lane z = loaded<block_width>(block.row[axis[2]][k]) - origin[2];
            x[k] = (loaded<block_width>(block.row[axis[0]][k]) - origin[0]) - shear_x * z;
            y[k] = (loaded<block_width>(block.row[axis[1]][k]) - origin[1]) - shear_y * z;
        }
        const Lane u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
        const Lane zero{};
        const auto below = (u < zero) | (v < zero) | (w < zero), above = (u > zero) | (v > zero) | (w > zero),
                   at_zero = (u == zero) | (v == zero) | (w == zero);
        return bits_of<block_width>(~(below & above) | at_zero);
    }
};

struct Waiting {
    std::uint64_t of;  // the entry's bits above the link: both are not negative, so the nearer is the smaller number

    static Waiting make(float entry, std::uint32_t link) {
        return {static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(entry)) << 32 | link};
    }
    float entry() const { return std::bit_cast<float>(static_cast<std::uint32_t>(of >> 32)); }
    std::uint32_t link() const { return static_cast<std::uint32_t>(of); }
};

inline void meet_leaf(Hit<float>& best, const TriangleBlock* blocks, std::uint32_t link, const TriangleLanes& lanes,
                      const MeshRay<float>& ray) {
    const TriangleBlock* block = blocks + first_slot(link);
    for (std::uint32_t left = slot_count(link);; left -= block_width, ++block) {
        std::uint32_t found = lanes.candidates(*block);
        found &= left < block_width ? (1u << left) - 1u : (1u << block_width) - 1u;
        for (; found != 0; found &= found - 1u) {
            meet_triangle(best, triangle_in(*block, static_cast<std::uint32_t>(std::countr_zero(found))), ray);
        }
        if (left <= block_width) {
            return;
        }
    }
}

// Takes one ray through the tree.
template <int width>
inline void traverse(Hit<float>& best, const Mesh<width>& mesh, const MeshRay<float>& ray, const BoxRay<float>& box_ray,
                     float enough) {
    const Node<width>* nodes = mesh.nodes.data();
    const auto boxes = BoxLanes<width>::of(box_ray);
    const TriangleLanes triangles = TriangleLanes::of(ray);
    Waiting stack[wide_stack_size<width>];
    Waiting* top = stack;
    std::uint32_t link = 0;
    while (true) {
        while (!is_leaf_link(link)) {
            const Node<width>& node = nodes[link];
            alignas(sizeof(Floats<width>)) float entries[width];
            std::uint32_t found = boxes.entered(node, best.t, *reinterpret_cast<Floats<width>*>(entries));
            if (found == 0) {
                break;
            }
            const auto take = [&] {
                const auto child = static_cast<std::uint32_t>(std::countr_zero(found));
                found &= found - 1u;
                return Waiting::make(entries[child], node.link[child]);
            };
            Waiting nearest = take();
            if (found == 0) {
                link = nearest.link();
                continue;
            }
            Waiting* const bottom = top;
            while (found != 0) {
                Waiting next = take();
                if (next.of < nearest.of) {
                    std::swap(next, nearest);
                }
                Waiting* at = top++;  // the nearest on top
                for (; at > bottom && at[-1].of < next.of; --at) {
                    *at = at[-1];
                }
                *at = next;
            }
            link = nearest.link();
        }
        if (is_leaf_link(link)) {
            meet_leaf(best, mesh.blocks.data(), link, triangles, ray);
            if (NearerThan<float>{enough}.end_if_met(best)) {
                return;
            }
        }
        do {
            if (top == stack) {
                return;
            }
            --top;
        } while (top->entry() > best.t);
        link = top->link();
    }
}

template <int width>
void meet_mesh(Hit<float>& best, const MeshInstance<float>& instance, std::uint32_t object, const Vec3<float>& origin,
               const pt::Ray<float>& world_ray, float enough) {
    const auto& mesh = mesh_of<Mesh<width>>(instance);
    if (!mesh.nodes.empty()) {
        const MeshRay<float> ray = MeshRay<float>::of(instance, object, origin, world_ray);
        traverse(best, mesh, ray, BoxRay<float>::of(ray.origin, ray.direction, mesh.spans), enough);
    }
}

// The rays of a packet in the space of a mesh, as MeshRay and BoxRay have them, one a lane.
struct MeshRays {
    Vectors<float> origin, direction, along, shear;
    Lanes<std::uint32_t> kx, ky, kz;
    Vectors<float> near_origin, far_origin, inverse;
    Flags enters;  // whether the ray may enter the tree's root

    MeshRay<float> ray(std::uint32_t l, std::uint32_t object, std::uint32_t passed_over) const {
        return {origin[l], direction[l], {kx[l], ky[l], kz[l], shear[l]}, along[l], object, passed_over};
    }
    BoxRay<float> box_ray(std::uint32_t l) const { return {near_origin[l], far_origin[l], inverse[l]}; }
};

// Prepares all lanes with the operations of MeshRay::of, in their order; only branches are selections here.
template <bool is_placed>
inline void to_mesh(MeshRays& rays, const MeshInstance<float>& instance, const Vectors<float>& origin,
                    const Vectors<float>& direction) {
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < lanes::width; ++l) {
        const Vec3<float> o = is_placed ? origin[l] : instance.point_in(origin[l]);
        const Vec3<float> d = is_placed ? direction[l] : instance.direction_in(direction[l]);
        const Vec3<float> size{absolute(d.x), absolute(d.y), absolute(d.z)};
        const bool is_z = size.x > size.y ? !(size.x > size.z) : !(size.y > size.z);
        const bool is_x = !is_z & (size.x > size.y);
        // The axes kx, ky and kz are xyz, yzx or zxy.
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

// Prepares all lanes for box tests as BoxRay::of does, and asks which may enter the tree's root.
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

template <int width>
void meet_in_lanes(Hits<float>& hits, const Flags& asks, const MeshInstance<float>& instance, std::uint32_t object,
                   const Vectors<float>& origin, const Paths<float>& rays, const Lanes<float>& enough) {
    const auto& mesh = mesh_of<Mesh<width>>(instance);
    if (mesh.nodes.empty()) {
        return;
    }
    MeshRays in_mesh;
    instance.is_placed != 0 ? to_mesh<true>(in_mesh, instance, origin, rays.direction)
                            : to_mesh<false>(in_mesh, instance, origin, rays.direction);
    to_boxes(in_mesh, mesh.spans, hits);
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < lanes::width; ++l) {
        in_mesh.enters[l] &= asks[l];
    }
    for (const std::uint32_t l : LaneList(in_mesh.enters)) {
        const bool starts_here = SurfaceId{rays.origin_surface[l]}.is_of(object);
        Hit<float> best = hits[l];
        traverse(best, mesh, in_mesh.ray(l, object, starts_here ? rays.primitive[l] : MeshRay<float>::nothing),
                 in_mesh.box_ray(l), enough[l]);
        hits.set(l, best);
    }
}

// The hooks of an accelerator of the host. `Traversal` is used for rays in double, and through a tree over all objects.
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
