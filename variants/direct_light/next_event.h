// What the choices with next-event estimation have in common.
#pragma once

#include "variants/registry.h"

namespace pt {

inline constexpr std::string_view next_event_claim =
    "same expectation as direct_light=off: a connection brings what then does not count where it is met";

inline Reason next_event_unsupported_reason(FeatureSet scene, const VariantTraits&) {
    if ((scene & (Feature::emitter | Feature::emission)) == 0) {
        return {"needs_emitter", "needs an object that emits: an environment is not sampled"};
    }
    if ((scene & set_of(Feature::diffuse, Feature::mix, Feature::rough_conductor, Feature::rough_dielectric)) == 0) {
        return {"needs_diffuse", "needs a diffuse or rough surface to connect"};
    }
    return {};
}

}  // namespace pt
