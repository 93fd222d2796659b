// The axis `light_sampling`: how points on lights are drawn.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LightSamplingTraits {
    bool is_by_solid_angle = true;  // light directions are drawn by solid angle, by a function of the light's shape
};

namespace light_sampling {

using Traits = LightSamplingTraits;
inline constexpr Axis axis_facts{
    .what = "how points on lights are drawn",
    .order = 200,
    .since = "a7e8939",
    .as_before = "solid_angle",
    .by_pairs = true,
};

}  // namespace light_sampling
}  // namespace pt
