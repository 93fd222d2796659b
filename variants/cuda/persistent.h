// How many samples persistent threads may take, so that what they count fits in 32 bits.
#pragma once

#include "variants/cuda/megakernels.h"

namespace pt::cuda {

// Most samples per pixel in one launch of persistent threads, which add up their counts after each piece: as many as
// leave piece numbers in 32 bits.
inline std::uint32_t samples_per_persistent_launch(const Job& job) {
    const std::uint64_t by_pieces = 0xffffffffull / ((job.pixels + warp_size - 1) / warp_size) - 1;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(by_pieces, 1, job.samples));
}

// Samples per pixel in a piece of work (on a strip of pixels): samples_per_piece, or so few that a thread's counters
// suffice even if the thread traces the whole piece, besides paths of the previous piece that wait or live.
inline std::uint32_t samples_per_strip(const Job& job, std::uint32_t samples_per_piece) {
    const std::uint64_t rays_per_sample = std::uint64_t{warp_size} * 2 * job.longest_path * job.most_branches;
    const std::uint64_t countable = (0xffffffffull - few_rays) / rays_per_sample;
    const std::uint64_t of_piece = countable > 2 ? countable - 2 : 1;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(of_piece, 1, samples_per_piece));
}

}  // namespace pt::cuda
