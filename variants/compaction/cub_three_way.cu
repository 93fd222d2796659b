// The compaction cub_three_way: cub::DevicePartition::If in three ways drops ended paths and puts the live ones in two
// groups by the surface that they leave, diffuse-like before delta-like. That is half a sort.
#include <algorithm>

#include <thrust/iterator/discard_iterator.h>
#include <cub/device/device_partition.cuh>

#include "variants/cuda/cub_compaction.h"

namespace pt::cuda::compaction::cub_three_way {
namespace {

// Whether a path is alive and leaves a surface of the wanted class. A camera ray, which leaves none, is diffuse-like.
struct IsAliveOfClass {
    IsAlive is_alive;
    FieldView origin_surface;
    const unsigned char* object_class = nullptr;
    unsigned char wanted = 0;

    PT_HD bool operator()(std::uint32_t slot) const {
        if (!is_alive(slot)) {
            return false;
        }
        const SurfaceId side{value_at(origin_surface, slot)};
        return (side.exists() ? object_class[side.object()] : 0) == wanted;
    }
};

// Appends the delta-like group of paths to the diffuse-like one and adds their counts.
__global__ void append_group(std::uint32_t* first, const std::uint32_t* second, const std::uint32_t* counts,
                             std::uint32_t* total) {
    const std::uint32_t begin = counts[0], size = counts[1];
    const std::uint32_t stride = gridDim.x * blockDim.x;
    const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    for (std::uint32_t i = thread; i < size; i += stride) {
        first[begin + i] = second[i];
    }
    if (thread == 0) {
        *total = begin + size;
    }
}

class CubThreeWay final : public Compaction {
public:
    bool moves_paths() const override { return false; }
    explicit CubThreeWay(const CellContext& cell) : cell_(cell) {}

    void reserve(Arena& arena, const Queue& queue) override {
        delta_like_ = arena.take<std::uint32_t>(queue.capacity);
        group_counts_ = arena.take<std::uint32_t>(2);
        storage_.reserve(arena, [&](void* memory, std::size_t& bytes) {
            return partition(memory, bytes, SlotAt{}, IsAliveOfClass{}, nullptr, queue.capacity);
        });
    }
    void compact(Queue& queue) override {
        if (queue.bound == 0) {
            return;
        }
        const IsAliveOfClass of_class{is_alive(queue, cell_),
                                      cell_.layout->origin_surface(queue.paths, cell_.real_bytes), queue.object_class};
        storage_.run([&](void* memory, std::size_t& bytes) {
            return partition(memory, bytes, slot_at(queue), of_class, queue.order_spare, queue.bound);
        });
        constexpr std::uint32_t threads = 256, blocks_per_multiprocessor = 8;
        const std::uint32_t blocks =
            std::min((queue.bound - 1) / threads + 1, cell_.multiprocessors * blocks_per_multiprocessor);
        append_group<<<blocks, threads, 0, cell_.stream>>>(queue.order_spare, delta_like_, group_counts_,
                                                           queue.count_spare);
        PT_CUDA_CHECK(cudaGetLastError());
        *cell_.launches += 2;
        queue.swap_order();
        queue.swap_count();
        queue.indirect = true;
    }

private:
    cudaError_t partition(void* memory, std::size_t& bytes, const SlotAt& slot_at, IsAliveOfClass of_class,
                          std::uint32_t* diffuse_like, std::uint32_t items) const {
        IsAliveOfClass is_diffuse_like = of_class, is_delta_like = of_class;
        is_diffuse_like.wanted = 0;
        is_delta_like.wanted = 1;
        return cub::DevicePartition::If(memory, bytes, by_position(slot_at), diffuse_like, delta_like_,
                                        thrust::make_discard_iterator(), group_counts_, static_cast<int>(items),
                                        is_diffuse_like, is_delta_like, cell_.stream);
    }

    CellContext cell_;
    CubStorage storage_;
    std::uint32_t* delta_like_ = nullptr;    // slots of delta-like paths, until appended to those of diffuse-like paths
    std::uint32_t* group_counts_ = nullptr;  // sizes of the diffuse-like and the delta-like group of paths
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "cub_three_way",
        .summary = "cub::DevicePartition::If of slot numbers into ended, diffuse-like and delta-like; the count stays "
                   "on the device",
        .origin = "CUB's three-way partition; grouping by material class as in Laine, Karras and Aila 2013",
        .traits = CompactionTraits{.payload_contiguous = false},
        .backends = on_cuda,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = [](const CellContext& cell) -> std::unique_ptr<Compaction> {
        return std::make_unique<CubThreeWay>(cell);
    }});

}  // namespace
}  // namespace pt::cuda::compaction::cub_three_way
