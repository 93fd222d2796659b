// The compaction thrust_copy_if_index leaves paths in place and lists live slots: 4 bytes a path move instead of 72.
#pragma once

#include "variants/descriptor.h"
#include "variants/work_checks.h"

namespace pt {

// thrust_copy_if_index's descriptor on the CPU; on_device (variants/cuda/thrust_policy.h) derives CUDA's from it.
inline constexpr Descriptor thrust_copy_if_index{
    .axis = "compaction",
    .name = "thrust_copy_if_index",
    .summary = "thrust::copy_if of slot numbers; the payload stays in place",
    .origin = "Cycles' active index array",
    .traits = CompactionTraits{.payload_contiguous = false},
    .check_counters = compacted_every_bounce,
};

}  // namespace pt
