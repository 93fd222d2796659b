// A link: what a node knows of a child in 32 bits, either an inner node's number or a leaf's slots.
#pragma once

#include "kernels/config.h"

#include <cstdint>

namespace pt {

inline constexpr std::uint32_t leaf_flag = 0x80000000u;
inline constexpr std::uint32_t slot_bits = 27;
inline constexpr std::uint32_t max_slots = 1u << slot_bits;
inline constexpr std::uint32_t max_leaf_size = 16;

PT_HD constexpr std::uint32_t leaf_link(std::uint32_t first, std::uint32_t count) {
    return leaf_flag | ((count - 1) << slot_bits) | first;
}
PT_HD constexpr bool is_leaf_link(std::uint32_t link) { return (link & leaf_flag) != 0; }
PT_HD constexpr std::uint32_t first_slot(std::uint32_t link) { return link & (max_slots - 1); }
PT_HD constexpr std::uint32_t slot_count(std::uint32_t link) { return ((link & ~leaf_flag) >> slot_bits) + 1; }

}  // namespace pt
