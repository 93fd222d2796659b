// The axis `launch`: how kernels are launched.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LaunchTraits {
    bool is_captured = false;  // a batch of samples is launched as a CUDA graph
    bool loops = false;        // the graph contains a loop over segments that ends with the last path
};

namespace launch {

using Traits = LaunchTraits;
inline constexpr Axis axis_facts{
    .what = "how kernels are launched",
    .order = 110,
    .since = "5fdf3ee",
    .as_before = "stream",
};

}  // namespace launch
}  // namespace pt
