// The traversal while_while: a lane visits nodes until it finds a leaf, then tests the leaf's triangles, "while-while"
// of Aila and Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009. The loop over steps here is for
// stacks other than `local`; with `local`, programs have the accelerator's own loop, which visits in the same order.
#pragma once

#include "variants/traversal/by_steps.cuh"

namespace pt::traversal::while_while {

struct Order {
    template <class Walk, class Real, class Stack, class Leaf, class Counter>
    PT_HD static void run(Walk& walk, typename Walk::Leaf& triangles, const Real& best_t, Stack& stack, Leaf&& leaf,
                          Counter& counter) {
        while (true) {
            while (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
            }
            if (!walk.has_leaf()) {
                return;
            }
            for (triangles = walk.leaf(); !triangles.empty();) {
                counter.primitives(1);
                leaf(triangles.take(), 1u);
            }
            walk.pass_leaf(best_t, stack);
        }
    }
};

template <class Accelerator, template <class Open, std::uint32_t most> class Stack>
using Traversal = BySteps<Order, Accelerator, Stack>;

}  // namespace pt::traversal::while_while
