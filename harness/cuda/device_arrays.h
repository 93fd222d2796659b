// Copies arrays of the host into one allocation of device memory.
#pragma once

#include <algorithm>
#include <memory>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

// A pointer to an array of the host, and the array's size in bytes.
template <class T>
struct HostArray {
    const T*& pointer;
    std::size_t bytes;
};
template <class T>
HostArray<T> host_array(const T*& pointer, std::size_t bytes) {
    return {pointer, bytes};
}

// Copies of arrays in one allocation of device memory, which the destructor frees.
class DeviceArrays {
public:
    // Copies each array to the device and sets its pointer to the copy, or to null if the array is empty.
    template <class... T>
    explicit DeviceArrays(HostArray<T>... arrays) : bytes_((on_border(arrays.bytes) + ...)) {
        void* memory = nullptr;
        PT_CUDA_CHECK(cudaMalloc(&memory, std::max<std::size_t>(1, bytes_)));
        memory_.reset(static_cast<unsigned char*>(memory));
        unsigned char* next = memory_.get();
        (put(arrays, next), ...);
    }
    std::size_t bytes() const { return bytes_; }

private:
    struct Free {
        void operator()(unsigned char* memory) const { (void)cudaFree(memory); }
    };

    static std::size_t on_border(std::size_t bytes) { return (bytes + 255) / 256 * 256; }

    template <class T>
    static void put(HostArray<T> array, unsigned char*& next) {
        if (array.bytes != 0) {
            PT_CUDA_CHECK(cudaMemcpy(next, array.pointer, array.bytes, cudaMemcpyHostToDevice));
        }
        array.pointer = array.bytes == 0 ? nullptr : static_cast<const T*>(static_cast<const void*>(next));
        next += on_border(array.bytes);
    }

    std::size_t bytes_;
    std::unique_ptr<unsigned char, Free> memory_;
};

}  // namespace pt::cuda
