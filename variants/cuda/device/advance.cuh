// The kernel that advances a CUDA graph's first sample at a batch's end: in all programs of integrators with a queue.
#pragma once

#include "variants/cuda/device/device.cuh"

// Advances the first sample of a CUDA graph, in device memory, for its next launch.
PT_UNBOUNDED_KERNEL(advance, pt::cuda::AdvanceParameters, (std::uint32_t * cursor, std::uint32_t samples)) {
    if (threadIdx.x == 0) {
        *cursor += samples;
    }
}
