// What the choices other than uniform have in common.
#pragma once

#include "variants/registry.h"

namespace pt {

inline constexpr std::string_view light_selection_claim =
    "same expectation as light_selection=uniform: a light counts by one over its probability, whatever that is";

inline Reason light_selection_unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (!variant.direct_light.connects_every_vertex) {
        return {"needs_connections",
                "needs vertices that are connected to lights: direct_light=nee, nee_mis or nee_one_sample, not " +
                    std::string(variant.direct_light.name)};
    }
    return {};
}

}  // namespace pt
