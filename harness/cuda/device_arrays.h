// Arrays of the host in one piece of device memory.
#pragma once

#include <algorithm>
#include <memory>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

// A pointer of the host, and how many bytes there are at it.
template <class T>
struct HostArray {
    const T*& pointer;
    std::size_t bytes;
};
template <class T>
HostArray<T> host_array(const T*& pointer, std::size_t bytes) {
    return {pointer, bytes};
}

// Arrays in device memory, which are freed with this object.
class DeviceArrays {
public:
    // Copies each array, and sets its pointer to the copy: null where there are no bytes.
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
