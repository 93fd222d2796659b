// Counts of a list in device memory that one kernel fills and the next works off. For NVRTC, nvcc and the host compiler
// alike.
#pragma once

#include <cstdint>

namespace pt::cuda {

// Counts of a list in device memory, all 0 when a kernel begins to fill the list.
struct ListCounts {
    std::uint32_t waiting;   // number of entries that were put into the list
    std::uint32_t taken;     // number of list entries that were handed out
    std::uint32_t finished;  // number of thread blocks that are done with the list
};

}  // namespace pt::cuda
