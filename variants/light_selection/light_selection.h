// The claim and the conditions that the choices of light_selection other than uniform have in common.
#pragma once

#include "variants/direct_light/next_event.h"

namespace pt {

inline constexpr std::string_view light_selection_claim =
    "same expectation as light_selection=uniform: a light counts by one over its probability, whatever that is";

inline Reason light_selection_unsupported_reason(FeatureSet, const VariantTraits& variant) {
    return needs_connections_reason(variant);
}

}  // namespace pt
