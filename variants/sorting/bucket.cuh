// Counting sort of slot numbers by material on the device: histograms in shared memory, a scan over the keys, a scatter
// in which each block reserves its part of every bucket with one atomic operation. The payload stays in place.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"

constexpr std::uint32_t most_keys = 4096;  // 16 KiB of shared memory

__device__ inline void clear_shared(std::uint32_t* histogram, std::uint32_t key_count) {
    for (std::uint32_t key = threadIdx.x; key < key_count; key += PT_BLOCK) {
        histogram[key] = 0;
    }
    __syncthreads();
}

extern "C" __global__ void PT_LAUNCH_BOUNDS count_keys(const std::uint32_t* keys, std::uint32_t bound,
                                                       std::uint32_t key_count, std::uint32_t* totals) {
    __shared__ std::uint32_t histogram[most_keys];
    clear_shared(histogram, key_count);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < bound) {
        atomicAdd(&histogram[keys[i]], 1u);
    }
    __syncthreads();
    for (std::uint32_t key = threadIdx.x; key < key_count; key += PT_BLOCK) {
        if (histogram[key] != 0) {
            atomicAdd(&totals[key], histogram[key]);
        }
    }
}

// One block: totals become where each bucket starts.
extern "C" __global__ void PT_LAUNCH_BOUNDS scan_keys(std::uint32_t* totals, std::uint32_t key_count) {
    if (threadIdx.x < 32) {
        std::uint32_t before = 0;
        for (std::uint32_t first = 0; first < key_count; first += 32) {
            const std::uint32_t key = first + pt::cuda::lane();
            const std::uint32_t mine = key < key_count ? totals[key] : 0;
            std::uint32_t scan = mine;
            for (unsigned offset = 1; offset < 32; offset *= 2) {
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

// `order`: null for slot i at position i. Positions beyond the count keep any slot: nobody reads them.
extern "C" __global__ void PT_LAUNCH_BOUNDS scatter(const std::uint32_t* keys, const std::uint32_t* order,
                                                    std::uint32_t bound, std::uint32_t key_count, std::uint32_t* next,
                                                    std::uint32_t* sorted) {
    __shared__ std::uint32_t place[most_keys];
    clear_shared(place, key_count);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t rank = 0;
    if (i < bound) {
        rank = atomicAdd(&place[keys[i]], 1u);
    }
    __syncthreads();
    for (std::uint32_t key = threadIdx.x; key < key_count; key += PT_BLOCK) {
        place[key] = place[key] != 0 ? atomicAdd(&next[key], place[key]) : 0;
    }
    __syncthreads();
    if (i < bound) {
        sorted[place[keys[i]] + rank] = order != nullptr ? order[i] : i;
    }
}

#else

#include <stdexcept>

#include "variants/cuda/stages.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::bucket {

inline constexpr std::uint32_t block = 256;
inline constexpr std::uint32_t most_keys = 4096;

class Bucket final : public Sorting {
public:
    bool moves_paths() const override { return false; }
    explicit Bucket(const CellContext& context)
        : context_(context), module_(context.module("variants/sorting/bucket.cuh")) {}

    void reserve(Arena& arena, const Queue&) override { totals_ = arena.take<std::uint32_t>(most_keys); }

    void sort(Queue& queue, std::uint32_t key_count) override {
        if (key_count > most_keys) {
            throw std::runtime_error("sorting=bucket counts at most " + std::to_string(most_keys) + " keys, not " +
                                     std::to_string(key_count));
        }
        PT_CUDA_CHECK(cudaMemsetAsync(totals_, 0, key_count * sizeof(std::uint32_t), context_.stream));
        const std::uint32_t blocks = (queue.bound + block - 1) / block;
        const std::uint32_t* const order = queue.indirect ? queue.order : nullptr;
        module_.launch("count_keys", blocks, block, context_.stream, queue.keys, queue.bound, key_count, totals_);
        module_.launch("scan_keys", 1, block, context_.stream, totals_, key_count);
        module_.launch("scatter", blocks, block, context_.stream, queue.keys, order, queue.bound, key_count, totals_,
                       queue.order_spare);
        *context_.launches += 3;
        queue.swap_order();
        queue.indirect = true;
    }

private:
    CellContext context_;
    const Module& module_;
    std::uint32_t* totals_ = nullptr;
};

inline constexpr Descriptor descriptor{
    .axis = "sorting",
    .name = "bucket",
    .summary = "counting sort of slot numbers, histograms in shared memory; the payload stays in place",
    .origin = "Cycles' sorted index array",
    .traits = SortingTraits{.reproducible_order = false},
    .backends = on_cuda,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        if (variant.sort_key.is_material_alone()) {
            return {};
        }
        return {"needs_material_key",
                "has a bucket a material: needs sort_key=material, not " + std::string(variant.sort_key.name)};
    },
    .check_counters = sorted_every_bounce,
};

inline const Hooks hooks{.sorting = [](const CellContext& context) -> std::unique_ptr<Sorting> {
    return std::make_unique<Bucket>(context);
}};

}  // namespace pt::cuda::sorting::bucket

#endif
