// The choice launch=graph_while: a batch of samples is captured once as a CUDA graph, in which a conditional while node
// repeats two bounces as long as paths live: a batch costs what its longest path needs, not what the depth allows.
// Needs a compaction, which keeps the number of live paths on the device.
#include "variants/launch/captured.h"

namespace pt::launch::graph_while {
namespace {

// Least depth, in segments, at which a CUDA graph has a loop: one segment, a round of two in the loop, and a last one.
constexpr std::uint64_t shortest_loop = 4;

Reason why_not_looped(FeatureSet features, const VariantTraits& variant) {
    if (!variant.integrator.can_loop) {
        return {"needs_queue", "loops over bounces: needs integrator=wavefront or wavefront_fused, not " +
                                   std::string(variant.integrator.name)};
    }
    if (!variant.compaction.compacts) {
        return {"needs_compaction", "ends when the count of paths in play is 0: needs a compaction, not none"};
    }
    return why_not_captured(features, variant);
}

// Says by a render's counters why no graph with a loop ran; empty: one did, or paths were too short for a loop.
std::string loop_missing(const WorkCounters& work, std::uint64_t) {
    if (work.graph_nodes == 0) {
        return "launched no graph";
    }
    const bool too_short = work.bounces < shortest_loop * work.last_bounces;
    return work.loop_rounds > 0 || too_short ? "" : "no round of a loop ran";
}

const Registration registration(
    {
        .axis = "launch",
        .name = "graph_while",
        .summary = "a batch of samples is a CUDA graph whose while node repeats bounces as long as paths live",
        .origin = "conditional nodes (CUDA 12.4)",
        .traits = LaunchTraits{.is_captured = true, .loops = true},
        .backends = on_cuda,
        .unsupported_reason = why_not_looped,
        .check_counters = loop_missing,
    },
    {});

}  // namespace
}  // namespace pt::launch::graph_while
