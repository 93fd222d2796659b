// The compaction cub_partition: cub::DevicePartition::If writes the slots of ended paths, too, behind the live ones.
// Against cub_select_if it shows what keeping them costs.
#include <cub/device/device_partition.cuh>

#include "variants/cuda/cub_compaction.h"

namespace pt::cuda::compaction::cub_partition {
namespace {

struct Algorithm {
    static cudaError_t slots(void* memory, std::size_t& bytes, const SlotAt& slot_at, const IsAlive& is_alive,
                             std::uint32_t* kept, std::uint32_t* count, int items, cudaStream_t stream) {
        return cub::DevicePartition::If(memory, bytes, by_position(slot_at), kept, count, items, is_alive, stream);
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "cub_partition",
        .summary = "cub::DevicePartition::If of slot numbers; the count stays on the device",
        .origin = "Merrill and Garland 2016 (single-pass scan)",
        .traits = CompactionTraits{.payload_contiguous = false},
        .backends = on_cuda,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = [](const CellContext& cell) -> std::unique_ptr<Compaction> {
        return std::make_unique<CubIndexCompaction<Algorithm>>(cell);
    }});

}  // namespace
}  // namespace pt::cuda::compaction::cub_partition
