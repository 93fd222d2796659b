// Live paths are appended to the next queue, with one atomic operation a warp. In wavefront a kernel after shading; in
// wavefront_fused part of the bounce's kernel.
#pragma once

#include "variants/cuda/append.cuh"

__device__ inline std::uint32_t append(std::uint32_t* count, bool keep) {
    return pt::cuda::append_by_warp(count, keep);
}

#include "variants/cuda/append_kernels.cuh"
