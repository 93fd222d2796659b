// The traversal of a tree by one ray, in steps: the axis `traversal` makes loops of the steps, the axis
// `traversal_stack` keeps what waits. An accelerator that has steps has a `Traversal::Walk<Real>` with
//   Open, most_open                          what waits on the stack, and how many of them at most;
//   Leaf                                     triangles to test: empty(), take() for the slot of the next;
//   Walk(tree, origin, direction)            at the root of a tree that has nodes;
//   wants_node(), visit_node(best, stack, c) one node's boxes; what is entered later goes to the stack;
//   has_leaf(), leaf(), pass_leaf(b, stack)  triangles that were found, and on to what comes after them.
// Of wants_node and has_leaf no more than one is true; where neither is, the walk is over. A leaf may be passed before
// its triangles are tested: what is then visited in vain changes no hit.
#pragma once

#include "kernels/config.h"
#include "variants/bvh/link.h"

namespace pt {

struct SlotRange {
    std::uint32_t next = 0, end = 0;

    PT_HD bool empty() const { return next == end; }
    PT_HD std::uint32_t take() { return next++; }
    PT_HD static SlotRange of(std::uint32_t leaf_link) {
        return {first_slot(leaf_link), first_slot(leaf_link) + slot_count(leaf_link)};
    }
};

// An entry of the traversal stack: a child that waits, of a node with up to `width` children, and the distance, 0 or
// more, at which the ray enters it.
template <class Real, int width_of_nodes = 2>
struct OpenLink {
    static constexpr int width = width_of_nodes;
    Real entry;
    std::uint32_t link;

    PT_HD static OpenLink root() { return {Real(0), 0}; }
};

// The link of a walk that is over: above every inner node's number and below every leaf's link.
inline constexpr std::uint32_t no_link = leaf_flag - 1;

// The steps of a traversal that trees with links share, and their state: the link of the current node or leaf.
template <class Real, int width = 2>
class LinkWalk {
public:
    using Open = OpenLink<Real, width>;
    using Leaf = SlotRange;

    PT_HD bool wants_node() const { return link_ < no_link; }
    PT_HD bool has_leaf() const { return link_ > no_link; }
    PT_HD Leaf leaf() const { return SlotRange::of(link_); }
    template <class Stack>
    PT_HD void pass_leaf(const Real& best_t, Stack& stack) {
        take_open(best_t, stack);
    }

protected:
    // Pops the next waiting child that the ray enters before the best hit.
    template <class Stack>
    PT_HD void take_open(const Real& best_t, Stack& stack) {
        Open open;
        do {
            if (!stack.pop(open)) {
                link_ = no_link;
                return;
            }
        } while (open.entry > best_t);
        link_ = open.link;
    }

    std::uint32_t link_ = no_link;
};

}  // namespace pt
