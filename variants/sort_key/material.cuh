// The key that cis565 sorts by: the material of the surface that was hit.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/sort_keys.cuh"

namespace pt::sort_key::material {

inline constexpr bool has_material = true;

// What follows the material in the key: nothing.
__device__ inline std::uint32_t rest(const Ray<Real>&, const pt::Hit<Real>&, const cuda::KeyBounds&) { return 0; }

}  // namespace pt::sort_key::material

#else

#include "variants/registry.h"

namespace pt::sort_key::material {

inline constexpr Descriptor descriptor{
    .axis = "sort_key",
    .name = "material",
    .summary = "the material that was hit; paths that left the scene last",
    .origin = "cis565",
    .baseline = on_cuda,
    .traits = SortKeyTraits{.bits = 0, .has_material = true},
    .backends = on_cuda,
};

}  // namespace pt::sort_key::material

#endif
