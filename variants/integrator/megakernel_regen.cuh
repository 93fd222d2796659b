// One kernel, a warp a strip of 32 pixels: a lane whose path ended takes another of the strip's while the others go on,
// so that the warp stays full until its strip is done. Path regeneration: Novák, Havran and Dachsbacher 2010. Ending a
// path and taking another costs a warp the same for one lane as for many, so lanes may be made to wait for each other
// (regenerate_at).
#pragma once

#include "variants/cuda/warp_items.cuh"
#include "variants/integrator/megakernel_regen_parameters.cuh"

// The samples of a strip that one warp takes: every `stride`-th.
struct Strided {
    pt::PixelPlace first;
    std::uint32_t sample, stride, left;

    __device__ bool take(Round& round, ThreadCounters&) {
        if (left == 0) {
            return false;
        }
        round = {first, sample};
        sample += stride;
        left -= 1;
        return true;
    }
};

// One kernel with path regeneration: warp w takes strip w mod strips, and of its samples w / strips, w / strips +
// stride, ...
PT_KERNEL(megakernel_regen, pt::cuda::MegakernelRegenParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
           std::uint32_t stride, HitCache cache, Totals* totals, std::uint64_t* ended)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t pixels = pt::cuda::own_pixels(scene.shade);
    const std::uint32_t strips = (pixels + warp_size - 1) / warp_size;
    const std::uint32_t warp = pt::cuda::thread_number() / warp_size;
    const pt::PixelPlace first = pt::PixelPlace::of(warp % strips * warp_size, scene.shade.camera.width);
    const std::uint32_t part = warp / strips;
    Strided rounds{first, first_sample + part, stride,
                   part < stride && part < samples ? (samples - part + stride - 1) / stride : 0};
    trace_items(scene, film, rounds, pixels, cache, counters, ended);
    pt::cuda::add_counters(totals, counters, kernel_config.keeps_first_hits ? counters.paths : 0);
}
