// The choice partition=dynamic: a shared counter hands out chunks of samples, and a device that is done early takes
// another chunk. Chunks shrink with what is left (guided self-scheduling, Polychronopoulos and Kuck 1987).
#include "variants/partition/reasons.h"

namespace pt::partition::dynamic {
namespace {

const Registration registration(
    {
        .axis = "partition",
        .name = "dynamic",
        .summary = "chunks of samples of all pixels, taken from a shared counter, smaller towards the end",
        .origin = "Polychronopoulos and Kuck 1987 (guided self-scheduling)",
        .traits = PartitionTraits{.is_dynamic = true},
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) { return needs_several_devices(variant); },
    },
    {});

}  // namespace
}  // namespace pt::partition::dynamic
