// The axis `compaction`: how ended paths are taken out of the queue.
#pragma once

#include "variants/axis.h"
#include "variants/cuda/device/append_in_kernel.h"

namespace pt {

struct CompactionTraits {
    bool compacts = true;
    bool payload_contiguous = true;  // after the compaction the paths in play are slots 0 to count - 1
    bool host_sync = false;          // the host waits for the device within a compaction, so no CUDA graph can hold one
    bool reproducible_order = true;  // a path has the same queue position in every run
    AppendInKernel append_in_kernel = AppendInKernel::no;

    constexpr bool can_append_in_kernel() const { return append_in_kernel != AppendInKernel::no; }
};

namespace compaction {

using Traits = CompactionTraits;
inline constexpr Axis axis_facts{
    .what = "how ended paths are taken out of the queue",
    .order = 20,
};

}  // namespace compaction
}  // namespace pt
