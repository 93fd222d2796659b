// Persistent threads: as many as the GPU holds at once. Each warp takes piece after piece of the image, a few samples
// of a strip of pixels, from a global counter. Aila and Laine 2009.
#pragma once

#include "variants/cuda/warp_items.cuh"
#include "variants/integrator/persistent_parameters.cuh"

// Pieces are numbered strip by strip within `samples_per_piece` samples of the whole image: neighbouring warps work on
// neighbouring strips. A warp takes the next piece while paths of the last one are still alive.
struct Pieces {
    std::uint32_t strips, count, width, first_sample, samples, samples_per_piece;
    Totals* totals;
    std::uint64_t* next;
    Round round = {};        // that comes next
    std::uint32_t left = 0;  // rounds of the piece
    bool are_done = false;

    __device__ bool take(Round& taken, ThreadCounters& counters) {
        if (left == 0 && !are_done) {
            pt::cuda::add_if_many(totals, counters);
            begin(pt::cuda::take_number(next));
        }
        if (left == 0) {
            return false;
        }
        taken = round;
        round.sample += 1;
        left -= 1;
        return true;
    }

private:
    __device__ void begin(std::uint32_t piece) {
        are_done = piece >= count;
        if (!are_done) {
            const std::uint32_t done = piece / strips * samples_per_piece;
            left = min(samples_per_piece, samples - done);
            round = {pt::PixelPlace::of(piece % strips * warp_size, width), first_sample + done};
        }
    }
};

PT_KERNEL(persistent, pt::cuda::PersistentParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
           HitCache cache, Totals* totals, std::uint64_t* ended, std::uint32_t samples_per_piece,
           std::uint64_t* next_piece)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t pixels = pt::cuda::own_pixels(scene.shade);
    const std::uint32_t strips = (pixels + warp_size - 1) / warp_size;
    Pieces pieces{strips,
                  strips * ((samples + samples_per_piece - 1) / samples_per_piece),
                  scene.shade.camera.width,
                  first_sample,
                  samples,
                  samples_per_piece,
                  totals,
                  next_piece};
    trace_items(scene, film, pieces, pixels, cache, counters, ended);
    pt::cuda::add_counters(totals, counters, kernel_config.keeps_first_hits ? counters.paths : 0);
}
