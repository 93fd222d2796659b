// Brings the live paths to the front and the ended ones to the back, in any order, by moving the payload.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// The descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives the one on CUDA from it.
inline constexpr Descriptor thrust_partition{
    .axis = "compaction",
    .name = "thrust_partition",
    .summary = "thrust::partition on the payload; order not promised",
    .origin = "a student's CIS565-Fall-2022/Project3-CUDA-Path-Tracer",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
