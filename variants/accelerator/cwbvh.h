// The accelerator cwbvh, a compressed wide BVH: 80-byte nodes of 8 children with boxes in 8 bits a plane, visited by
// the octant of the ray's direction. Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs", HPG 2017. Unlike there, the slots of a child stand at fixed bits of one mask, and no box that
// a hit lies in is missed by rounding.
#pragma once

#include "kernels/in_range.h"
#include "variants/bvh/encoded_tree.h"

#if defined(__CUDA_ARCH__)
#define PT_UNROLL _Pragma("unroll")
#else
#define PT_UNROLL
#endif

namespace pt::accelerator::cwbvh {

inline constexpr std::uint32_t width = 8;
inline constexpr std::uint32_t largest_leaf = 3;
// Margin by which every child's box is widened, in steps of its node's grid. It exceeds the rounding of a distance to a
// plane, which is that of numbers near 2^15 steps.
inline constexpr double plane_room = 1.0 / 128.0;
// Size of the traversal stack of cwbvh, one entry for each level of nodes: encode() refuses a deeper tree.
inline constexpr std::uint32_t largest_depth = 64;

// Bits of the float 2^15, into which plane_number splices a plane's byte. Every node holds them, so they are loaded
// with it at no cost: an instruction takes one constant, and that has to be the byte selector.
inline constexpr std::uint32_t plane_splice = 0x47000000u;

// A compressed wide node. Child i lies at the corner of the node that is at the high end of axis k where bit k of i is
// 1. In `contents`, bit 24 + i is set if child i is a node; if it is a leaf, bits 3 i to 3 i + 2, lowest first, are set
// for its slots.
struct alignas(16) Node {
    float origin[3];
    std::uint8_t exponent[3];  // step between planes of the node's grid by axis, as a float's exponent field
    std::uint8_t unused = 0;
    std::uint32_t child_base;  // number of the first child that is a node; other such children are numbered on from it
    std::uint32_t slot_base;   // first slot of the node's leaves; other slots follow in the order of leaves' corners
    std::uint32_t contents;
    std::uint32_t splice = plane_splice;
    // Low and high planes of the children's boxes by axis, in steps from the node's origin, at least plane_room outside
    // of the child.
    std::uint8_t plane[3][2][width];
};
static_assert(sizeof(Node) == 80);

// A compressed node as a traversal holds it: loaded as words, 16 bytes at once.
struct LoadedNode {
    std::uint32_t word[20];

    PT_HD static LoadedNode of(const void* nodes, std::uint32_t index) {
        LoadedNode node;
#if defined(__CUDA_ARCH__)
        const uint4* pieces = static_cast<const uint4*>(nodes) + 5 * static_cast<std::uint64_t>(index);
        PT_UNROLL
        for (int i = 0; i < 5; ++i) {
            const uint4 piece = __ldg(pieces + i);
            node.word[4 * i] = piece.x, node.word[4 * i + 1] = piece.y;
            node.word[4 * i + 2] = piece.z, node.word[4 * i + 3] = piece.w;
        }
#else
        __builtin_memcpy(&node, static_cast<const unsigned char*>(nodes) + sizeof(Node) * index, sizeof(Node));
#endif
        return node;
    }
    PT_HD float origin(int axis) const { return number_of(static_cast<std::int32_t>(word[axis])); }
    PT_HD float step(int axis) const {
        return number_of(static_cast<std::int32_t>((word[3] >> (8 * axis)) & 255u) << 23);
    }
    PT_HD std::uint32_t child_base() const { return word[4]; }
    PT_HD std::uint32_t slot_base() const { return word[5]; }
    PT_HD std::uint32_t contents() const { return word[6]; }
    // Planes of four children on an axis, one a byte: the low ones, or the high ones, of children 0 to 3 or of 4 to 7.
    PT_HD std::uint32_t low(int axis, int half) const { return word[8 + 4 * axis + half]; }
    PT_HD std::uint32_t high(int axis, int half) const { return word[10 + 4 * axis + half]; }
};

PT_HD inline std::uint32_t highest_bit(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
    return 31u - static_cast<std::uint32_t>(__clz(static_cast<int>(x)));
#else
    return 31u - static_cast<std::uint32_t>(__builtin_clz(x));
#endif
}
PT_HD inline std::uint32_t lowest_bit(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
    return static_cast<std::uint32_t>(__ffs(static_cast<int>(x))) - 1u;
#else
    return static_cast<std::uint32_t>(__builtin_ctz(x));
#endif
}
// a * b + c with one rounding on every backend, so that a ray enters the same boxes on each.
PT_HD inline float multiply_add(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
    return __fmaf_rn(a, b, c);
#else
    return __builtin_fmaf(a, b, c);
#endif
}

// Returns 2^15 + byte i of `word`: the byte is put in the middle of the float's fraction, without a conversion.
PT_HD inline float plane_number(std::uint32_t word, std::uint32_t i, [[maybe_unused]] std::uint32_t splice) {
#if defined(__CUDA_ARCH__)
    return __uint_as_float(__byte_perm(word, splice, 0x7504u | (i << 4)));
#else
    return 32768.0f + static_cast<float>((word >> (8u * i)) & 255u);
#endif
}

// Slab distances are compared as the integers of their bits: for floats that are not negative the order is the same,
// and a negative one counts as 0 where a ray enters and as a miss where it leaves.
PT_HD inline std::int32_t latest_entry(float x, float y, float z) {
#if defined(__CUDA_ARCH__)
    return __vimax3_s32_relu(__float_as_int(x), __float_as_int(y), __float_as_int(z));
#else
    return max(max(bits_of(x), bits_of(y)), max(bits_of(z), 0));
#endif
}
PT_HD inline std::int32_t earliest_exit(float x, float y, float z, float limit) {
#if defined(__CUDA_ARCH__)
    return __vimin3_s32(__float_as_int(x), __float_as_int(y), ::min(__float_as_int(z), __float_as_int(limit)));
#else
    return min(min(bits_of(x), bits_of(y)), min(bits_of(z), bits_of(limit)));
#endif
}

// A ray prepared for box tests: in float, with a margin for rounding. A triangle's test moves vertices, relative to the
// ray, by less than 8 u M along each axis (u: unit round-off), and a slab's distances are off by less than 8 u M over
// the direction, together 2^-20 M; M is the largest distance along an axis from the ray origin to a corner of the tree.
struct BoxRay {
    float origin[3];
    float inverse[3];
    float room[3];       // margin on slab distances for rounding, in units of t
    std::uint32_t flip;  // bit k: the ray goes up axis k, and so meets low planes first

