// The sort `bucket` on CUDA, a counting sort by material: histograms in shared memory, a scan over the keys, a scatter
// in which each block reserves its part of every bucket with one atomic operation. What is scattered are slot numbers,
// and paths stay in place; or, with sort_payload=1, paths with their hits, which shading then reads one after the
// other.
#pragma once

#include <cstdint>

#include "variants/cuda/device/counting_sort.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

struct CountKeysParameters {
    static constexpr const char* kernel = "count_keys";
    const std::uint32_t* keys;
    std::uint32_t bound;
    std::uint32_t key_count;
    std::uint32_t* totals;
};

// Parameters of the kernel that scans the totals of the keys, in one block: totals become where each bucket starts.
struct ScanKeysParameters {
    static constexpr const char* kernel = "scan_keys";
    std::uint32_t* totals;
    std::uint32_t key_count;
};

struct ScatterParameters {
    static constexpr const char* kernel = "scatter";
    const std::uint32_t* keys;
    const std::uint32_t* order;  // slots by position in the queue; null: slot i at position i
    std::uint32_t bound;
    std::uint32_t key_count;
    std::uint32_t* next;
    std::uint32_t* sorted;
};

struct ScatterPathsParameters {
    static constexpr const char* kernel = "scatter_paths";
    const std::uint32_t* keys;
    const std::uint32_t* order;
    const std::uint32_t* count;
    std::uint32_t key_count;
    std::uint32_t* next;
    PathStore paths, sorted;
    const void* hits;  // StoredHit by slot of a path
    void* sorted_hits;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/device.cuh"

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

// Where in the sorted queue the thread's element goes: each block reserves its part of every bucket.
__device__ inline std::uint32_t sorted_position(bool exists, const std::uint32_t* keys, std::uint32_t key_count,
                                                std::uint32_t* next) {
    __shared__ std::uint32_t place[pt::cuda::most_bucket_keys];
    clear_shared(place, key_count);
    const std::uint32_t i = pt::cuda::thread_number();
    const std::uint32_t rank = exists ? atomicAdd(&place[keys[i]], 1u) : 0;
    __syncthreads();
    for (std::uint32_t key = threadIdx.x; key < key_count; key += kernel_config.block) {
        place[key] = place[key] != 0 ? atomicAdd(&next[key], place[key]) : 0;
    }
    __syncthreads();
    return exists ? place[keys[i]] + rank : 0;
}

// Scatters slot numbers to the buckets of their keys. Positions beyond the count get any slot, which nobody reads.
PT_KERNEL(scatter, pt::cuda::ScatterParameters,
          (const std::uint32_t* keys, const std::uint32_t* order, std::uint32_t bound, std::uint32_t key_count,
           std::uint32_t* next, std::uint32_t* sorted)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const std::uint32_t position = sorted_position(i < bound, keys, key_count, next);
    if (i < bound) {
        sorted[position] = order != nullptr ? order[i] : i;
    }
}

// Scatters the paths in play and their hits. The largest key is that of positions beyond the count, so the paths take
// the first slots.
PT_KERNEL(scatter_paths, pt::cuda::ScatterPathsParameters,
          (const std::uint32_t* keys, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t key_count,
           std::uint32_t* next, PathStore paths, PathStore sorted, const void* hits, void* sorted_hits)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const bool in_play = i < *count;
    const std::uint32_t position = sorted_position(in_play, keys, key_count, next);
    if (in_play) {
        const std::uint32_t slot = order != nullptr ? order[i] : i;
        Paths(sorted).store(position, Paths(paths).load(slot));
        static_cast<StoredHit*>(sorted_hits)[position] = static_cast<const StoredHit*>(hits)[slot];
    }
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the choice's descriptor

#include <stdexcept>
#include "variants/cuda/stages.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::bucket {
namespace {

class Bucket final : public Sorting {
public:
    explicit Bucket(const CellContext& context)
        : context_(context), module_(context.module()), moves_payload_(context.tunable("sort_payload") != 0) {}

    bool moves_paths() const override { return moves_payload_; }
    bool needs_spare_paths() const override { return moves_payload_; }

    void reserve(Arena& arena, const Queue&) override { totals_ = arena.take<std::uint32_t>(most_bucket_keys); }

    void sort(Queue& queue, std::uint32_t key_count) override {
        if (key_count > most_bucket_keys) {
            throw std::runtime_error("sorting=bucket counts at most " + std::to_string(most_bucket_keys) +
                                     " keys, not " + std::to_string(key_count));
        }
        PT_CUDA_CHECK(cudaMemsetAsync(totals_, 0, key_count * sizeof(std::uint32_t), context_.stream));
        const std::uint32_t blocks = blocks_for(queue.bound);
        const std::uint32_t* const order = queue.indirect ? queue.order : nullptr;
        module_.launch(blocks, stage_block, context_.stream,
                       CountKeysParameters{queue.keys, queue.bound, key_count, totals_});
        module_.launch(1, stage_block, context_.stream, ScanKeysParameters{totals_, key_count});
        if (moves_payload_) {
            module_.launch(blocks, stage_block, context_.stream,
                           ScatterPathsParameters{queue.keys, order, queue.count, key_count, totals_, queue.paths,
                                                  queue.spare, queue.hits, queue.hits_spare});
            queue.swap_paths();
            queue.swap_hits();
        } else {
            module_.launch(blocks, stage_block, context_.stream,
                           ScatterParameters{queue.keys, order, queue.bound, key_count, totals_, queue.order_spare});
            queue.swap_order();
        }
        *context_.launches += 3;
        queue.indirect = !moves_payload_;
    }

private:
    CellContext context_;
    const Module& module_;
    bool moves_payload_;
    std::uint32_t* totals_ = nullptr;
};

constexpr Tunable tunables[] = {
    {"sort_payload", 0, 0, 1, 1, "1: paths and their hits are moved, into second stores; 0: slot numbers are"}};

constexpr Descriptor descriptor{
    .axis = "sorting",
    .name = "bucket",
    .summary = "counting sort of slot numbers or of paths, histograms in shared memory",
    .origin = "Cycles' sorted index array",
    .traits = SortingTraits{.reproducible_order = false},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        const auto payload = variant.tuning.find("sort_payload");
        if (payload != variant.tuning.end() && payload->second != 0 && variant.integrator.refills_queue) {
            return {"paths_keep_their_slots",
                    "moves paths with sort_payload=1, but integrator=" + std::string(variant.integrator.name) +
                        " puts new paths into the slots of those that end: needs sort_payload=0"};
        }
        if (variant.sort_key.is_countable()) {
            return {};
        }
        return {"needs_material_key",
                "has a bucket a material, or one in each chunk: needs sort_key=material or chunk_material, not " +
                    std::string(variant.sort_key.name)};
    },
    .check_counters = sorted_every_bounce,
};

const Registration registration(
    descriptor, {.cuda = {.sorting = [](const CellContext& context) -> std::unique_ptr<Sorting> {
                              return std::make_unique<Bucket>(context);
                          },
                          .kernels = {kernel_of<CountKeysParameters>(), kernel_of<ScanKeysParameters>(),
                                      kernel_of<ScatterParameters>(), kernel_of<ScatterPathsParameters>()}}});

}  // namespace
}  // namespace pt::cuda::sorting::bucket

#endif
