// Appending to a queue in global memory from many threads: finds the position of each kept element.
// Device code for blocks of kernel_config.block threads. Every thread of a block must call these functions.
#pragma once

#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/list_counts.h"

namespace pt::cuda {

// The sum of the lanes' values up to the calling lane's own. Every lane of the warp must call it.
__device__ inline std::uint32_t sum_up_to_lane(std::uint32_t value) {
    for (unsigned offset = 1; offset < 32; offset *= 2) {
        const std::uint32_t left = __shfl_up_sync(0xffffffffu, value, offset);
        value += lane() >= offset ? left : 0;
    }
    return value;
}

// Gives every thread that keeps a value its position in a queue, by one atomic operation per warp. Adinetz 2014, "CUDA
// Pro Tip: Optimized Filtering with Warp-Aggregated Atomics".
__device__ inline std::uint32_t append_by_warp(std::uint32_t* count, bool keep) {
    const unsigned kept = __ballot_sync(0xffffffffu, keep);
    std::uint32_t first = 0;
    if (lane() == 0 && kept != 0) {
        first = atomicAdd(count, static_cast<unsigned>(__popc(kept)));
    }
    first = __shfl_sync(0xffffffffu, first, 0);
    return first + rank_in(kept);
}

// Gives every thread that keeps a value its position in a queue, by one atomic operation per block: the warps' counts
// are scanned in shared memory. Within a block the order is kept.
__device__ inline std::uint32_t append_by_block(std::uint32_t* count, bool keep) {
    constexpr unsigned warps = kernel_config.block / warp_size;
    __shared__ std::uint32_t before[warps];
    const unsigned kept = __ballot_sync(0xffffffffu, keep);
    const unsigned warp = threadIdx.x / warp_size;
    if (lane() == 0) {
        before[warp] = static_cast<std::uint32_t>(__popc(kept));
    }
    __syncthreads();
    if (warp == 0) {
        const std::uint32_t mine = lane() < warps ? before[lane()] : 0;
        const std::uint32_t scan = sum_up_to_lane(mine);
        const std::uint32_t total = __shfl_sync(0xffffffffu, scan, 31);
        std::uint32_t first = 0;
        if (lane() == 0 && total != 0) {
            first = atomicAdd(count, total);
        }
        first = __shfl_sync(0xffffffffu, first, 0);
        if (lane() < warps) {
            before[lane()] = first + scan - mine;
        }
    }
    __syncthreads();
    const std::uint32_t position = before[warp] + rank_in(kept);
    __syncthreads();  // all warps have read `before`: the next call overwrites it
    return position;
}

// Resets a list's counts once all thread blocks have called it, each thread of a block after all else that it does.
__device__ inline void finish_list(ListCounts* counts) {
    __syncthreads();
    if (threadIdx.x == 0) {
        __threadfence();
        if (atomicAdd(&counts->finished, 1u) == gridDim.x - 1) {
            *counts = {};
        }
    }
}

// Elements gathered by a block: element i below `count` gets position first + i among the elements of all blocks.
struct Gathered {
    std::uint32_t first, count;   // position of the block's first element among all blocks'; undefined if it has none
    const std::uint32_t* values;  // the block's gathered values in shared memory, until it gathers again
};

// append_by_block, which here also puts the block's kept values side by side into shared memory, in thread order.
__device__ inline Gathered gather_by_block(std::uint32_t* count, bool keep, std::uint32_t value) {
    __shared__ std::uint32_t values[kernel_config.block];
    __shared__ std::uint32_t first;
    const std::uint32_t position = append_by_block(count, keep);
    if (threadIdx.x == 0) {
        first = position;  // position of the first element that the block keeps
    }
    const std::uint32_t kept = static_cast<std::uint32_t>(__syncthreads_count(keep ? 1 : 0));
    if (keep) {
        values[position - first] = value;
    }
    __syncthreads();
    return {first, kept, values};
}

}  // namespace pt::cuda
