// The axis `robustness`: numerically stable formulas, or the textbook's.
#pragma once

#include "variants/axis.h"

namespace pt {

struct RobustnessTraits {
    bool is_naive = false;
};

namespace robustness {

using Traits = RobustnessTraits;
inline constexpr Axis axis_facts{
    .what = "the forms that are stable, or the textbook's",
    .order = 140,
    .since = "94b5403",
    .as_before = "robust",
    .by_pairs = true,
};

}  // namespace robustness
}  // namespace pt
