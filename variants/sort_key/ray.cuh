// The sort key `ray`: the octant of the ray's direction, then a 15-bit Morton code of the ray origin. It is known
// before the ray is traced, so paths are sorted in front of the intersection stage, which gains as well.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: the sort key, which NVRTC compiles

#include "variants/cuda/device/sort_keys.cuh"

namespace pt::sort_key::ray {

inline constexpr bool has_material = false;
inline constexpr bool by_chunk = false;

__device__ inline std::uint32_t rest(const Ray<Real>& ray, const pt::Hit<Real>&, const cuda::KeyBounds& bounds) {
    const std::uint32_t octant = (ray.direction.x < Real(0) ? 4u : 0u) | (ray.direction.y < Real(0) ? 2u : 0u) |
                                 (ray.direction.z < Real(0) ? 1u : 0u);
    return (octant << 15) | cuda::morton(ray.origin, bounds);
}

}  // namespace pt::sort_key::ray

#endif

#if defined(PT_HOST)  // host part of this file: the sort key's descriptor

#include "variants/registry.h"

namespace pt::sort_key::ray {
namespace {

const Registration registration(
    {
        .axis = "sort_key",
        .name = "ray",
        .summary = "the ray's octant, then its origin's Morton code (15 bits); sorted before the ray is traced",
        .origin = "Aila and Karras 2010; Meister et al. 2020 (ray reordering)",
        .traits = SortKeyTraits{.bits = 18, .has_material = false},
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
            return variant.sorting.sorts ? Reason{} : Reason{"needs_sorting", "needs a sort, not sorting=none"};
        },
    },
    {});

}  // namespace
}  // namespace pt::sort_key::ray

#endif
