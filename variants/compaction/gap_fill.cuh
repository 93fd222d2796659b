// The compaction gap_fill moves as few paths as can be: with n paths alive, the live ones in slots from n up go into
// the ended ones' slots below n, in place. No other path is touched, and no second path store is needed.
#pragma once

#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

struct CountLiveParameters {
    static constexpr const char* kernel = "count_live";
    PathStore store;
    const std::uint32_t* count;
    std::uint32_t* live;
};

// Parameters of the kernel find_gaps, which lists gaps (ended paths) below *live and as many live paths above it.
struct FindGapsParameters {
    static constexpr const char* kernel = "find_gaps";
    PathStore store;
    const std::uint32_t* count;
    const std::uint32_t* live;
    std::uint32_t* gaps;
    std::uint32_t* gap_count;
    std::uint32_t* movers;
    std::uint32_t* mover_count;
};

struct FillGapsParameters {
    static constexpr const char* kernel = "fill_gaps";
    PathStore store;
    const std::uint32_t* gaps;
    const std::uint32_t* movers;
    const std::uint32_t* mover_count;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/append.cuh"

PT_KERNEL(count_live, pt::cuda::CountLiveParameters,
          (PathStore store, const std::uint32_t* count, std::uint32_t* live)) {
    const std::uint32_t i = pt::cuda::thread_number();
    (void)pt::cuda::append_by_block(live, i < *count && Paths(store).alive(i));
}

PT_KERNEL(find_gaps, pt::cuda::FindGapsParameters,
          (PathStore store, const std::uint32_t* count, const std::uint32_t* live, std::uint32_t* gaps,
           std::uint32_t* gap_count, std::uint32_t* movers, std::uint32_t* mover_count)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const bool alive = i < *count && Paths(store).alive(i);
    const bool is_gap = i < *live && !alive;
    const bool moves = i >= *live && alive;
    const std::uint32_t gap = pt::cuda::append_by_block(gap_count, is_gap);
    const std::uint32_t mover = pt::cuda::append_by_block(mover_count, moves);
    if (is_gap) {
        gaps[gap] = i;
    }
    if (moves) {
        movers[mover] = i;
    }
}

PT_KERNEL(fill_gaps, pt::cuda::FillGapsParameters,
          (PathStore store, const std::uint32_t* gaps, const std::uint32_t* movers, const std::uint32_t* mover_count)) {
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < *mover_count) {
        Paths(store).store(gaps[i], Paths(store).load(movers[i]));
    }
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the choice's descriptor

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

    // How many paths move depends on where the ended ones lie.
    LeastBytes least_bytes(const BytesOfAPath&) const override { return {}; }

    // Moves all n live paths into slots 0 to n - 1. The order in which a sort had lined up the slots is dropped.
    void compact(Queue& queue) override {
        PT_CUDA_CHECK(cudaMemsetAsync(queue.count_spare, 0, sizeof(std::uint32_t), context_.stream));
        PT_CUDA_CHECK(cudaMemsetAsync(counts_, 0, 2 * sizeof(std::uint32_t), context_.stream));
        launch(queue.bound, CountLiveParameters{queue.paths, queue.count, queue.count_spare});
        launch(queue.bound,
               FindGapsParameters{queue.paths, queue.count, queue.count_spare, gaps_, counts_, movers_, counts_ + 1});
        // At most half of all paths move: each of them from above the number of live paths into a gap below it.
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
    std::uint32_t* counts_ = nullptr;  // number of gaps, and number of paths to move into them
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

#endif
