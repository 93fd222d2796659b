// Counts of a list in device memory that one kernel fills and the next works off. For NVRTC, nvcc and the host compiler
// alike.
#pragma once

#include <cstdint>

namespace pt::cuda {

// All are 0 when a kernel begins to fill the list.
struct ListCounts {
    std::uint32_t waiting;   // entries of the list
    std::uint32_t taken;     // of them, those that were handed out
    std::uint32_t finished;  // blocks that are done with the list
};

}  // namespace pt::cuda
