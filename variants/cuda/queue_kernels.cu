#include "variants/cuda/queue_kernels.h"

namespace pt::cuda {
namespace {

__global__ void set_value_kernel(std::uint32_t* target, std::uint32_t value) { *target = value; }

__global__ void write_identity_kernel(std::uint32_t* order, std::uint32_t count) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) {
        order[i] = i;
    }
}

__global__ void end_round_kernel(cudaGraphConditionalHandle condition, LiveCounts live, std::uint32_t* offset,
                                 std::uint32_t taken, std::uint64_t* rounds) {
    std::uint32_t alive = 0;
    for (std::uint32_t part = 0; part < live.parts; ++part) {
        alive += live.counts[part * live.stride + *offset * live.segment_stride];
    }
    const std::uint32_t next = *offset + segments_per_round;
    const bool goes_on = alive > 0 && next < taken;
    *offset = goes_on ? next : 0;
    *rounds += 1;
    cudaGraphSetConditional(condition, goes_on ? 1 : 0);
}

}  // namespace

void set_value(std::uint32_t* target, std::uint32_t value, cudaStream_t stream) {
    set_value_kernel<<<1, 1, 0, stream>>>(target, value);
    PT_CUDA_CHECK(cudaGetLastError());
}

void write_identity(std::uint32_t* order, std::uint32_t count, cudaStream_t stream) {
    constexpr std::uint32_t threads = 256;
    write_identity_kernel<<<(count - 1) / threads + 1, threads, 0, stream>>>(order, count);
    PT_CUDA_CHECK(cudaGetLastError());
}

void end_round(cudaGraphConditionalHandle condition, const LiveCounts& live, std::uint32_t* offset, std::uint32_t taken,
               std::uint64_t* rounds, cudaStream_t stream) {
    end_round_kernel<<<1, 1, 0, stream>>>(condition, live, offset, taken, rounds);
    PT_CUDA_CHECK(cudaGetLastError());
}

}  // namespace pt::cuda
