// Parameters of the kernels of the appending compactions, for host and device.
#pragma once

#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

struct AppendSlotsParameters {
    static constexpr const char* kernel = "append_slots";
    PathStore store;
    const std::uint32_t* order;  // slots of paths by queue position; null: slot i is at position i
    const std::uint32_t* count;
    std::uint32_t* kept;
    std::uint32_t* kept_count;
};

struct AppendPathsParameters {
    static constexpr const char* kernel = "append_paths";
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    PathStore kept;
    std::uint32_t* kept_count;
};

}  // namespace pt::cuda
