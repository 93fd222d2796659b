// The kernel that ends a captured batch of samples: part of the programs of all integrators with a queue.
#pragma once

#include "variants/cuda/device/device.cuh"

// Advances the first sample of a CUDA graph, in device memory, for its next launch.
PT_UNBOUNDED_KERNEL(advance, pt::cuda::AdvanceParameters, (std::uint32_t * cursor, std::uint32_t samples)) {
    if (threadIdx.x == 0) {
        *cursor += samples;
    }
}
