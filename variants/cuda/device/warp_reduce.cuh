// Sums and extremes over a full warp, of int or unsigned; every lane must call them. Compute capability 8.0 has
// instructions for these; Turing exchanges values by shuffles.
#pragma once

namespace pt::cuda {

inline constexpr unsigned all_lanes = 0xffffffffu;

template <class T, class Combine>
__device__ inline T reduce_by_shuffles(T value, Combine combine) {
    for (int offset = 16; offset > 0; offset /= 2) {
        value = combine(value, __shfl_xor_sync(all_lanes, value, offset));
    }
    return value;
}

template <class T>
__device__ inline T warp_sum(T value) {
#if __CUDA_ARCH__ >= 800
    return __reduce_add_sync(all_lanes, value);
#else
    return reduce_by_shuffles(value, [](T a, T b) { return a + b; });
#endif
}

template <class T>
__device__ inline T warp_min(T value) {
#if __CUDA_ARCH__ >= 800
    return __reduce_min_sync(all_lanes, value);
#else
    return reduce_by_shuffles(value, [](T a, T b) { return b < a ? b : a; });
#endif
}

template <class T>
__device__ inline T warp_max(T value) {
#if __CUDA_ARCH__ >= 800
    return __reduce_max_sync(all_lanes, value);
#else
    return reduce_by_shuffles(value, [](T a, T b) { return a < b ? b : a; });
#endif
}

}  // namespace pt::cuda
