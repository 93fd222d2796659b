// The sort key `material`, which is that of cis565: the material of the surface that was hit.
#pragma once

#include "variants/cuda/device/sort_keys.cuh"

namespace pt::sort_key::material {

inline constexpr bool has_material = true;
inline constexpr bool by_chunk = false;

// The bits of a sort key below its material, of which this key has none.
__device__ inline std::uint32_t rest(const Ray<Real>&, const pt::Hit<Real>&, const cuda::KeyBounds&) { return 0; }

}  // namespace pt::sort_key::material
