// Kernels of the appending compactions. The file that includes this one defines append(count, keep).
#pragma once

#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/append_parameters.h"

PT_KERNEL(append_slots, pt::cuda::AppendSlotsParameters,
          (PathStore store, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t* kept,
           std::uint32_t* kept_count)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const bool in_play = i < *count;
    const std::uint32_t slot = in_play && order != nullptr ? order[i] : i;
    const bool alive = in_play && Paths(store).alive(slot);
    const std::uint32_t position = append(kept_count, alive);
    if (alive) {
        kept[position] = slot;
    }
}

PT_KERNEL(append_paths, pt::cuda::AppendPathsParameters,
          (PathStore store, const std::uint32_t* order, const std::uint32_t* count, PathStore kept,
           std::uint32_t* kept_count)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const bool in_play = i < *count;
    const std::uint32_t slot = in_play && order != nullptr ? order[i] : i;
    const bool alive = in_play && Paths(store).alive(slot);
    const std::uint32_t position = append(kept_count, alive);
    if (alive) {
        Paths(kept).store(position, Paths(store).load(slot));
    }
}
