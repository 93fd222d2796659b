// What the sort key of ray.cuh says of itself.
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
