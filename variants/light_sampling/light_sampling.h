// The claim and the conditions that the choices of light_sampling other than solid_angle have in common.
#pragma once

#include "variants/direct_light/next_event.h"

namespace pt {

inline constexpr std::string_view light_sampling_claim =
    "same expectation as light_sampling=solid_angle: a point counts by one over its density, however it is drawn";

inline Reason light_sampling_unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    constexpr FeatureSet boxes = Feature::axis_box | Feature::oriented_box | Feature::quad;
    if (const Reason reason = needs_connections_reason(variant); !reason.empty()) {
        return reason;
    }
    if (variant.robustness.is_naive) {
        return {"needs_robust", "needs robustness=robust, not " + std::string(variant.robustness.name)};
    }
    if ((scene & boxes) == 0) {
        return {"needs_box", "needs a box or a quad: other lights are sampled as ever"};
    }
    return {};
}

}  // namespace pt
