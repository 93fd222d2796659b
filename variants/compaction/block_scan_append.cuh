// The compaction block_scan_append: live paths are appended to the next queue, with a scan in shared memory and one
// atomic operation a thread block.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/append.cuh"

__device__ inline std::uint32_t append(std::uint32_t* count, bool keep) {
    return pt::cuda::append_by_block(count, keep);
}

#include "variants/cuda/device/append_kernels.cuh"

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the choice's descriptor

#include "variants/cuda/append_compaction.h"

namespace pt::cuda::compaction::block_scan_append {
namespace {

constexpr Descriptor descriptor{
    .axis = "compaction",
    .name = "block_scan_append",
    .summary = "live paths are appended to the next queue: shared-memory scan, one atomic operation a block",
    .origin = "Billeter, Olsson and Assarsson 2009, with an atomic counter for the global scan",
    .traits =
        CompactionTraits{
            .payload_contiguous = false, .reproducible_order = false, .append_in_kernel = AppendInKernel::by_block},
    .backends = on_cuda,
    .tunables = append_tunables,
    .check_counters = compacted_every_bounce,
};

const Registration registration(
    descriptor, {.cuda = {.compaction = [](const CellContext& context) -> std::unique_ptr<Compaction> {
                              return std::make_unique<AppendCompaction>(context);
                          },
                          .kernels = {kernel_of<AppendSlotsParameters>(), kernel_of<AppendPathsParameters>()}}});

}  // namespace
}  // namespace pt::cuda::compaction::block_scan_append

#endif
