// The ray rather than the hit: its direction's octant, then a 15-bit Morton code of its origin. Known before the ray is
// traced, so paths are sorted in front of the intersection stage and it gains as well.
#pragma once

#include "variants/cuda/sort_keys.cuh"

namespace pt::sort_key::ray {

inline constexpr bool has_material = false;
inline constexpr bool by_chunk = false;

__device__ inline std::uint32_t rest(const Ray<Real>& ray, const pt::Hit<Real>&, const cuda::KeyBounds& bounds) {
    const std::uint32_t octant = (ray.direction.x < Real(0) ? 4u : 0u) | (ray.direction.y < Real(0) ? 2u : 0u) |
                                 (ray.direction.z < Real(0) ? 1u : 0u);
    return (octant << 15) | cuda::morton(ray.origin, bounds);
}

}  // namespace pt::sort_key::ray
