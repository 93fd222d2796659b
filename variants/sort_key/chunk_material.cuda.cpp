// What the sort key of chunk_material.cuh says of itself.
#include "variants/registry.h"

namespace pt::sort_key::chunk_material {
namespace {

constexpr Tunable tunables[] = {
    {"chunk", 65536, 256, 16777216, 1,
     "slots of a chunk; more where there would be more keys than a counting sort takes"},
};

const Registration registration(
    {
        .axis = "sort_key",
        .name = "chunk_material",
        .summary = "the chunk of the queue that the path lies in, then the material that was hit",
        .origin = "Cycles (Blender D15331)",
        .traits = SortKeyTraits{.bits = 0, .has_material = true, .by_chunk = true},
        .backends = on_cuda,
        .tunables = tunables,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
            return variant.sorting.sorts ? Reason{} : Reason{"needs_sorting", "needs a sort, not sorting=none"};
        },
    },
    {});

}  // namespace
}  // namespace pt::sort_key::chunk_material
