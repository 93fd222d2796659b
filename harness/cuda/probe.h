// What measurements of the GPU itself share: a timer of device work, and device memory.
#pragma once

#include <algorithm>
#include <cstddef>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

class Timer {
public:
    Timer() {
        PT_CUDA_CHECK(cudaEventCreate(&begin_));
        PT_CUDA_CHECK(cudaEventCreate(&end_));
    }
    ~Timer() {
        (void)cudaEventDestroy(begin_);
        (void)cudaEventDestroy(end_);
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    // Runs `work` six times and returns the seconds of the fastest run, without the first, which warms up.
    template <class Work>
    double fastest(const Work& work) const {
        float least = 1e30f;
        for (int run = 0; run < 6; ++run) {
            PT_CUDA_CHECK(cudaEventRecord(begin_));
            work();
            PT_CUDA_CHECK(cudaGetLastError());
            PT_CUDA_CHECK(cudaEventRecord(end_));
            PT_CUDA_CHECK(cudaEventSynchronize(end_));
            float milliseconds = 0;
            PT_CUDA_CHECK(cudaEventElapsedTime(&milliseconds, begin_, end_));
            least = run == 0 ? least : std::min(least, milliseconds);
        }
        return 1e-3 * static_cast<double>(least);
    }

private:
    cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

class Memory {
public:
    explicit Memory(std::size_t bytes) { PT_CUDA_CHECK(cudaMalloc(&address_, bytes)); }
    ~Memory() { (void)cudaFree(address_); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    template <class T>
    T* as() const {
        return static_cast<T*>(address_);
    }

private:
    void* address_ = nullptr;
};

}  // namespace pt::cuda
