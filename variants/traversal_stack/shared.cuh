// The first entries in shared memory, which is as fast as the first cache but not in its way, the rest in local memory.
// Ylitie, Karras, Laine, HPG 2017, section 4.
#pragma once

#include "variants/acceleration/stacks.h"
#include "variants/traversal_stack/shared_column.cuh"

namespace pt::traversal_stack::shared {

template <class Open, std::uint32_t most>
struct Memory {
    static constexpr std::uint32_t first = shared_entries<Open>(tuned::shared_entries);
    static_assert(first < most);
    SharedColumn<Open, first> column;
    Open rest[most - first];

    PT_HD Open get(std::uint32_t i) const { return i < first ? column.get(i) : rest[i - first]; }
    PT_HD void set(std::uint32_t i, const Open& open) {
        if (i < first) {
            column.set(i, open);
        } else {
            rest[i - first] = open;
        }
    }
};

template <class Open, std::uint32_t most>
using Stack = FullStack<Open, Memory<Open, most>>;

}  // namespace pt::traversal_stack::shared
