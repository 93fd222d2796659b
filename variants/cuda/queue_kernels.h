// Small kernels that choices compiled by nvcc need besides those of a library. Each call enqueues one launch, which its
// caller counts.
#pragma once

#include <cstdint>

#include "variants/cuda/runtime/graph.h"

namespace pt::cuda {

// Sets *target = value on the device. The value travels as a kernel's parameter: a copy from pageable memory would wait
// for the device.
void set_value(std::uint32_t* target, std::uint32_t value, cudaStream_t stream);

// Sets order[i] = i for i below `count`, which is greater than 0.
void write_identity(std::uint32_t* order, std::uint32_t count, cudaStream_t stream);

// Ends a round of a CUDA graph's loop: counts it, and has another follow if paths live and *offset, the segments that
// the loop has done, is below `taken`, the segments that it may take. Leaves *offset 0 after the last round.
void end_round(cudaGraphConditionalHandle condition, const LiveCounts& live, std::uint32_t* offset, std::uint32_t taken,
               std::uint64_t* rounds, cudaStream_t stream);

}  // namespace pt::cuda
