// The compaction thrust_remove_if removes ended paths by moving whole paths, and keeps the order of the others.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// thrust_remove_if's descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives CUDA's from it.
inline constexpr Descriptor thrust_remove_if{
    .axis = "compaction",
    .name = "thrust_remove_if",
    .summary = "thrust::remove_if on the payload; order kept",
    .origin = "a student's CIS565-Fall-2023/Project3-CUDA-Path-Tracer",
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
