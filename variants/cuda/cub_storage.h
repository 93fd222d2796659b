// The temporary storage of a CUB call, in a cell's arena: measured once for the largest call, so that a render
// allocates nothing and waits for nothing.
#pragma once

#include "variants/cuda/runtime/arena.h"

namespace pt::cuda {

class CubStorage {
public:
    // Reserves storage for a CUB call: `call(void* memory, std::size_t& bytes)` calls CUB and returns its error; with
    // null memory it only measures.
    template <class Call>
    void reserve(Arena& arena, Call&& call) {
        bytes_ = 0;
        PT_CUDA_CHECK(call(nullptr, bytes_));
        memory_ = arena.take_bytes(bytes_);
    }
    template <class Call>
    void run(Call&& call) {
        PT_CUDA_CHECK(call(memory_, bytes_));
    }

private:
    unsigned char* memory_ = nullptr;
    std::size_t bytes_ = 0;
};

}  // namespace pt::cuda
