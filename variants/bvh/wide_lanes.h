// Wide trees on the host: one ray against all boxes of a node, or against four triangles of a leaf, in one vector. Only
// certain misses are left out; the triangles that remain take the scalar test (kernels/triangle.h), so the bits stay.
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

namespace pt::lanes {

// Vectors of floats as GNU C++ (g++, clang) has them: operations apply to each lane, by IEEE; comparisons give -1 or 0.
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
    return value - Floats<width>{};  // value - 0 and not value + 0, which would turn -0 into +0
}
template <int width>
inline Floats<width> loaded(const float* from) {
    return *reinterpret_cast<const Floats<width>*>(from);
}
// The truth values of all lanes as a mask of one bit per lane.
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

// A wide node, aligned for whole vectors. A leaf's link holds the number of its first block and its count of triangles.
template <int width>
struct alignas(64) Node : WideNode<width> {};

template <int width>
struct Mesh : HostMesh {
    std::vector<Node<width>> nodes;
    std::vector<TriangleBlock> blocks;
    BoxSpan spans[3];  // bounds of the root box by axis

    std::uint64_t bytes() const { return nodes.size() * sizeof(Node<width>) + blocks.size() * sizeof(TriangleBlock); }
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

// The slots of the triangles in one block: those of a leaf or, if the block holds them all, of a whole subtree.
struct BlockSlots {
    std::uint32_t count = 0;  // number of slots in the block; 0: a subtree has more triangles than a block holds
    std::uint32_t slot[block_width];

    // Adds a leaf's slots to the block's slots; false if there would be more than a block holds.
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

// For each node of a wide tree, the slots of its subtree's triangles if one block holds them: to test the block then
// costs less than to visit the node. The root always stays a node.
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
    for (std::size_t i = nodes.size(); i-- > 1;) {  // children first: they have larger numbers than parents
        fits[i] = gather(nodes[i]);
    }
    return fits;
}

// Builds the host's tree from the one that the device gets: leaves become blocks of triangles, and small subtrees
// become leaves.
template <int width>
class MeshBuilder {
public:
    MeshBuilder(std::span<const WideNode<width>> nodes, std::span<const LeafTriangle> leaves)
        : nodes_(nodes), leaves_(leaves), fits_(subtrees_of_a_block<width>(nodes)), number_(nodes.size()) {}

    Mesh<width> build() {
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

// The numbers of BoxRay for the box tests of one ray, repeated in every lane, where a lane tests one child.
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

    // BoxRay::entry for every child of a node: sets `entries` to the distances; returns a mask of the children entered.
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

// The numbers for the triangle tests of one ray, repeated in every lane, where a lane tests one triangle.
struct TriangleLanes {
    using Lane = Floats<block_width>;
    Lane origin[3], shear_x, shear_y;  // ray origin along kx, ky, kz
    std::uint32_t axis[3];

    static TriangleLanes of(const MeshRay<float>& ray) {
        const ShearedDirection<float>& s = ray.sheared;
        const auto spread = [](float value) { return broadcast<block_width>(value); };
        return {{spread(ray.along.x), spread(ray.along.y), spread(ray.along.z)},
                spread(s.shear.x),
                spread(s.shear.y),
                {s.kx, s.ky, s.kz}};
    }

    // Returns a bit for each triangle that may be hit. The others have rounded edge functions of both signs and none
    // that is zero: the first operations of `intersect` turn them away.
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
    std::uint64_t of;  // upper half: entry distance, not negative, so a smaller word is nearer; lower half: link

    static Waiting make(float entry, std::uint32_t link) {
        return {static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(entry)) << 32 | link};
    }
    float entry() const { return std::bit_cast<float>(static_cast<std::uint32_t>(of >> 32)); }
    std::uint32_t link() const { return static_cast<std::uint32_t>(of); }
};

// Puts an entry on a traversal stack, whose entries from `bottom` on are kept so that the nearest is on top.
inline void put_by_distance(Waiting*& top, const Waiting* bottom, const Waiting& next) {
    Waiting* at = top++;
    for (; at > bottom && at[-1].of < next.of; --at) {
        *at = at[-1];
    }
    *at = next;
}

// Returns the link of the nearest child of a node that a ray enters and puts its other entered children on the stack.
// `found` has a bit for each child entered (at least one), `entries` the distances.
template <int width>
inline std::uint32_t take_nearest(std::uint32_t found, const float* entries, const Node<width>& node, Waiting*& top) {
    const auto take = [&] {
        const auto child = static_cast<std::uint32_t>(std::countr_zero(found));
        found &= found - 1u;
        return Waiting::make(entries[child], node.link[child]);
    };
    Waiting nearest = take();
    const Waiting* const bottom = top;
    while (found != 0) {
        Waiting next = take();
        if (next.of < nearest.of) {
            std::swap(next, nearest);
        }
        put_by_distance(top, bottom, next);
    }
    return nearest.link();
}

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

// Takes one ray through the wide tree of a mesh on the host.
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
            const std::uint32_t found = boxes.entered(node, best.t, *reinterpret_cast<Floats<width>*>(entries));
            if (found == 0) {
                break;
            }
            link = take_nearest<width>(found, entries, node, top);
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

}  // namespace pt::lanes
