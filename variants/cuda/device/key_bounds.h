// The bounds in which sort keys quantise positions. Shared by host and NVRTC.
#pragma once

namespace pt::cuda {

// Maps positions to [0, 1)^3 for Morton codes: (position - low) * inverse_extent, clamped by the caller.
struct KeyBounds {
    float low[3] = {0, 0, 0};
    float inverse_extent[3] = {1, 1, 1};
};

}  // namespace pt::cuda