    template <class Real>
    PT_HD static BoxRay of(const LoadedNode& root, const Vec3<Real>& from, const Vec3<Real>& direction) {
        // A direction component near 0 is replaced by 2^-60 of the largest component, or by 2^-100: the ray then strays
        // by less than the margin.
        const float largest =
            max(absolute(static_cast<float>(direction[0])),
                max(absolute(static_cast<float>(direction[1])), absolute(static_cast<float>(direction[2]))));
        const float least = max(largest * 8.67361737988403547e-19f, 7.88860905221011805e-31f);
        BoxRay ray;
        ray.flip = 0;
        float farthest = 0.0f;
        PT_UNROLL
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = static_cast<float>(from[k]);
            const float low = root.origin(k) - ray.origin[k];
            farthest = max(farthest, max(absolute(low), absolute(multiply_add(255.0f, root.step(k), low))));
            if constexpr (sizeof(Real) > sizeof(float)) {
                farthest = max(farthest, absolute(ray.origin[k]));
            }
        }
        PT_UNROLL
        for (int k = 0; k < 3; ++k) {
            const float component = static_cast<float>(direction[k]);
            const bool up = !(component < 0.0f);
            ray.inverse[k] = reciprocal_in_range(absolute(component) < least ? (up ? least : -least) : component);
            ray.room[k] = rounded_product(9.5367431640625e-07f * farthest, absolute(ray.inverse[k]));
            ray.flip |= up ? 1u << k : 0u;
        }
        return ray;
    }
};

