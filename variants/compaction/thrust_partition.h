// The compaction thrust_partition moves live paths to the front and ended ones to the back, in any order.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// thrust_partition's descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives CUDA's from it.
inline constexpr Descriptor thrust_partition{
    .axis = "compaction",
    .name = "thrust_partition",
    .summary = "thrust::partition on the payload; order not promised",
    .origin = "a student's CIS565-Fall-2022/Project3-CUDA-Path-Tracer",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
