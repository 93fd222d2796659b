// As many threads as the GPU holds at once; each warp takes piece after piece of the image, a few samples of a strip of
// pixels, from a global counter. Persistent threads: Aila and Laine 2009.
#pragma once

#include "variants/cuda/warp_items.cuh"
#include "variants/integrator/persistent_parameters.cuh"

// Pieces are numbered strip by strip within `samples_per_piece` samples of the whole image: neighbouring warps work on
// neighbouring strips.
PT_KERNEL(persistent, pt::cuda::PersistentParameters<Real>,
          (Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples, HitCache cache,
           Totals* totals, std::uint64_t* ended, std::uint32_t samples_per_piece, std::uint64_t* next_piece)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t pixels = pt::cuda::own_pixels(scene.shade);
    const std::uint32_t strips = (pixels + warp_size - 1) / warp_size;
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
        const pt::PixelPlace first = pt::PixelPlace::of(piece % strips * warp_size, width);
        const Items items{warp_size * rounds, pixels, width, first, first_sample + done, 1};
        trace_items(scene, film, items, cache, counters, ended);
        pt::cuda::add_if_many(totals, counters);
        piece = take_piece();
    }
    pt::cuda::add_counters(totals, counters,
                           kernel_config.keeps_first_hits ? counters.paths : 0);
}
