// The compaction thrust_stable_partition moves live paths to the front and ended ones behind; both keep their order.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// thrust_stable_partition's descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives CUDA's from it.
inline constexpr Descriptor thrust_stable_partition{
    .axis = "compaction",
    .name = "thrust_stable_partition",
    .summary = "thrust::stable_partition on the payload; order kept",
    .origin = "CIS 565 project 3",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
