// The axis `example_` of a test: a folder of variants/ that nothing else in the repository names.
#pragma once

#include "variants/axis.h"

namespace pt {

struct ExampleTraits {
    int value = 1;
};

namespace example_ {

using Traits = ExampleTraits;
inline constexpr Axis axis_facts{
    .what = "what a test adds",
    .order = 35,
};

}  // namespace example_
}  // namespace pt
