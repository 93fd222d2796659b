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

// As many gaps below *live as there are live paths above it.
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
