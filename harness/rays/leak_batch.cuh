// Rays at edges and vertices made on the device, and those counted that nothing stopped.
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

// Adds to leaks[class] the rays first, first + 1 and so on that hit nothing.
__global__ void count_leaks(const Hit* hits, std::uint64_t first, std::uint32_t count, unsigned long long* leaks) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index < count && hits[index].primitive == no_primitive) {
        atomicAdd(leaks + leak_class_of(first + index), 1ull);
    }
}

}  // namespace pt::rays
