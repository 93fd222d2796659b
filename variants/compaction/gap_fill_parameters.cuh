// The parameters of gap_fill's kernels, for both sides.
#pragma once

#include "variants/cuda/path_store.h"

namespace pt::cuda {

struct CountLiveParameters {
    static constexpr const char* kernel = "count_live";
    PathStore store;
    const std::uint32_t* count;
    std::uint32_t* live;
};

// Parameters of find_gaps, which lists the gaps (ended paths) below *live and the live paths above it, of which there
// are as many.
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
