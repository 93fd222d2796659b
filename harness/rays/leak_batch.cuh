// Kernels that generate leak rays on the GPU and count the rays that hit nothing.
#pragma once

#include "harness/rays/leak_rays.h"

namespace pt::rays {

__global__ void make_leak_rays(const __grid_constant__ LeakView view, std::uint64_t first, Ray* rays,
                               std::uint32_t count) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index < count) {
        rays[index] = leak_ray(view, first + index);
    }
}

// Counts leak rays without a hit, by class, in leaks[class]; hits[i] is the hit of the leak ray number `first` + i.
__global__ void count_leaks(const Hit* hits, std::uint64_t first, std::uint32_t count, unsigned long long* leaks) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index < count && hits[index].primitive == no_primitive) {
        atomicAdd(leaks + leak_class_of(first + index), 1ull);
    }
}

}  // namespace pt::rays
