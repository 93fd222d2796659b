// The axis `arithmetic`: how the compiler may round.
#pragma once

#include "variants/axis.h"

namespace pt {

struct ArithmeticTraits {
    bool is_approximate = false;  // division and square root are approximate, beyond the tolerances of tests
};

namespace arithmetic {

using Traits = ArithmeticTraits;
inline constexpr Axis axis_facts{
    .what = "how the compiler may round",
    .order = 120,
    .since = "5fdf3ee",
    .as_before = "exact",
};

}  // namespace arithmetic
}  // namespace pt
