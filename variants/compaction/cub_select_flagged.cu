// The compaction cub_select_flagged: cub::DeviceSelect::Flagged reads one flag a position that says whether the path is
// kept. The count stays on the device.
#include <cub/device/device_select.cuh>

#include "variants/cuda/cub_compaction.h"

namespace pt::cuda::compaction::cub_select_flagged {
namespace {

struct Algorithm {
    static cudaError_t slots(void* memory, std::size_t& bytes, const SlotAt& slot_at, const IsAlive& is_alive,
                             std::uint32_t* kept, std::uint32_t* count, int items, cudaStream_t stream) {
        return cub::DeviceSelect::Flagged(memory, bytes, by_position(slot_at),
                                          by_position(IsAliveAt{slot_at, is_alive}), kept, count, items, stream);
    }
    template <class Paths>
    static cudaError_t paths(void* memory, std::size_t& bytes, const PathStore& from, const PathStore& to,
                             const SlotAt& slot_at, const IsAlive& is_alive, std::uint32_t* count, int items,
                             cudaStream_t stream) {
        return cub::DeviceSelect::Flagged(memory, bytes, by_position(PathAt<Paths>{Paths(from), slot_at.count}),
                                          by_position(IsAliveAt{slot_at, is_alive}), payload_begin<Paths>(to), count,
                                          items, stream);
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "cub_select_flagged",
        .summary = "cub::DeviceSelect::Flagged of slot numbers (payload=1: of paths); the count stays on the device",
        .origin = "Merrill and Garland 2016 (single-pass scan); Cycles' active index array",
        .traits = CompactionTraits{.payload_contiguous = false},
        .backends = on_cuda,
        .tunables = payload_tunables,
        .unsupported_reason = payload_needs_single_precision,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = &make_cub_compaction<Algorithm>});

}  // namespace
}  // namespace pt::cuda::compaction::cub_select_flagged
