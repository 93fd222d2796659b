// What the choices with next-event estimation share, and a check for choices that need next-event estimation.
#pragma once

#include "variants/registry.h"

namespace pt {

inline constexpr std::string_view next_event_claim =
    "same expectation as direct_light=off: a connection brings what then does not count where it is met";

inline Reason next_event_unsupported_reason(FeatureSet scene, const VariantTraits&) {
    if ((scene & set_of(Feature::emitter, Feature::emission, Feature::environment_map)) == 0) {
        return {"needs_emitter", "needs an object that emits, or an environment that is drawn (docs/scene_format.md)"};
    }
    if ((scene & materials_with(material_trait::connects)) == 0) {
        return {"needs_diffuse", "needs a diffuse or rough surface to connect"};
    }
    return {};
}

// Why a choice on how vertices are connected to lights does not apply: the variant connects none. Empty: it applies.
inline Reason needs_connections_reason(const VariantTraits& variant) {
    if (!variant.direct_light.connects_every_vertex) {
        return {"needs_connections",
                "needs vertices that are connected to lights: direct_light=nee, nee_mis or nee_one_sample, not " +
                    std::string(variant.direct_light.name)};
    }
    return {};
}

}  // namespace pt
