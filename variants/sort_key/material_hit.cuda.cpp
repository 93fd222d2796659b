// What the sort key of material_hit.cuh says of itself.
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
