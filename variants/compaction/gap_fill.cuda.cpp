// The host's side of gap_fill.cuh.
#include "variants/compaction/gap_fill_parameters.cuh"
#include "variants/cuda/append_compaction.h"

namespace pt::cuda::compaction::gap_fill {
namespace {

class GapFill final : public Compaction {
public:
    explicit GapFill(const CellContext& context) : context_(context), module_(context.module()) {}

    void reserve(Arena& arena, const Queue& queue) override {
        gaps_ = arena.take<std::uint32_t>(queue.capacity);
        movers_ = arena.take<std::uint32_t>(queue.capacity);
        counts_ = arena.take<std::uint32_t>(2);
    }

    // Works on slots 0 to count - 1: an order by which they were shaded is dropped.
    void compact(Queue& queue) override {
        PT_CUDA_CHECK(cudaMemsetAsync(queue.count_spare, 0, sizeof(std::uint32_t), context_.stream));
        PT_CUDA_CHECK(cudaMemsetAsync(counts_, 0, 2 * sizeof(std::uint32_t), context_.stream));
        launch(queue.bound, CountLiveParameters{queue.paths, queue.count, queue.count_spare});
        launch(queue.bound,
               FindGapsParameters{queue.paths, queue.count, queue.count_spare, gaps_, counts_, movers_, counts_ + 1});
        // At most half of all paths are moved: there are at most as many gaps below n as live paths above it.
        launch(queue.bound / 2 + 1, FillGapsParameters{queue.paths, gaps_, movers_, counts_ + 1});
        queue.swap_count();
        queue.indirect = false;
    }

private:
    template <class Parameters>
    void launch(std::uint32_t threads, const Parameters& parameters) {
        module_.launch(blocks_for(threads), stage_block, context_.stream, parameters);
        *context_.launches += 1;
    }

    CellContext context_;
    const Module& module_;
    std::uint32_t* gaps_ = nullptr;
    std::uint32_t* movers_ = nullptr;
    std::uint32_t* counts_ = nullptr;  // gaps, movers
};

constexpr Descriptor descriptor{
    .axis = "compaction",
    .name = "gap_fill",
    .summary = "live paths above the new size move into ended ones' slots below it, in place",
    .origin = "Wald 2011, \"Active thread compaction\"; Cycles' compaction of its state array",
    .traits = CompactionTraits{.reproducible_order = false},
    .backends = on_cuda,
    .check_counters = compacted_every_bounce,
};

const Registration registration(descriptor,
                                {.cuda = {.compaction = [](const CellContext& context) -> std::unique_ptr<Compaction> {
                                              return std::make_unique<GapFill>(context);
                                          },
                                          .kernels = {kernel_of<CountLiveParameters>(), kernel_of<FindGapsParameters>(),
                                                      kernel_of<FillGapsParameters>()}}});

}  // namespace
}  // namespace pt::cuda::compaction::gap_fill
