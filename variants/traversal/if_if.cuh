// The traversal if_if: one loop, each turn of which takes no more than a step through a node and a test of a triangle,
// "if-if" of Aila and Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009. No lane waits for the
// end of another lane's inner loop.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: traversal loop, which NVRTC compiles

#include "variants/traversal/by_steps.cuh"

namespace pt::traversal::if_if {

struct Order {
    template <class Walk, class Real, class Stack, class Leaf, class Counter>
    PT_HD static void run(Walk& walk, typename Walk::Leaf& triangles, const Real& best_t, Stack& stack, Leaf&& leaf,
                          Counter& counter) {
        while (walk.wants_node() || walk.has_leaf()) {
            if (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
                if (walk.has_leaf()) {
                    triangles = walk.leaf();
                }
            }
            if (walk.has_leaf()) {
                counter.primitives(1);
                leaf(triangles.take(), 1u);
                if (triangles.empty()) {
                    walk.pass_leaf(best_t, stack);
                    if (walk.has_leaf()) {
                        triangles = walk.leaf();
                    }
                }
            }
        }
    }
};

template <class Accelerator, template <class Open, std::uint32_t most> class Stack>
using Traversal = BySteps<Order, Accelerator, Stack>;

}  // namespace pt::traversal::if_if

#endif

#if defined(PT_HOST)  // host part of this file: the traversal's descriptor

#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::traversal::if_if {
namespace {

const Registration registration(
    {
        .axis = "traversal",
        .name = "if_if",
        .summary = "one loop, each turn a step through a node and a test of a triangle at most",
        .origin = "Aila and Laine 2009",
        .backends = on_cuda,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal::if_if

#endif
