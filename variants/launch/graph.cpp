// A batch of samples is captured once as a CUDA graph and replayed with another first sample: one launch instead of
// dozens. Only what never waits for the device can be captured. A last batch that is not full is launched by stream.
#include "variants/registry.h"

namespace pt {
namespace {

std::string why_not_captured(FeatureSet, const Variant& variant) {
    const Registry& registry = Registry::instance();
    for (const std::string_view axis : {"compaction", "sorting"}) {
        if (registry.at(axis, variant, Backend::cuda).descriptor.waits_for_device) {
            return "cannot hold " + std::string(axis) + "=" + variant[axis] + ", which waits for the device";
        }
    }
    return variant.tuning.contains("read_back") ? "cannot hold read_back=1, which waits for the device" : "";
}

const Registration registration(
    {
        .axis = "launch",
        .name = "graph",
        .summary = "a batch of samples is a CUDA graph, captured before the clock starts and replayed",
        .origin = "CUDA graphs (CUDA 10)",
        .backends = on_cuda,
        .does_not_apply = why_not_captured,
        .work_missing = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.graph_nodes > 0 ? "" : "launched no graph";
        },
    },
    {.cuda = {.is_captured = true}});

}  // namespace
}  // namespace pt
