// One thread a pixel, a path at a time from the camera to its end: the loop of depth_first as one kernel. Its generic
// kernel in exact arithmetic is the reference that bitwise claims on the GPU are held against.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"

// Thread t takes the samples t / pixels, t / pixels + stride, ... of pixel t mod pixels.
// `ended`: paths by their number of segments, or null.
extern "C" __global__ void PT_LAUNCH_BOUNDS megakernel(Scene parameter, FilmView film, std::uint32_t first_sample,
                                                       std::uint32_t samples, std::uint32_t stride, HitCache cache,
                                                       Totals* totals, std::uint64_t* ended) {
    const SceneViews scene(parameter);
    PathCounters counters;
    pt::PixelSum<Configuration> sum;
    const std::uint32_t pixel = pt::cuda::thread_number() % scene.shade.pixel_count();
    const std::uint32_t part = pt::cuda::thread_number() / scene.shade.pixel_count();
    if (part < stride) {
        for (std::uint32_t i = part; i < samples; i += stride) {
            Path path = first_path(scene.shade, pixel, first_sample + i, cache);
            bool alive = shade(scene, path, first_hit(scene, path, cache), counters);
            while (alive) {
                alive = shade(scene, path, trace(scene, path), counters);
            }
            sum.add(film, path.radiance);
            counters.rays += path.segment - PT_CACHED;
            counters.paths += 1;
            if (ended != nullptr) {
                pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
            }
        }
        sum.finish(film, pixel);
    }
    pt::cuda::add_counters(totals, counters, PT_CACHED ? static_cast<std::uint32_t>(counters.paths) : 0);
}

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::megakernel {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel",
    .summary = "one kernel, a thread a pixel, a path at a time, state in registers",
    .origin = "Aila and Laine 2009 for the shape",
    .reference = on_cuda,
    .traits = IntegratorTraits{.sums_in_order = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

inline void render(Job& job) {
    fill_cache(job);
    const Stage stage(job.stages, "trace", job.stream);
    const std::uint32_t most = samples_per_launch(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t samples = std::min(most, job.samples - done);
        const std::uint32_t stride = std::min(job.samples_in_flight, samples);
        job.launch("megakernel", job.pixels * stride, job.scene, job.film, job.first_sample + done, samples, stride,
                   job.cache, job.totals, job.lengths);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .kernels = {"megakernel"}};

}  // namespace pt::cuda::integrator::megakernel

#endif
