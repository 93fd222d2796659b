// The sort key chunk_material: the material within a chunk of the queue's slots. Paths are sorted by material only
// among neighbours in memory, so that what a warp reads stays local. The sort key of Cycles (INTEGRATOR_SORT_KEY,
// Blender D15331, 2022).
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: the sort key, which NVRTC compiles

#include "variants/cuda/device/sort_keys.cuh"

namespace pt::sort_key::chunk_material {

inline constexpr bool has_material = true;
inline constexpr bool by_chunk = true;

// The bits of a sort key below its material, of which this key has none.
__device__ inline std::uint32_t rest(const Ray<Real>&, const pt::Hit<Real>&, const cuda::KeyBounds&) { return 0; }

}  // namespace pt::sort_key::chunk_material

#endif

#if defined(PT_HOST)  // host part of this file: the sort key's descriptor

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

#endif
