// Counting sort of slot numbers by material on the device: histograms in shared memory, a scan over the keys, a scatter
// in which each block reserves its part of every bucket with one atomic operation. The payload stays in place.
#pragma once

#include "variants/cuda/device.cuh"
#include "variants/sorting/bucket_parameters.cuh"

__device__ inline void clear_shared(std::uint32_t* histogram, std::uint32_t key_count) {
    for (std::uint32_t key = threadIdx.x; key < key_count; key += kernel_config.block) {
        histogram[key] = 0;
    }
    __syncthreads();
}

PT_KERNEL(count_keys, pt::cuda::CountKeysParameters,
          (const std::uint32_t* keys, std::uint32_t bound, std::uint32_t key_count, std::uint32_t* totals)) {
    __shared__ std::uint32_t histogram[pt::cuda::most_bucket_keys];
    clear_shared(histogram, key_count);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < bound) {
        atomicAdd(&histogram[keys[i]], 1u);
    }
    __syncthreads();
    for (std::uint32_t key = threadIdx.x; key < key_count; key += kernel_config.block) {
        if (histogram[key] != 0) {
            atomicAdd(&totals[key], histogram[key]);
        }
    }
}

// Scans the totals of the keys, in one block: totals become where each bucket starts.
PT_KERNEL(scan_keys, pt::cuda::ScanKeysParameters, (std::uint32_t * totals, std::uint32_t key_count)) {
    if (threadIdx.x < warp_size) {
        std::uint32_t before = 0;
        for (std::uint32_t first = 0; first < key_count; first += warp_size) {
            const std::uint32_t key = first + pt::cuda::lane();
            const std::uint32_t mine = key < key_count ? totals[key] : 0;
            std::uint32_t scan = mine;
            for (unsigned offset = 1; offset < warp_size; offset *= 2) {
                const std::uint32_t left = __shfl_up_sync(0xffffffffu, scan, offset);
                scan += pt::cuda::lane() >= offset ? left : 0;
            }
            if (key < key_count) {
                totals[key] = before + scan - mine;
            }
            before += __shfl_sync(0xffffffffu, scan, 31);
        }
    }
}

// Scatters slot numbers to their buckets. `order`: null for slot i at position i. Positions beyond the count keep any
// slot: nobody reads them.
PT_KERNEL(scatter, pt::cuda::ScatterParameters,
          (const std::uint32_t* keys, const std::uint32_t* order, std::uint32_t bound, std::uint32_t key_count,
           std::uint32_t* next, std::uint32_t* sorted)) {
    __shared__ std::uint32_t place[pt::cuda::most_bucket_keys];
    clear_shared(place, key_count);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t rank = 0;
    if (i < bound) {
        rank = atomicAdd(&place[keys[i]], 1u);
    }
    __syncthreads();
    for (std::uint32_t key = threadIdx.x; key < key_count; key += kernel_config.block) {
        place[key] = place[key] != 0 ? atomicAdd(&next[key], place[key]) : 0;
    }
    __syncthreads();
    if (i < bound) {
        sorted[place[keys[i]] + rank] = order != nullptr ? order[i] : i;
    }
}
