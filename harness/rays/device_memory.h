// Owners of CUDA resources: an array in device memory, and a pair of events that times what is between them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <cuda_runtime.h>

#include "variants/cuda/runtime/check.h"

namespace pt::rays {

template <class T>
class DeviceArray {
public:
    DeviceArray() = default;
    explicit DeviceArray(std::size_t size) : size_(size) {
        PT_CUDA_CHECK(cudaMalloc(&data_, (size == 0 ? 1 : size) * sizeof(T)));
    }
    explicit DeviceArray(const std::vector<T>& host) : DeviceArray(host.size()) {
        PT_CUDA_CHECK(cudaMemcpy(data_, host.data(), size_ * sizeof(T), cudaMemcpyHostToDevice));
    }
    DeviceArray(DeviceArray&& other) noexcept { swap(other); }
    DeviceArray& operator=(DeviceArray&& other) noexcept {
        swap(other);
        return *this;
    }
    DeviceArray(const DeviceArray&) = delete;
    DeviceArray& operator=(const DeviceArray&) = delete;
    ~DeviceArray() { cudaFree(data_); }

    T* data() const { return data_; }
    std::size_t size() const { return size_; }
    void clear() const { PT_CUDA_CHECK(cudaMemsetAsync(data_, 0, size_ * sizeof(T))); }
    std::vector<T> host() const {
        std::vector<T> values(size_);
        PT_CUDA_CHECK(cudaMemcpy(values.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost));
        return values;
    }

private:
    void swap(DeviceArray& other) {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
    }
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

class EventPair {
public:
    EventPair() {
        PT_CUDA_CHECK(cudaEventCreate(&from_));
        PT_CUDA_CHECK(cudaEventCreate(&to_));
    }
    EventPair(const EventPair&) = delete;
    EventPair& operator=(const EventPair&) = delete;
    ~EventPair() {
        cudaEventDestroy(from_);
        cudaEventDestroy(to_);
    }
    void start() const { PT_CUDA_CHECK(cudaEventRecord(from_)); }
    float stop() const {  // GPU time since start(), in milliseconds
        PT_CUDA_CHECK(cudaEventRecord(to_));
        PT_CUDA_CHECK(cudaEventSynchronize(to_));
        float milliseconds = 0;
        PT_CUDA_CHECK(cudaEventElapsedTime(&milliseconds, from_, to_));
        return milliseconds;
    }

private:
    cudaEvent_t from_{}, to_{};
};

inline int processor_count() {
    int count = 0;
    PT_CUDA_CHECK(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, 0));
    return count;
}

}  // namespace pt::rays
