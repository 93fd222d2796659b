// Owning handles of CUDA streams, events and pinned memory, and clearing of device memory.
#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

struct DestroyStream {
    // The stream is waited for before it is destroyed: work in flight after a failure must not outlive its memory.
    void operator()(cudaStream_t stream) const {
        (void)cudaStreamSynchronize(stream);
        (void)cudaStreamDestroy(stream);
    }
};
using Stream = std::unique_ptr<std::remove_pointer_t<cudaStream_t>, DestroyStream>;

inline Stream make_stream() {
    cudaStream_t stream = nullptr;
    PT_CUDA_CHECK(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    return Stream(stream);
}

struct DestroyEvent {
    void operator()(cudaEvent_t event) const { (void)cudaEventDestroy(event); }
};
using Event = std::unique_ptr<std::remove_pointer_t<cudaEvent_t>, DestroyEvent>;

inline Event make_event() {
    cudaEvent_t event = nullptr;
    PT_CUDA_CHECK(cudaEventCreate(&event));
    return Event(event);
}

// Frees pinned memory of the host, which the device can write.
struct FreePinned {
    void operator()(std::uint32_t* words) const { (void)cudaFreeHost(words); }
};
using PinnedWords = std::unique_ptr<std::uint32_t[], FreePinned>;

inline PinnedWords make_pinned_words(std::size_t count) {
    void* words = nullptr;
    PT_CUDA_CHECK(cudaMallocHost(&words, count * sizeof(std::uint32_t)));
    return PinnedWords(static_cast<std::uint32_t*>(words));
}

// Sets device memory to 0 in the order of the stream; null memory is left alone.
inline void clear(void* memory, std::size_t bytes, cudaStream_t stream) {
    if (memory != nullptr && bytes != 0) {
        PT_CUDA_CHECK(cudaMemsetAsync(memory, 0, bytes, stream));
    }
}

}  // namespace pt::cuda
