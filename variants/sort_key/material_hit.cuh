// A sort key of the material that was hit, then where: a 15-bit Morton code of the hit point, so that lanes that shade
// together also go on from nearby points.
#pragma once

#include "variants/cuda/sort_keys.cuh"

namespace pt::sort_key::material_hit {

inline constexpr bool has_material = true;
inline constexpr bool by_chunk = false;

__device__ inline std::uint32_t rest(const Ray<Real>& ray, const pt::Hit<Real>& hit, const cuda::KeyBounds& bounds) {
    return hit.side.exists() ? cuda::morton(ray.origin + ray.direction * hit.t, bounds) : 0;
}

}  // namespace pt::sort_key::material_hit
