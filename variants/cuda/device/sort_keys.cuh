// Device side of the sort keys: the bounds that positions are quantised in, and Morton codes.
#pragma once

#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/key_bounds.h"

namespace pt::cuda {

// The Morton code of a position, five bits an axis, x highest. A position outside the bounds counts as on their border;
// NaN as on the lower one.
__device__ inline std::uint32_t morton(const Vec3<Real>& position, const KeyBounds& bounds) {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float unit = (static_cast<float>(position[axis]) - bounds.low[axis]) * bounds.inverse_extent[axis];
        const auto cell = static_cast<std::uint32_t>(fminf(fmaxf(unit * 32.0f, 0.0f), 31.0f));
        for (int bit = 0; bit < 5; ++bit) {
            code |= (cell >> bit & 1u) << (3 * bit + 2 - axis);
        }
    }
    return code;
}

}  // namespace pt::cuda
