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

}  // namespace pt::cuda