// Returns the bits of a node's `contents` that stand for boxes which the ray enters before `limit`.
PT_HD inline std::uint32_t boxes_hit(const LoadedNode& node, const BoxRay& ray, float limit) {
    float step[3], near_offset[3], far_offset[3];
    std::uint32_t near_words[3][2], far_words[3][2];
    PT_UNROLL
    for (int k = 0; k < 3; ++k) {
        const float inverse = ray.inverse[k], offset = rounded_product(node.origin(k) - ray.origin[k], inverse);
        const bool up = inverse > 0.0f;
        step[k] = node.step(k) * inverse;
        near_offset[k] = multiply_add(step[k], -32768.0f, offset - ray.room[k]);
        far_offset[k] = multiply_add(step[k], -32768.0f, offset + ray.room[k]);
        PT_UNROLL
        for (int half = 0; half < 2; ++half) {
            near_words[k][half] = up ? node.low(k, half) : node.high(k, half);
            far_words[k][half] = up ? node.high(k, half) : node.low(k, half);
        }
    }
    const std::uint32_t splice = node.word[7];
    std::uint32_t hits = 0;
    PT_UNROLL
    for (std::uint32_t i = 0; i < width; ++i) {
        const std::uint32_t half = i >> 2, byte = i & 3u;
        const std::int32_t entry =
            latest_entry(multiply_add(plane_number(near_words[0][half], byte, splice), step[0], near_offset[0]),
                         multiply_add(plane_number(near_words[1][half], byte, splice), step[1], near_offset[1]),
                         multiply_add(plane_number(near_words[2][half], byte, splice), step[2], near_offset[2]));
        const std::int32_t exit =
            earliest_exit(multiply_add(plane_number(far_words[0][half], byte, splice), step[0], far_offset[0]),
                          multiply_add(plane_number(far_words[1][half], byte, splice), step[1], far_offset[1]),
                          multiply_add(plane_number(far_words[2][half], byte, splice), step[2], far_offset[2]), limit);
        hits |= entry <= exit ? (7u << (3u * i)) | (1u << (24u + i)) : 0u;
    }
    return hits & node.contents();
}

// Rounds best_t up for box tests, since a triangle's t may be off by 4 unit round-offs from where its box is entered.
template <class Real>
PT_HD inline float limit_of(const Real& best_t) {
    return static_cast<float>(best_t) * 1.000000476837158203125f;
}

// Permutes eight bits from slot order into the order in which a ray of octant `flip` visits children: bit i goes to i ^
// flip, and the highest bit comes first. The permutation is its own inverse.
PT_HD inline std::uint32_t by_octant(std::uint32_t bits, std::uint32_t flip) {
    std::uint32_t swap = (bits ^ (bits >> 1)) & ((flip & 1u) != 0 ? 0x55u : 0u);
    bits ^= swap * 3u;
    swap = (bits ^ (bits >> 2)) & ((flip & 2u) != 0 ? 0x33u : 0u);
    bits ^= swap * 5u;
    swap = (bits ^ (bits >> 4)) & ((flip & 4u) != 0 ? 0x0fu : 0u);
    return bits ^ (swap * 17u);
}

// A node's children that are yet to be visited: bits 24 to 31 tell which, in the order of the ray's octant, bits 0 to 7
// which children are nodes. Members have no default values, by which the traversal stack, an array of groups, would be
// written whole for every ray: 512 bytes a lane.
struct NodeGroup {
    std::uint32_t base;
    std::uint32_t bits;

    PT_HD static NodeGroup root() { return {0, 1u << 31}; }
    PT_HD bool empty() const { return bits < (1u << 24); }
    // Position, in the order of the ray's octant from 7 (first) to 0, of the group's child to enter next.
    PT_HD std::uint32_t nearest() const { return highest_bit(bits) - 24u; }
    PT_HD void keep_up_to(std::uint32_t position, bool inclusive) {
        bits &= (1u << (24u + position)) * (inclusive ? 2u : 1u) - 1u;
    }
    PT_HD std::uint32_t take_nearest(std::uint32_t flip) {
        const std::uint32_t bit = highest_bit(bits), slot = (bit - 24u) ^ flip;
        bits &= ~(1u << bit);
        return base + bits_in(bits & 255u & ((1u << slot) - 1u));
    }
    PT_HD static NodeGroup of(const LoadedNode& node, std::uint32_t hits, std::uint32_t flip) {
        return {node.child_base(), (by_octant(hits >> 24, flip) << 24) | (node.contents() >> 24)};
    }
};

// Calls leaf(slot, 1) for each slot of the leaves that are hit, though a leaf has up to three slots: one loop over all
// slots of a node keeps a warp's lanes together.
template <class Leaf, class Counter>
PT_HD void visit_leaves(const LoadedNode& node, std::uint32_t hits, Leaf& leaf, Counter& counter) {
    for (std::uint32_t left = hits & 0xffffffu; left != 0;) {
        const std::uint32_t lower = (left & (0u - left)) - 1u;
        left &= left - 1u;
        counter.primitives(1);
        leaf(node.slot_base() + bits_in(node.contents() & lower), 1u);
    }
}

