// Live paths are appended to the next queue, with a scan in shared memory and one atomic operation a block.
#pragma once

#include "variants/cuda/append.cuh"

__device__ inline std::uint32_t append(std::uint32_t* count, bool keep) {
    return pt::cuda::append_by_block(count, keep);
}

#include "variants/cuda/append_kernels.cuh"
