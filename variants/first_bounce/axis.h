// The axis `first_bounce`: whether first hits are kept and used again.
#pragma once

#include "variants/axis.h"

namespace pt {

struct FirstBounceTraits {
    bool keeps_hits = true;
};

namespace first_bounce {

using Traits = FirstBounceTraits;
inline constexpr Axis axis_facts{
    .what = "whether first hits are kept and used again",
    .order = 50,
    .decides_error = true,
    .decides_samples = true,
};

}  // namespace first_bounce
}  // namespace pt
