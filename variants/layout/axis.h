// The axis `layout`: how paths lie in memory.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LayoutTraits {
    bool keeps_paths_whole = false;  // a path lies in memory as one record, which suits integrators without a queue
};

namespace layout {

using Traits = LayoutTraits;
inline constexpr Axis axis_facts{
    .what = "how paths lie in memory",
    .order = 90,
};

}  // namespace layout
}  // namespace pt
