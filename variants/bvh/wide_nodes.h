// Wide nodes with boxes in single precision, and their traversal: all children of a node are tested at once and
// entered nearest first. Wald, Benthin, Boulos, "Getting Rid of Packets", RT 2008.
#pragma once

#include "kernels/math.h"
#include "variants/bvh/box_ray.h"
#include "variants/bvh/encoded_tree.h"
#include "variants/bvh/walk.h"

#if !defined(__CUDACC_RTC__)
#include "variants/bvh/collapse.h"
#include "variants/bvh/encoding.h"
#endif

namespace pt {

// A wide node. Row 2 axis of `side` has the children's low planes, row 2 axis + 1 the high ones. A missing child has an
// empty box, which only a ray of NaNs enters; such a ray comes to the leaf `no_child_link` and so to an end.
template <int width>
struct alignas(16) WideNode {
    float side[6][width];
    std::uint32_t link[width];     // links to the children, as in variants/bvh/link.h
    std::uint32_t padding[width];  // padding that makes a node fill whole lines of 128 bytes

    PT_HD bool has_child(int child) const { return side[0][child] <= side[1][child]; }
    PT_HD BoxSpan span(int axis) const {
        BoxSpan all{side[2 * axis][0], side[2 * axis + 1][0]};
        for (int child = 1; child < width; ++child) {
            all.low = min(all.low, side[2 * axis][child]);
            all.high = max(all.high, side[2 * axis + 1][child]);
        }
        return all;
    }
};

// The link of a missing child: the leaf of slot 0, since one more triangle to test changes no hit.
inline constexpr std::uint32_t no_child_link = leaf_link(0, 1);

// Stack size that suffices for a wide tree made from a binary one of max_tree_depth levels in any shape (collapse.h).
template <int width>
inline constexpr std::uint32_t wide_stack_size = width == 4 ? 1 + 3 * 32 : 1 + 7 * 22;

#if !defined(__CUDACC_RTC__)
template <int width>
EncodedTree encode_wide(const BinaryTree& tree) {
    const WideTree wide = collapse(tree, width, wide_stack_size<width>);
    std::vector<WideNode<width>> nodes(wide.nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (int child = 0; child < width; ++child) {
            const bool is_there = static_cast<std::uint32_t>(child) < wide.nodes[i].count;
            const BinaryTree::Node node = is_there ? tree.nodes[wide.nodes[i].child[child]] : BinaryTree::Node{};
            for (int axis = 0; axis < 3; ++axis) {
                nodes[i].side[2 * axis][child] = node.box.low[axis];
                nodes[i].side[2 * axis + 1][child] = node.box.high[axis];
            }
            nodes[i].link[child] = !is_there        ? no_child_link
                                   : node.is_leaf() ? leaf_link(node.first, node.count)
                                                    : wide.nodes[i].inner[child];
        }
    }
    return encoded(nodes, tree.references);
}
#endif

// Sets `entries` to the ray parameter at which the ray enters each child's box, or to BoxRay::no_entry for a miss.
template <class Real, int width>
PT_HD inline void child_entries(const WideNode<width>& node, const BoxRay<Real>& ray, const Real& best_t,
                                Real (&entries)[width]) {
    const int x = ray.is_reversed(0) ? 1 : 0, y = ray.is_reversed(1) ? 1 : 0, z = ray.is_reversed(2) ? 1 : 0;
    const float* const near_x = node.side[x];
    const float* const far_x = node.side[1 - x];
    const float* const near_y = node.side[2 + y];
    const float* const far_y = node.side[3 - y];
    const float* const near_z = node.side[4 + z];
    const float* const far_z = node.side[5 - z];
    const Real farthest = best_t;
    for (int child = 0; child < width; ++child) {
        entries[child] = ray.entry({Real(near_x[child]), Real(near_y[child]), Real(near_z[child])},
                                   {Real(far_x[child]), Real(far_y[child]), Real(far_z[child])}, farthest);
    }
}

// Calls leaf(first_slot, count) for the leaves that the ray enters before best_t, nearest first. The callback may lower
// best_t to a closer hit; a best_t below 0 ends the traversal.
template <int width, class Real, class Leaf, class Counter>
PT_HD void traverse_wide(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                         const Real& best_t, Leaf&& leaf, Counter& counter) {
    if (tree.node_count == 0) {
        return;
    }
    const auto* nodes = static_cast<const WideNode<width>*>(tree.nodes);
    const BoxSpan spans[3] = {nodes[0].span(0), nodes[0].span(1), nodes[0].span(2)};
    const BoxRay<Real> ray = BoxRay<Real>::of(origin, direction, spans);
    std::uint32_t link_stack[wide_stack_size<width>];
    Real entry_stack[wide_stack_size<width>];
    std::uint32_t waiting = 0, link = 0;
    while (true) {
        if (is_leaf_link(link)) {
            counter.primitives(slot_count(link));
            leaf(first_slot(link), slot_count(link));
        } else {
            const WideNode<width>& node = nodes[link];
            counter.node();
            counter.boxes(width);
            Real entries[width];
            child_entries<Real, width>(node, ray, best_t, entries);
            const std::uint32_t bottom = waiting;
            for (int child = 0; child < width; ++child) {
                if (entries[child] < Real(0)) {
                    continue;
                }
                std::uint32_t at = waiting++;  // the node's children are kept sorted, the nearest on top
                for (; at > bottom && entry_stack[at - 1] < entries[child]; --at) {
                    entry_stack[at] = entry_stack[at - 1];
                    link_stack[at] = link_stack[at - 1];
                }
                entry_stack[at] = entries[child];
                link_stack[at] = node.link[child];
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

// The traversal of wide trees in steps (walk.h), as traverse_wide takes them.
template <int width, class Real>
class WideWalk : public LinkWalk<Real, width> {
public:
    static constexpr std::uint32_t most_open = wide_stack_size<width>;

    WideWalk() = default;
    PT_HD WideWalk(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction)
        : nodes_(static_cast<const WideNode<width>*>(tree.nodes)) {
        const BoxSpan spans[3] = {nodes_[0].span(0), nodes_[0].span(1), nodes_[0].span(2)};
        ray_ = BoxRay<Real>::of(origin, direction, spans);
        this->link_ = 0;
    }

    template <class Stack, class Counter>
    PT_HD void visit_node(const Real& best_t, Stack& stack, Counter& counter) {
        const WideNode<width>& node = nodes_[this->link_];
        counter.node();
        counter.boxes(width);
        Real entries[width];
        child_entries<Real, width>(node, ray_, best_t, entries);
        if (!stack.enters_nearest(entries, node.link, this->link_)) {
            this->take_open(best_t, stack);
        }
    }

private:
    const WideNode<width>* nodes_;
    BoxRay<Real> ray_;
};

}  // namespace pt
