// The axis `sort_key`: what paths are put in order by.
#pragma once

#include <cstdint>

#include "variants/axis.h"

namespace pt {

// A sort key is (material << bits) + rest, or rest alone; rest is below 2^bits. With by_chunk, a key numbers the
// materials of each chunk of the queue's slots, chunk by chunk, and bits is 0.
struct SortKeyTraits {
    std::uint32_t bits = 0;
    bool has_material = true;  // the key needs the material that was hit; other keys sort paths before these are traced
    bool by_chunk = false;     // keys number the materials within each chunk of slots (tunable `chunk`)

    constexpr bool is_material_alone() const { return has_material && bits == 0 && !by_chunk; }
    // Whether sort keys are few enough for a counting sort: one a material, or one a material of each chunk.
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
