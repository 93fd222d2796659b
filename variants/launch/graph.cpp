// The choice launch=graph: a batch of samples is captured once as a CUDA graph and replayed with another first sample,
// one launch instead of dozens. Only what never waits for the device can be captured. A partial batch is launched by
// stream.
#include "variants/launch/captured.h"

namespace pt::launch::graph {
namespace {

const Registration registration(
    {
        .axis = "launch",
        .name = "graph",
        .summary = "a batch of samples is a CUDA graph, captured before the clock starts and replayed",
        .origin = "CUDA graphs (CUDA 10)",
        .traits = LaunchTraits{.is_captured = true},
        .backends = on_cuda,
        .unsupported_reason = why_not_captured,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.graph_nodes > 0 ? "" : "launched no graph";
        },
    },
    {});

}  // namespace
}  // namespace pt::launch::graph
