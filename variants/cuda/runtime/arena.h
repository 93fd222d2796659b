// The device memory of one cell: a single allocation, handed out in pieces. Users of memory ask twice, first an arena
// that only measures, then one that has as much as was measured, so nothing is allocated while a render runs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

class Arena {
public:
    // An arena without memory, which measures: take() hands out null pointers and adds up what was asked for.
    Arena() = default;
    // Allocates `bytes` of device memory, rounded up to the next multiple of 256. Throws OutOfMemory with the size
    // asked for.
    explicit Arena(std::size_t bytes);
    ~Arena();
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    // Hands out memory for `count` elements, aligned to 256 bytes. Throws std::logic_error if more is taken than was
    // measured.
    template <class T>
    T* take(std::size_t count) {
        return reinterpret_cast<T*>(take_bytes(count * sizeof(T)));
    }
    unsigned char* take_bytes(std::size_t bytes);

    bool is_measuring() const { return base_ == nullptr; }
    std::size_t used() const { return used_; }

private:
    unsigned char* base_ = nullptr;
    std::size_t size_ = 0;
    std::size_t used_ = 0;
};

}  // namespace pt::cuda
