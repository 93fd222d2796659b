// Communication of a block's warps in shared memory without a barrier: words with release and acquire order, and a lock
// that a warp takes as a whole.
#pragma once

#include "variants/cuda/device/device.cuh"

namespace pt::cuda {

// Loads a word with acquire order: what a thread did before it released the word happens before what this thread does
// next.
template <class T>
__device__ inline T load_acquire(const T& word) {
#if defined(__CUDA_ARCH__)
    const T value = *const_cast<const volatile T*>(&word);
    __threadfence_block();
    return value;
#else
    return __atomic_load_n(&word, __ATOMIC_ACQUIRE);
#endif
}
template <class T>
__device__ inline void store_release(T& word, T value) {
#if defined(__CUDA_ARCH__)
    __threadfence_block();
    *const_cast<volatile T*>(&word) = value;
#else
    __atomic_store_n(&word, value, __ATOMIC_RELEASE);
#endif
}

// A lock that a warp takes as a whole: every lane must call both functions. What any lane has read or written before a
// release happens before what any lane of the next warp to acquire reads or writes: lanes are ordered by __syncwarp,
// lane 0 of both warps by fences around the atomic operations. Only lane 0 spins, so a warp never waits for itself.
__device__ inline void acquire(std::uint32_t& locked) {
    if (lane() == 0) {
        while (atomicCAS(&locked, 0u, 1u) != 0u) {
            __nanosleep(20);
        }
        __threadfence_block();
    }
    __syncwarp();
}
__device__ inline void release(std::uint32_t& locked) {
    __syncwarp();
    if (lane() == 0) {
        __threadfence_block();
        atomicExch(&locked, 0u);
    }
    __syncwarp();
}

}  // namespace pt::cuda
