// The traversal `speculative`: a lane that has found a leaf puts it off and goes on through nodes until all active
// lanes of its warp have one, "speculative while-while" of Aila and Laine, "Understanding the Efficiency of Ray
// Traversal on GPUs", HPG 2009. Nodes that a postponed hit would have ruled out are visited in vain.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: traversal loop, which NVRTC compiles

#include "variants/traversal/by_steps.cuh"

namespace pt::traversal::speculative {

// Whether any lane of the warp votes yes. The compiler may have lanes vote in several groups: that changes when leaves
// are tested, not which.
PT_HD inline bool any_lane([[maybe_unused]] bool vote) {
#if defined(__CUDA_ARCH__)
    return __any_sync(__activemask(), vote ? 1 : 0) != 0;
#else
    return vote;
#endif
}

struct Order {
    template <class Walk, class Real, class Stack, class Leaf, class Counter>
    PT_HD static void run(Walk& walk, typename Walk::Leaf& postponed, const Real& best_t, Stack& stack, Leaf&& leaf,
                          Counter& counter) {
        const auto postpone = [&] {
            if (postponed.empty() && walk.has_leaf()) {
                postponed = walk.leaf();
                walk.pass_leaf(best_t, stack);
            }
        };
        while (walk.wants_node() || !postponed.empty()) {
            while (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
                postpone();
                if (!any_lane(postponed.empty())) {
                    break;
                }
            }
            while (!postponed.empty()) {
                counter.primitives(1);
                leaf(postponed.take(), 1u);
                postpone();
            }
        }
    }
};

template <class Accelerator, template <class Open, std::uint32_t most> class Stack>
using Traversal = BySteps<Order, Accelerator, Stack>;

}  // namespace pt::traversal::speculative

#endif

#if defined(PT_HOST)  // host part of this file: the traversal's descriptor

#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::traversal::speculative {
namespace {

const Registration registration(
    {
        .axis = "traversal",
        .name = "speculative",
        .summary = "a leaf is put off while lanes of the warp have none yet",
        .origin = "Aila and Laine 2009",
        .backends = on_cuda,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal::speculative

#endif
