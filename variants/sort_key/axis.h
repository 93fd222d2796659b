// The axis `sort_key`: what paths are put in order by.
#pragma once

#include <cstdint>

#include "variants/axis.h"

namespace pt {

// A key is (material << bits) + rest, or rest alone; rest is below 2^bits. By chunk it is a number of its own for each
// material of each chunk of the queue's slots: the chunk comes first, then the material, and bits is 0.
struct SortKeyTraits {
    std::uint32_t bits = 0;
    bool has_material = true;  // which is known only after the hit; other keys sort paths before they are traced
    bool by_chunk = false;     // it has the tunable `chunk`

    constexpr bool is_material_alone() const { return has_material && bits == 0 && !by_chunk; }
    // Whether a counting sort can take the keys: there are as many as materials (or as many a chunk), few enough to be
    // counted.
    constexpr bool is_countable() const { return has_material && bits == 0; }
};

namespace sort_key {

using Traits = SortKeyTraits;
inline constexpr Axis axis_facts{
    .what = "what paths are put in order by",
    .order = 40,
    .since = "5fdf3ee",
    .as_before = "material",
};

}  // namespace sort_key
}  // namespace pt
