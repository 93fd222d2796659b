// What every kernel that NVRTC compiles starts from: the types of the variant, and adding up over a block.
// The program's text (variants/cuda/module.cpp) goes on with the layout (Paths) and the sort key.
#pragma once

#include "variants/cuda/totals.h"

using Real = PT_REAL;
using Configuration = pt::Config<PT_REAL, PT_FEATURES>;
using Scene = pt::SceneView<Real>;
using Path = pt::Path<Real>;
using Hit = pt::Hit<Real>;
using HitCache = pt::cuda::HitCache<Real>;
using pt::FilmView;
using pt::PathCounters;
using pt::cuda::PathStore;
using pt::cuda::SegmentCounts;
using pt::cuda::Totals;

namespace pt::cuda {

__device__ inline std::uint32_t lane() { return threadIdx.x & 31u; }
__device__ inline std::uint32_t thread_number() { return blockIdx.x * blockDim.x + threadIdx.x; }
__device__ inline std::uint32_t thread_count() { return gridDim.x * blockDim.x; }

// Sum over a full warp; every lane must call it.
__device__ inline std::uint32_t warp_sum(std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
    return __reduce_add_sync(0xffffffffu, value);
#else
    for (int offset = 16; offset > 0; offset /= 2) {
        value += __shfl_xor_sync(0xffffffffu, value, offset);
    }
    return value;
#endif
}

// Adds each thread's values to totals in global memory, with one atomic operation a block and value: thousands of
// warps adding to one address would wait for each other. Every thread of the block must call it, once.
template <int count>
__device__ inline void add_over_block(const std::uint32_t (&values)[count], std::uint64_t* const (&totals)[count]) {
    __shared__ std::uint32_t sums[count];
    if (threadIdx.x < count) {
        sums[threadIdx.x] = 0;
    }
    __syncthreads();
    for (int i = 0; i < count; ++i) {
        const std::uint32_t sum = warp_sum(values[i]);
        if (lane() == 0 && sum != 0) {
            atomicAdd(&sums[i], sum);
        }
    }
    __syncthreads();
    for (int i = 0; i < count; ++i) {
        if (threadIdx.x == static_cast<unsigned>(i) && sums[i] != 0) {
            atomic_add(totals[i], static_cast<std::uint64_t>(sums[i]));
        }
    }
}

// A thread's counters of one kernel fit in 32 bits: the host splits longer renders into several launches.
__device__ inline void add_counters(Totals* totals, const PathCounters& counters, std::uint32_t cache_uses) {
    const std::uint32_t values[] = {static_cast<std::uint32_t>(counters.paths),
                                    static_cast<std::uint32_t>(counters.rays),
                                    static_cast<std::uint32_t>(counters.connections),
                                    static_cast<std::uint32_t>(counters.unfinished_walks), cache_uses};
    std::uint64_t* const sums[] = {&totals->paths.paths, &totals->paths.rays, &totals->paths.connections,
                                   &totals->paths.unfinished_walks, &totals->cache_uses};
    add_over_block(values, sums);
}

}  // namespace pt::cuda

// The camera ray of a path: its own, or with a first-bounce cache that of the kept one which the sample uses.
__device__ inline Path first_path(const Scene& scene, std::uint32_t pixel, std::uint32_t sample,
                                  const HitCache& cache) {
    if (PT_CACHED) {
        return pt::generate<Configuration>(scene, pixel, sample, sample % cache.rays);
    }
    return pt::generate<Configuration>(scene, pixel, sample);
}

__device__ inline Hit first_hit(const Scene& scene, const Path& path, const HitCache& cache) {
    if (PT_CACHED) {
        return cache.hits[static_cast<std::size_t>(path.pixel) * cache.rays + path.sample % cache.rays];
    }
    return pt::intersect<Configuration>(scene, path);
}

// Traces the camera rays that the cache keeps: one thread a ray.
#if PT_CACHED
extern "C" __global__ void fill_cache(Scene scene, HitCache cache, std::uint32_t rays_used, Totals* totals) {
    const std::uint32_t pixel = pt::cuda::thread_number();
    std::uint32_t fills = 0;
    if (pixel < scene.pixel_count()) {
        for (std::uint32_t ray = 0; ray < rays_used; ++ray) {
            const Path path = pt::generate<Configuration>(scene, pixel, ray, ray);
            cache.hits[static_cast<std::size_t>(pixel) * cache.rays + ray] =
                pt::intersect<Configuration>(scene, path);
            fills += 1;
        }
    }
    const std::uint32_t values[] = {fills, fills};
    std::uint64_t* const sums[] = {&totals->cache_fills, &totals->paths.rays};
    pt::cuda::add_over_block(values, sums);
}
#endif

// Stands in for a costlier material: PT_SHADING_FMAS dependent multiply-adds, executed material by material, so that a
// warp whose lanes hit k materials pays for k. The result is never used; the compiler cannot know.
__device__ inline void injected_cost(const Scene& scene, const Hit& hit) {
#if PT_SHADING_FMAS > 0
    const std::uint32_t mine =
        hit.side.exists() ? scene.object_material[hit.side.object()] : 0xffffffffu;
    for (std::uint32_t material = 0; material < scene.materials.size; ++material) {
        if (mine == material) {
            float x = static_cast<float>(material);
            for (int i = 0; i < PT_SHADING_FMAS; ++i) {
                asm volatile("fma.rn.f32 %0, %0, %0, %0;" : "+f"(x));
            }
        }
    }
#else
    (void)scene;
    (void)hit;
#endif
}

__device__ inline bool shade(const Scene& scene, Path& path, const Hit& hit, PathCounters& counters) {
    injected_cost(scene, hit);
    return pt::shade<Configuration>(scene, path, hit, counters);
}
