// The axis `sorting`: how paths are put in order before they are shaded.
#pragma once

#include "variants/axis.h"

namespace pt {

struct SortingTraits {
    bool sorts = true;
    bool host_sync = false;          // the host waits for the device within a sort, which no CUDA graph can hold
    bool reproducible_order = true;  // a path has the same queue position in every run
};

namespace sorting {

using Traits = SortingTraits;
inline constexpr Axis axis_facts{
    .what = "how paths are put in order before they are shaded",
    .order = 30,
};

}  // namespace sorting
}  // namespace pt
