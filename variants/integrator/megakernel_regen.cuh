// One thread a pixel; a lane whose path ended starts its next sample at once, so that a warp stays full until its
// longest pixel is done. Path regeneration: Novák, Havran and Dachsbacher 2010.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"

// Samples as in megakernel. The loop ends at its condition: nvcc 13.0's ptxas miscompiles the form that breaks out
// from the middle (shared/DESIGN.md, traps).
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    megakernel_regen(Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
                     std::uint32_t stride, HitCache cache, Totals* totals, std::uint64_t* ended) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t pixel = pt::cuda::thread_number() % scene.shade.pixel_count();
    const std::uint32_t part = pt::cuda::thread_number() / scene.shade.pixel_count();
    std::uint32_t todo = part < stride && part < samples ? (samples - part + stride - 1) / stride : 0;
    if (todo > 0) {
        std::uint32_t sample = first_sample + part;
        Path path = first_path(scene.shade, pixel, sample, cache);
        while (todo > 0) {
            const Hit hit = PT_CACHED && path.segment == 0 ? first_hit(scene, path, cache) : trace(scene, path);
            if (!shade(scene, path, hit, counters)) {
                pt::accumulate(film, path);
                counters.rays += path.segment - PT_CACHED;
                counters.paths += 1;
                if (ended != nullptr) {
                    pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
                }
                sample += stride;
                path = first_path(scene.shade, pixel, sample, cache);
                --todo;
            }
        }
    }
    pt::cuda::add_counters(totals, counters, PT_CACHED ? static_cast<std::uint32_t>(counters.paths) : 0);
}

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::megakernel_regen {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel_regen",
    .summary = "one kernel, a thread a pixel; a lane whose path ended starts its next sample",
    .origin = "Novák, Havran and Dachsbacher 2010 (path regeneration)",
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .does_not_apply = megakernel_does_not_apply,
    .work_missing = megakernel_work_missing,
};

inline void render(Job& job) {
    fill_cache(job);
    const Stage stage(job.stages, "trace", job.stream);
    const std::uint32_t most = samples_a_launch(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t samples = std::min(most, job.samples - done);
        const std::uint32_t stride = std::min(job.samples_in_flight, samples);
        job.launch("megakernel_regen", job.pixels * stride, job.scene, job.film, job.first_sample + done, samples,
                   stride, job.cache, job.totals, job.lengths);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .kernels = {"megakernel_regen"}};

}  // namespace pt::cuda::integrator::megakernel_regen

#endif
