// The sort key material_hit: the material that was hit, then a 15-bit Morton code of the hit point, so that lanes that
// shade together also go on from nearby points.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: the sort key, which NVRTC compiles

#include "variants/cuda/device/sort_keys.cuh"

namespace pt::sort_key::material_hit {

inline constexpr bool has_material = true;
inline constexpr bool by_chunk = false;

__device__ inline std::uint32_t rest(const Ray<Real>& ray, const pt::Hit<Real>& hit, const cuda::KeyBounds& bounds) {
    return hit.side.exists() ? cuda::morton(ray.origin + ray.direction * hit.t, bounds) : 0;
}

}  // namespace pt::sort_key::material_hit

#endif

#if defined(PT_HOST)  // host part of this file: the sort key's descriptor

#include "variants/registry.h"

namespace pt::sort_key::material_hit {
namespace {

const Registration registration(
    {
        .axis = "sort_key",
        .name = "material_hit",
        .summary = "the material that was hit, then the hit point's Morton code (15 bits)",
        .origin = "Laine, Karras and Aila 2013; Morton 1966",
        .traits = SortKeyTraits{.bits = 15, .has_material = true},
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
            return variant.sorting.sorts ? Reason{} : Reason{"needs_sorting", "needs a sort, not sorting=none"};
        },
    },
    {});

}  // namespace
}  // namespace pt::sort_key::material_hit

#endif
