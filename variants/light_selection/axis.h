// The axis `light_selection`: which of several lights is drawn.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LightSelectionTraits {
    bool is_uniform = true;
};

namespace light_selection {

using Traits = LightSelectionTraits;
inline constexpr Axis axis_facts{
    .what = "which of several lights is drawn",
    .order = 230,
    .since = "48ac371",
    .as_before = "uniform",
    .by_pairs = true,
};

}  // namespace light_selection
}  // namespace pt
