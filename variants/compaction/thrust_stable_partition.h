// The compaction thrust_stable_partition moves live paths to the front and ended ones behind; both keep their order.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// The compaction's descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives the one on CUDA from it.
inline constexpr Descriptor thrust_stable_partition{
    .axis = "compaction",
    .name = "thrust_stable_partition",
    .summary = "thrust::stable_partition on the payload; order kept",
    .origin = "CIS 565 project 3",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