// Calls leaf(first slot, count) for the leaves that the ray enters before best_t. The callback may lower best_t to a
// closer hit; a best_t below 0 ends the traversal.
template <class Real, class Leaf, class Counter>
PT_HD void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction, const Real& best_t,
                    Leaf&& leaf, Counter& counter) {
    if (tree.node_count == 0) {
        return;
    }
    const BoxRay ray = BoxRay::of(LoadedNode::of(tree.nodes, 0), origin, direction);
    NodeGroup open[largest_depth];
    std::uint32_t depth = 0;
    for (NodeGroup group = NodeGroup::root();;) {
        const LoadedNode node = LoadedNode::of(tree.nodes, group.take_nearest(ray.flip));
        if (!group.empty()) {
            open[depth++] = group;
        }
        counter.node();
        counter.boxes(bits_in(node.contents() & 0xff249249u));
        const std::uint32_t hits = boxes_hit(node, ray, limit_of(best_t));
        visit_leaves(node, hits, leaf, counter);
        if (best_t < Real(0)) {
            return;
        }
        group = NodeGroup::of(node, hits, ray.flip);
        if (group.empty()) {
            if (depth == 0) {
                return;
            }
            group = open[--depth];
        }
    }
}

// The triangles in the leaves of one node that are yet to be tested.
struct SlotGroup {
    std::uint32_t bits = 0;  // slots of leaves hit that are yet to be tested, as bits of boxes_hit's result
    std::uint32_t contents = 0, base = 0;

    PT_HD bool empty() const { return bits == 0; }
    PT_HD std::uint32_t take() {
        const std::uint32_t lower = (bits & (0u - bits)) - 1u;
        bits &= bits - 1u;
        return base + bits_in(contents & lower);
    }
};

// The cwbvh traversal in steps (variants/bvh/walk.h). The walk's NodeGroup is empty only once no node is left to visit.
template <class Real>
class Walk {
public:
    using Open = NodeGroup;
    using Leaf = SlotGroup;
    static constexpr std::uint32_t most_open = largest_depth;

    Walk() = default;
    PT_HD Walk(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction)
        : nodes_(tree.nodes),
          ray_(BoxRay::of(LoadedNode::of(tree.nodes, 0), origin, direction)),
          group_(NodeGroup::root()) {}

    PT_HD bool wants_node() const { return leaf_.empty() && !group_.empty(); }
    PT_HD bool has_leaf() const { return !leaf_.empty(); }
    PT_HD Leaf leaf() const { return leaf_; }
    template <class Stack>
    PT_HD void pass_leaf(const Real& best_t, Stack&) {
        leaf_.bits = 0;
        if (best_t < Real(0)) {
            group_ = {};
        }
    }
    template <class Stack, class Counter>
    PT_HD void visit_node(const Real& best_t, Stack& stack, Counter& counter) {
        const std::uint32_t position = group_.nearest();
        const LoadedNode node = LoadedNode::of(nodes_, group_.take_nearest(ray_.flip));
        const bool was_here = stack.enter(position, group_);
        counter.node();
        counter.boxes(bits_in(node.contents() & 0xff249249u));
        const std::uint32_t hits = boxes_hit(node, ray_, limit_of(best_t));
        leaf_ = {was_here ? 0u : hits & 0xffffffu, node.contents(), node.slot_base()};
        group_ = NodeGroup::of(node, hits, ray_.flip);
        stack.narrow(group_);
        if (group_.empty() && !stack.pop(group_)) {
            group_ = {};
        }
    }

private:
    const void* nodes_;
    BoxRay ray_;
    NodeGroup group_{};
    SlotGroup leaf_;
};

struct Traversal {
    static constexpr bool is_chosen_at_run_time = false;
    template <class Real>
    using Walk = cwbvh::Walk<Real>;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                               const Real& best_t, Leaf&& leaf, Counter& counter) {
        cwbvh::traverse(tree, origin, direction, best_t, leaf, counter);
    }
};

#if !defined(__CUDACC_RTC__)
// Encodes a binary tree as cwbvh nodes: leaves of at most 3 references, cut so that the tree's SAH cost is least (the
// paper's section 3.1), and children put where their octants visit them in order (3.2). Throws std::length_error for a
// tree that is too deep, too large, or has too large leaves.
EncodedTree encode(const BinaryTree& tree);
#endif

}  // namespace pt::accelerator::cwbvh

#undef PT_UNROLL

#if defined(PT_HOST)

// Builds compressed wide trees (cwbvh) from binary ones on the host. Boxes are rounded outward, exactly, in double.

