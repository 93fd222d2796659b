// The sort per_material_queue: no sort of one queue but a queue a material. After the intersection each path's slot is
// appended to the queue of the material hit (or one for paths that left the scene), and shading runs once a queue.
#pragma once

#include <cstdint>

namespace pt::cuda {

// Parameters of the kernel that appends slot numbers to one queue a material: queue k holds `capacity` slots from
// queues + k * capacity.
struct AppendToQueuesParameters {
    static constexpr const char* kernel = "append_to_queues";
    const std::uint32_t* keys;
    const std::uint32_t* order;  // slots by position in the queue; null: slot i at position i
    const std::uint32_t* count;
    std::uint32_t queue_count;
    std::uint32_t capacity;
    std::uint32_t* queues;
    std::uint32_t* counts;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/device.cuh"

// Appends slot numbers to the queues of their materials. Lanes of one key share one atomic operation.
PT_KERNEL(append_to_queues, pt::cuda::AppendToQueuesParameters,
          (const std::uint32_t* keys, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t queue_count,
           std::uint32_t capacity, std::uint32_t* queues, std::uint32_t* counts)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const std::uint32_t key = i < *count ? keys[i] : queue_count;
    const unsigned together = __match_any_sync(0xffffffffu, key);
    const int leader = __ffs(static_cast<int>(together)) - 1;
    std::uint32_t first = 0;
    if (key < queue_count && pt::cuda::lane() == static_cast<unsigned>(leader)) {
        first = atomicAdd(&counts[key], static_cast<unsigned>(__popc(together)));
    }
    first = __shfl_sync(0xffffffffu, first, leader);
    if (key < queue_count) {
        const std::uint32_t position =
            first + static_cast<std::uint32_t>(__popc(together & ((1u << pt::cuda::lane()) - 1u)));
        queues[static_cast<std::size_t>(key) * capacity + position] = order != nullptr ? order[i] : i;
    }
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the choice's descriptor

#include "variants/cuda/stages.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::per_material_queue {
namespace {

class PerMaterialQueue final : public Sorting {
public:
    bool moves_paths() const override { return false; }
    explicit PerMaterialQueue(const CellContext& context) : context_(context), module_(context.module()) {}

    void reserve(Arena& arena, const Queue& queue) override {
        capacity_ = queue.capacity;
        queues_ = arena.take<std::uint32_t>(std::size_t{queue_count()} * queue.capacity);
        counts_ = arena.take<std::uint32_t>(queue_count());
    }

    void sort(Queue& queue, std::uint32_t) override {
        PT_CUDA_CHECK(cudaMemsetAsync(counts_, 0, queue_count() * sizeof(std::uint32_t), context_.stream));
        const std::uint32_t* const order = queue.indirect ? queue.order : nullptr;
        module_.launch(
            blocks_for(queue.bound), stage_block, context_.stream,
            AppendToQueuesParameters{queue.keys, order, queue.count, queue_count(), capacity_, queues_, counts_});
        *context_.launches += 1;
    }

    std::vector<ShadeRange> shade_ranges() const override {
        std::vector<ShadeRange> ranges;
        for (std::uint32_t key = 0; key < queue_count(); ++key) {
            ranges.push_back({queues_ + std::size_t{key} * capacity_, counts_ + key});
        }
        return ranges;
    }

private:
    std::uint32_t queue_count() const { return context_.materials + 1; }

    CellContext context_;
    const Module& module_;
    std::uint32_t capacity_ = 0;
    std::uint32_t* queues_ = nullptr;
    std::uint32_t* counts_ = nullptr;
};

constexpr Descriptor descriptor{
    .axis = "sorting",
    .name = "per_material_queue",
    .summary = "each path is appended to its material's own queue; shading is one kernel a material",
    .origin = "Laine, Karras and Aila 2013",
    .traits = SortingTraits{.reproducible_order = false},
    .backends = on_cuda,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        if (variant.sort_key.is_material_alone()) {
            return {};
        }
        return {"needs_material_key",
                "has a queue a material: needs sort_key=material, not " + std::string(variant.sort_key.name)};
    },
    .check_counters = sorted_every_bounce,
};

const Registration registration(descriptor,
                                {.cuda = {.sorting = [](const CellContext& context) -> std::unique_ptr<Sorting> {
                                              return std::make_unique<PerMaterialQueue>(context);
                                          },
                                          .kernels = {kernel_of<AppendToQueuesParameters>()}}});

}  // namespace
}  // namespace pt::cuda::sorting::per_material_queue

#endif
