// Arrays of the host in one piece of device memory, and copies of the last things that a study has used.
#pragma once

#include <algorithm>
#include <list>
#include <memory>

#include "variants/cuda/check.h"

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

// Frees them with itself.
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

// Copies that there are, the one that was used last in front. A Copy says by is_of(host) what it is of.
template <class Copy>
class KeptCopies {
public:
    // Null: there is none.
    template <class Host>
    std::shared_ptr<const Copy> find(const Host& host) {
        const auto known = std::find_if(copies_.begin(), copies_.end(),
                                        [&](const std::shared_ptr<const Copy>& copy) { return copy->is_of(host); });
        if (known == copies_.end()) {
            return nullptr;
        }
        copies_.splice(copies_.begin(), copies_, known);
        return copies_.front();
    }
    template <class Host>
    std::shared_ptr<const Copy> make(const Host& host) {
        return copies_.emplace_front(std::make_shared<const Copy>(host));
    }
    void drop_oldest() { copies_.pop_back(); }
    std::size_t size() const { return copies_.size(); }
    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const std::shared_ptr<const Copy>& copy : copies_) {
            bytes += copy->bytes();
        }
        return bytes;
    }

private:
    std::list<std::shared_ptr<const Copy>> copies_;
};

}  // namespace pt::cuda
