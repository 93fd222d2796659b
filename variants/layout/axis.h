// The axis `layout`: how paths lie in memory.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LayoutTraits {
    bool keeps_paths_whole = false;  // a path is stored as one record, so integrators without an array can have it
};

namespace layout {

using Traits = LayoutTraits;
inline constexpr Axis axis_facts{
    .what = "how paths lie in memory",
    .order = 90,
};

}  // namespace layout
}  // namespace pt
