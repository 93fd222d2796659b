// The axis `partition`: which samples or pixels of an image each GPU takes.
#pragma once

#include "variants/axis.h"

namespace pt {

struct PartitionTraits {
    bool is_by_rows = false;  // each GPU renders all samples of its rows of pixels; else some of every pixel's samples
    bool is_dynamic = false;  // a GPU that has done its samples takes more of them
};

namespace partition {

using Traits = PartitionTraits;
inline constexpr Axis axis_facts{
    .what = "which samples or pixels of an image each GPU takes",
    .order = 220,
    .since = "14df631",
    .as_before = "samples",
};

}  // namespace partition
}  // namespace pt
