// The material within a chunk of the queue's slots: paths are put in order by material only beside their neighbours in
// memory, so that what a warp reads stays local. The sort key of Cycles (INTEGRATOR_SORT_KEY, Blender D15331, 2022).
#pragma once

#include "variants/cuda/sort_keys.cuh"

namespace pt::sort_key::chunk_material {

inline constexpr bool has_material = true;
inline constexpr bool by_chunk = true;

// What follows the material in the sort key, which is nothing.
__device__ inline std::uint32_t rest(const Ray<Real>&, const pt::Hit<Real>&, const cuda::KeyBounds&) { return 0; }

}  // namespace pt::sort_key::chunk_material
