// Morton keys: ten bits of each coordinate of a box's centre, interleaved, over the primitive's number. Keys are
// distinct, so that one order exists. Lauterbach et al., "Fast BVH Construction on GPUs", CGF 28 (2), 2009.
#pragma once

#include "kernels/math.h"

namespace pt {

// Spreads the ten bits of a number three apart: two zero bits follow each bit.
PT_HD constexpr std::uint32_t spread_bits(std::uint32_t x) {
    x = (x | (x << 16)) & 0x030000ffu;
    x = (x | (x << 8)) & 0x0300f00fu;
    x = (x | (x << 4)) & 0x030c30c3u;
    return (x | (x << 2)) & 0x09249249u;
}

// The cell of a box's centre, of 1024 along an axis of the box of all centres; an axis without extent is one cell.
PT_HD inline std::uint32_t morton_cell(float centre, float low, float high) {
    const float extent = high - low;
    const float cell = extent > 0 ? (centre - low) / extent * 1024.0f : 0.0f;
    return cell < 1023.0f ? static_cast<std::uint32_t>(cell) : 1023u;
}

PT_HD inline std::uint64_t morton_key(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t primitive) {
    const std::uint32_t code = spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
    return static_cast<std::uint64_t>(code) << 32 | primitive;
}

}  // namespace pt
