// The axis `subsurface_sampling`: how walks through bodies are drawn.
#pragma once

#include "variants/axis.h"

namespace pt {

struct SubsurfaceSamplingTraits {
    bool is_classical = true;
};

namespace subsurface_sampling {

using Traits = SubsurfaceSamplingTraits;
inline constexpr Axis axis_facts{
    .what = "how walks through bodies are drawn",
    .order = 240,
    .since = "c229cea",
    .as_before = "classical",
    .by_pairs = true,
    .decides_error = true,
};

}  // namespace subsurface_sampling
}  // namespace pt
