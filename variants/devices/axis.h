// The axis `devices`: how many GPUs of the host render one image.
#pragma once

#include <cstdint>

#include "variants/axis.h"

namespace pt {

struct DevicesTraits {
    std::uint32_t count = 1;
};

namespace devices {

using Traits = DevicesTraits;
inline constexpr Axis axis_facts{
    .what = "how many GPUs of the host render one image",
    .order = 210,
    .since = "14df631",
    .as_before = "1",
};

}  // namespace devices
}  // namespace pt
