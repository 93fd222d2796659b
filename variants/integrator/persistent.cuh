// As many threads as the GPU holds at once; each takes path after path from a global counter, a warp's free lanes with
// one atomic operation. Persistent threads: Aila and Laine 2009.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"

// The next item of the calling lane. Lanes that call together share one atomic operation.
__device__ inline std::uint64_t take_item(std::uint64_t* next_item) {
    const unsigned together = __activemask();
    const int leader = __ffs(static_cast<int>(together)) - 1;
    unsigned long long first = 0;
    if (pt::cuda::lane() == static_cast<unsigned>(leader)) {
        first = atomicAdd(reinterpret_cast<unsigned long long*>(next_item),
                          static_cast<unsigned long long>(__popc(together)));
    }
    first = __shfl_sync(together, first, leader);
    return first + __popc(together & ((1u << pt::cuda::lane()) - 1u));
}

// Items are numbered sample by sample, pixels within: neighbouring lanes start at neighbouring pixels.
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    persistent(Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples, HitCache cache,
               Totals* totals, std::uint64_t* ended, std::uint64_t* next_item) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t pixels = scene.shade.pixel_count();
    const std::uint64_t items = static_cast<std::uint64_t>(pixels) * samples;
    std::uint64_t item = take_item(next_item);
    Path path = first_path(scene.shade, static_cast<std::uint32_t>(item % pixels),
                           first_sample + static_cast<std::uint32_t>(item / pixels), cache);
    while (item < items) {
        const Hit hit = PT_CACHED && path.segment == 0 ? first_hit(scene, path, cache) : trace(scene, path);
        if (!shade(scene, path, hit, counters)) {
            pt::accumulate(film, path);
            counters.rays += path.segment - PT_CACHED;
            counters.paths += 1;
            if (ended != nullptr) {
                pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
            }
            item = take_item(next_item);
            path = first_path(scene.shade, static_cast<std::uint32_t>(item % pixels),
                              first_sample + static_cast<std::uint32_t>(item / pixels), cache);
        }
    }
    pt::cuda::add_counters(totals, counters, PT_CACHED ? static_cast<std::uint32_t>(counters.paths) : 0);
}

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::persistent {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "persistent",
    .summary = "as many threads as fit at once, each taking path after path from a global counter",
    .origin = "Aila and Laine 2009 (persistent threads)",
    .backends = on_cuda,
    .tunables = persistent_tunables,
    .does_not_apply = megakernel_does_not_apply,
    .work_missing = megakernel_work_missing,
};

inline void render(Job& job) {
    fill_cache(job);
    const Stage stage(job.stages, "trace", job.stream);
    const auto blocks =
        static_cast<std::uint32_t>(job.module->blocks_a_multiprocessor("persistent", job.block)) * job.multiprocessors;
    const std::uint32_t threads = blocks * job.block;
    // A thread may take many more items than its share, but a block's counters must hold: as in samples_a_launch, with
    // a factor of 16 for the uneven shares.
    const std::uint64_t shares = std::max<std::uint64_t>(1, (std::uint64_t{job.pixels} + threads - 1) / threads);
    const auto most = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, samples_a_launch(job) / (16 * shares)));
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t samples = std::min(most, job.samples - done);
        PT_CUDA_CHECK(cudaMemsetAsync(job.next_item, 0, sizeof(std::uint64_t), job.stream));
        job.launch_blocks("persistent", blocks, job.scene, job.film, job.first_sample + done, samples, job.cache,
                          job.totals, job.lengths, job.next_item);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .kernels = {"persistent"}};

}  // namespace pt::cuda::integrator::persistent

#endif
