// Brings the live paths to the front and the ended ones to the back, in any order; the payload is moved (seed B).
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// On the CPU; on_device (variants/cuda/thrust_policy.h) makes of it what the choice is on CUDA.
inline constexpr Descriptor thrust_partition{
    .axis = "compaction",
    .name = "thrust_partition",
    .summary = "thrust::partition on the payload; order not promised",
    .origin = "seed B (2022)",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
