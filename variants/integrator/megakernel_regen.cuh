// One kernel, a warp a strip of 32 pixels: a lane whose path ended takes the next sample of the strip while the others
// go on, so that the warp stays full until its strip is done. Path regeneration: Novák, Havran and Dachsbacher 2010.
// Ending and starting a path costs a warp the same for one lane as for many, so lanes may be made to wait for each
// other (regenerate_at).
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/warp_items.cuh"

// Warp w takes strip w mod strips, and of its samples w / strips, w / strips + stride, ...; items are numbered sample
// by sample, pixels within. The loop ends at its condition: nvcc 13.0's ptxas miscompiles the form that breaks out from
// the middle.
extern "C" __global__ void PT_LAUNCH_BOUNDS megakernel_regen(Scene parameter, FilmView film, std::uint32_t first_sample,
                                                             std::uint32_t samples, std::uint32_t stride,
                                                             HitCache cache, Totals* totals, std::uint64_t* ended) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t pixels = scene.shade.pixel_count();
    const std::uint32_t strips = (pixels + 31) / 32;
    const std::uint32_t warp = pt::cuda::thread_number() / 32;
    const pt::PixelPlace first = pt::PixelPlace::of(warp % strips * 32, scene.shade.camera.width);
    const std::uint32_t part = warp / strips;
    const std::uint32_t rounds = part < stride && part < samples ? (samples - part + stride - 1) / stride : 0;
    const Items items{32 * rounds, pixels, scene.shade.camera.width, first, first_sample + part, stride};
    trace_items(scene, film, items, cache, counters, ended);
    pt::cuda::add_counters(totals, counters, PT_CACHED ? static_cast<std::uint32_t>(counters.paths) : 0);
}

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::megakernel_regen {

inline constexpr Tunable tunables[] = {megakernel_tunables[0], megakernel_tunables[1], megakernel_tunables[2],
                                       megakernel_tunables[3], regeneration_tunable};

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel_regen",
    .summary = "one kernel, a warp a strip of pixels; a lane whose path ended takes the strip's next sample",
    .origin = "Novák, Havran and Dachsbacher 2010 (path regeneration)",
    .backends = on_cuda,
    .tunables = tunables,
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
        job.launch("megakernel_regen", (job.pixels + 31) / 32 * 32 * stride, job.scene, job.film,
                   job.first_sample + done, samples, stride, job.cache, job.totals, job.lengths);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .defines = regeneration_defines, .kernels = {"megakernel_regen"}};

}  // namespace pt::cuda::integrator::megakernel_regen

#endif