#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "variants/accelerator/cwbvh_encode.h"
#include "variants/bvh/encoding.h"
#include "variants/bvh/parents_first.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::cwbvh {
namespace {

static_assert(std::is_trivially_default_constructible_v<NodeGroup>,
              "a ray would write its whole stack before it begins");

// Nodes of the binary tree after each leaf that is too large for a cwbvh node has been halved.
std::vector<BinaryTree::Node> with_small_leaves(const BinaryTree& tree) {
    std::vector<BinaryTree::Node> nodes = tree.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const BinaryTree::Node leaf = nodes[i];
        if (leaf.count <= largest_leaf) {
            continue;
        }
        const std::uint32_t left = leaf.count / 2;
        nodes[i] = {leaf.box, static_cast<std::uint32_t>(nodes.size()), 0};
        nodes.push_back({leaf.box, leaf.first, left});
        nodes.push_back({leaf.box, leaf.first + left, leaf.count - left});
    }
    return nodes;
}

class CutTree {
public:
    explicit CutTree(const BinaryTree& tree) : nodes_(with_small_leaves(tree)), cuts_(nodes_.size()) {
        const std::vector<std::uint32_t> order = parents_first(nodes_);
        for (auto node = order.rbegin(); node != order.rend(); ++node) {
            const float area = box_area(box(*node));
            cuts_[*node] = is_leaf(*node) ? Cut::of_leaf(area, nodes_[*node].count)
                                          : Cut::of_inner(area, cuts_[left(*node)], cuts_[right(*node)]);
        }
    }
    std::uint32_t left(std::uint32_t node) const { return nodes_[node].first; }
    std::uint32_t right(std::uint32_t node) const { return nodes_[node].first + 1; }
    bool is_leaf(std::uint32_t node) const { return nodes_[node].is_leaf(); }
    const Box& box(std::uint32_t node) const { return nodes_[node].box; }
    const Cut& cut(std::uint32_t node) const { return cuts_[node]; }

    void append_references(std::uint32_t node, const BinaryTree& tree, std::vector<std::uint32_t>& references) const {
        if (is_leaf(node)) {
            const auto first = tree.references.begin() + nodes_[node].first;
            references.insert(references.end(), first, first + nodes_[node].count);
        } else {
            append_references(left(node), tree, references);
            append_references(right(node), tree, references);
        }
    }

private:
    std::vector<BinaryTree::Node> nodes_;
    std::vector<Cut> cuts_;
};

class Encoder {
public:
    explicit Encoder(const BinaryTree& binary) : binary_(binary), tree_(binary) {}

    EncodedTree encode() {
        encoded_.references.reserve(binary_.references.size());
        wide_.emplace_back();
        open_.push_back({0, 0, 1});
        while (!open_.empty()) {
            const Open next = open_.back();
            open_.pop_back();
            if (next.depth > largest_depth) {
                throw std::length_error("cwbvh: the tree is deeper than 64 nodes of 8 children");
            }
            write(next);
        }
        encoded_.node_count = static_cast<std::uint32_t>(wide_.size());
        encoded_.nodes.resize(wide_.size() * (sizeof(Node) / sizeof(NodePiece)));
        std::memcpy(encoded_.nodes.data(), wide_.data(), wide_.size() * sizeof(Node));
        return std::move(encoded_);
    }

private:
    struct Open {
        std::uint32_t node, wide, depth;
    };

    void write(const Open& open) {
        Children children;
        if (open.node == 0 && tree_.cut(0).is_leaf()) {
            children.node[children.count++] = 0;
        } else {
            children = Children::of(tree_, open.node);
        }
        std::uint32_t at[width];
        children.put_at_corners(tree_, tree_.box(open.node), at);
        Node node = make_node(tree_, tree_.box(open.node), at);
        node.child_base = static_cast<std::uint32_t>(wide_.size());
        node.slot_base = static_cast<std::uint32_t>(encoded_.references.size());
        for (const std::uint32_t child : at) {
            if (child == no_node) {
                continue;
            }
            if (tree_.cut(child).is_leaf()) {
                tree_.append_references(child, binary_, encoded_.references);
            } else {
                open_.push_back({child, static_cast<std::uint32_t>(wide_.size()), open.depth + 1});
                wide_.emplace_back();
            }
        }
        wide_[open.wide] = node;
    }

    const BinaryTree& binary_;
    CutTree tree_;
    std::vector<Node> wide_;
    std::vector<Open> open_;
    EncodedTree encoded_;
};

}  // namespace

EncodedTree encode(const BinaryTree& tree) {
    require_encodable(tree);
    return tree.nodes.empty() ? EncodedTree{} : Encoder(tree).encode();
}

namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "cwbvh",
        .summary = "compressed tree of eight children a node, 80-byte nodes, visited by octant",
        .origin = "Ylitie, Karras and Laine 2017",
        .traits = AcceleratorTraits{.has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = accelerator_hook<Traversal>(encode)});

}  // namespace

}  // namespace pt::accelerator::cwbvh

#endif
