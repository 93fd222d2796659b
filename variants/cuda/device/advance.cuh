// The kernel that ends a captured batch: part of the programs of the integrators with a queue.
#pragma once

#include "variants/cuda/device/device.cuh"

// Moves the number of a CUDA graph's first sample on, on the device, for the next launch.
PT_UNBOUNDED_KERNEL(advance, pt::cuda::AdvanceParameters, (std::uint32_t * cursor, std::uint32_t samples)) {
    if (threadIdx.x == 0) {
        *cursor += samples;
    }
}
