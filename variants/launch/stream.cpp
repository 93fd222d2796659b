// The choice launch=stream: the host launches each stage as its turn comes (on the CPU backend: calls it).
#include "variants/registry.h"

namespace pt::launch::stream {
namespace {

const Registration registration(
    {
        .axis = "launch",
        .name = "stream",
        .summary = "each stage is launched by the host as its turn comes",
        .origin = "cis565",
        .baseline = on_every_backend,
        .backends = on_every_backend,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.graph_nodes == 0 ? "" : "launched a graph";
        },
    },
    {});

}  // namespace
}  // namespace pt::launch::stream
