// Host side of the stream compactions that append live paths to another queue: slot numbers, or the paths themselves.
#pragma once

#include "variants/cuda/device/append_parameters.h"
#include "variants/cuda/stages.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda {

inline constexpr Tunable append_tunables[] = {
    {"payload", 0, 0, 1, 1, "1: the paths themselves are moved, 0: their slot numbers (wavefront)"}};

class AppendCompaction final : public Compaction {
public:
    bool moves_paths() const override { return moves_payload_; }
    explicit AppendCompaction(const CellContext& context)
        : context_(context), module_(context.module()), moves_payload_(context.tunable("payload") != 0) {}

    bool needs_spare_paths() const override { return moves_payload_; }

    void compact(Queue& queue) override {
        PT_CUDA_CHECK(cudaMemsetAsync(queue.count_spare, 0, sizeof(std::uint32_t), context_.stream));
        const std::uint32_t blocks = blocks_for(queue.bound);
        const std::uint32_t* const order = queue.indirect ? queue.order : nullptr;
        if (moves_payload_) {
            module_.launch(blocks, stage_block, context_.stream,
                           AppendPathsParameters{queue.paths, order, queue.count, queue.spare, queue.count_spare});
            queue.swap_paths();
        } else {
            module_.launch(
                blocks, stage_block, context_.stream,
                AppendSlotsParameters{queue.paths, order, queue.count, queue.order_spare, queue.count_spare});
            queue.swap_order();
        }
        *context_.launches += 1;
        queue.indirect = !moves_payload_;
        queue.swap_count();
    }

private:
    CellContext context_;
    const Module& module_;
    bool moves_payload_;
};

}  // namespace pt::cuda
