// The choice partition=tiles: each GPU takes every sample of its own rows of pixels. Of N GPUs number d has the rows d,
// d + N, d + 2 N, ...
#include "variants/partition/reasons.h"

namespace pt::partition::tiles {
namespace {

const Registration registration(
    {
        .axis = "partition",
        .name = "tiles",
        .summary = "rows of pixels in turn: of N GPUs each takes every N-th row, with all its samples",
        .origin = "ptbench",
        .traits = PartitionTraits{.is_by_rows = true},
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) { return needs_several_devices(variant); },
    },
    {});

}  // namespace
}  // namespace pt::partition::tiles
