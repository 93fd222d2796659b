// Moves as little as can be: with n paths alive, the live ones in slots from n up go into the ended ones' slots below
// n, in place. Nothing else is touched, and no second store is needed.
#pragma once

#include "variants/compaction/gap_fill_parameters.cuh"
#include "variants/cuda/append.cuh"

PT_KERNEL(count_live, pt::cuda::CountLiveParameters,
          (PathStore store, const std::uint32_t* count, std::uint32_t* live)) {
    const std::uint32_t i = pt::cuda::thread_number();
    (void)pt::cuda::append_by_block(live, i < *count && Paths(store).alive(i));
}

// Lists the gaps (ended paths) below *live and the live paths above it, of which there are as many.
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
