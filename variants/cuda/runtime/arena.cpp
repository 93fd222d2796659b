#include "variants/cuda/runtime/arena.h"

#include <algorithm>

namespace pt::cuda {

namespace {

constexpr std::size_t alignment = 256;  // bytes to which cudaMalloc aligns its results

std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

}  // namespace

Arena::Arena(std::size_t bytes) : size_(std::max(aligned(bytes), alignment)) {
    void* memory = nullptr;
    const cudaError_t error = cudaMalloc(&memory, size_);
    if (error == cudaErrorMemoryAllocation) {
        (void)cudaGetLastError();
        std::size_t free_bytes = 0, total_bytes = 0;
        (void)cudaMemGetInfo(&free_bytes, &total_bytes);
        throw OutOfMemory(size_, free_bytes);
    }
    PT_CUDA_CHECK(error);
    base_ = static_cast<unsigned char*>(memory);
}

Arena::~Arena() {
    if (base_ != nullptr) {
        (void)cudaFree(base_);
    }
}

unsigned char* Arena::take_bytes(std::size_t bytes) {
    unsigned char* const piece = base_ == nullptr ? nullptr : base_ + used_;
    used_ += aligned(bytes);
    if (base_ != nullptr && used_ > size_) {
        throw std::logic_error("more device memory taken than was measured");
    }
    return piece;
}

}  // namespace pt::cuda
