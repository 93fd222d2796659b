// Removes the ended paths, keeping the order of the others; the whole payload is moved (seed A).
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// On the CPU; on_device (variants/cuda/thrust_policy.h) makes of it what the choice is on CUDA.
inline constexpr Descriptor thrust_remove_if{
    .axis = "compaction",
    .name = "thrust_remove_if",
    .summary = "thrust::remove_if on the payload; order kept",
    .origin = "seed A (2023)",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
