// The axis `direct_light`: whether vertices are connected to lights.
#pragma once

#include "variants/axis.h"

namespace pt {

struct DirectLightTraits {
    bool connects = true;                // some vertex of a path is connected to a light
    bool connects_every_vertex = false;  // a path keeps its last BSDF pdf, for the MIS weight of light that it hits
    bool counts_light_met = true;        // light that a path hits after a connected vertex counts, too
};

namespace direct_light {

using Traits = DirectLightTraits;
inline constexpr Axis axis_facts{
    .what = "whether vertices are connected to lights",
    .order = 60,
    .decides_error = true,
    .decides_samples = true,
};

}  // namespace direct_light
}  // namespace pt
