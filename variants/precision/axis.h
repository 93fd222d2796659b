// The axis `precision`: single or double precision, and where.
#pragma once

#include <cstdint>

#include "variants/axis.h"

namespace pt {

struct PrecisionTraits {
    std::uint32_t real_bytes = 4;  // bytes of each real number of a path
    bool intersects_in_double = false;

    constexpr bool is_double() const { return real_bytes == 8; }
    constexpr bool is_mixed() const { return !is_double() && intersects_in_double; }
    constexpr bool is_single() const { return !is_double() && !intersects_in_double; }
};

namespace precision {

using Traits = PrecisionTraits;
inline constexpr Axis axis_facts{
    .what = "single or double precision, and where",
    .order = 130,
    .since = "5fdf3ee",
    .as_before = "float",
    .decides_error = true,
};

}  // namespace precision
}  // namespace pt
