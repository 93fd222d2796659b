// As many threads as the GPU holds at once; each warp takes piece after piece of the image, a few samples of a strip of
// pixels, from a global counter. Persistent threads: Aila and Laine 2009.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/warp_items.cuh"

// Pieces are numbered strip by strip within `samples_per_piece` samples of the whole image: neighbouring warps work on
// neighbouring strips.
extern "C" __global__ void PT_LAUNCH_BOUNDS persistent(Scene parameter, FilmView film, std::uint32_t first_sample,
                                                       std::uint32_t samples, HitCache cache, Totals* totals,
                                                       std::uint64_t* ended, std::uint32_t samples_per_piece,
                                                       std::uint64_t* next_piece) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t pixels = scene.shade.pixel_count();
    const std::uint32_t strips = (pixels + 31) / 32;
    const std::uint32_t pieces = strips * ((samples + samples_per_piece - 1) / samples_per_piece);
    const auto take_piece = [&] {
        unsigned long long taken = 0;
        if (pt::cuda::lane() == 0) {
            taken = atomicAdd(reinterpret_cast<unsigned long long*>(next_piece), 1ull);
        }
        return static_cast<std::uint32_t>(__shfl_sync(0xffffffffu, taken, 0));
    };
    std::uint32_t piece = take_piece();
    while (piece < pieces) {
        const std::uint32_t done = piece / strips * samples_per_piece;
        const std::uint32_t rounds = min(samples_per_piece, samples - done);
        const std::uint32_t width = scene.shade.camera.width;
        const pt::PixelPlace first = pt::PixelPlace::of(piece % strips * 32, width);
        const Items items{32 * rounds, pixels, width, first, first_sample + done, 1};
        trace_items(scene, film, items, cache, counters, ended);
        pt::cuda::add_if_many(totals, counters);
        piece = take_piece();
    }
    pt::cuda::add_counters(totals, counters, PT_CACHED ? static_cast<std::uint32_t>(counters.paths) : 0);
}

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::persistent {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "persistent",
    .summary = "as many warps as fit at once, each taking pieces of the image from a global counter",
    .origin = "Aila and Laine 2009 (persistent threads)",
    .backends = on_cuda,
    .tunables = persistent_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

inline void render(Job& job) {
    fill_cache(job);
    const Stage stage(job.stages, "trace", job.stream);
    const auto blocks = static_cast<std::uint32_t>(job.module->blocks_per_multiprocessor("persistent", job.block)) *
                        job.multiprocessors;
    const std::uint32_t most = samples_per_persistent_launch(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t samples = std::min(most, job.samples - done);
        PT_CUDA_CHECK(cudaMemsetAsync(job.next_item, 0, sizeof(std::uint64_t), job.stream));
        job.launch_blocks("persistent", blocks, job.scene, job.film, job.first_sample + done, samples, job.cache,
                          job.totals, job.lengths, samples_per_strip(job), job.next_item);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .defines = regeneration_defines, .kernels = {"persistent"}};

}  // namespace pt::cuda::integrator::persistent

#endif
