// The integrator persistent: persistent threads, as many as the GPU holds at once. Each warp takes piece after piece of
// the image, a few samples of a strip of pixels, from a global counter. Aila and Laine 2009.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

template <class Real>
struct PersistentParameters {
    static constexpr const char* kernel = "persistent";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // counts of paths by their number of segments; null: not counted
    std::uint32_t samples_per_piece;
    std::uint64_t* next_piece;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/warp_items.cuh"

// Pieces of an image, numbered strip by strip within `samples_per_piece` samples of the whole image, so neighbouring
// warps work on neighbouring strips. A warp takes the next piece while paths of the last one are still alive.
struct Pieces {
    std::uint32_t strips, count, width, first_sample, samples, samples_per_piece;
    Totals* totals;
    std::uint64_t* next;
    Round round = {};        // what the warp begins next: a sample of a strip of pixels
    std::uint32_t left = 0;  // rounds left in the piece of the image that the warp works on
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

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/persistent.h"
#include "variants/cuda/runtime/handles.h"

namespace pt::cuda::integrator::persistent {
namespace {

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "persistent",
    .summary = "as many warps as fit at once, each taking pieces of the image from a global counter",
    .origin = "Aila and Laine 2009 (persistent threads)",
    .traits = IntegratorTraits{.keeps_branches = true},
    .backends = on_cuda,
    .tunables = persistent_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class Persistent final : public Megakernel<Real> {
public:
    Persistent(JobOf<Real>& job, const IntegratorNeeds& needs)
        : Megakernel<Real>(job),
          blocks_(static_cast<std::uint32_t>(job.module->blocks_per_multiprocessor("persistent", job.block)) *
                  job.multiprocessors),
          samples_per_piece_(needs.tunable("piece")) {}

    static std::vector<KernelSignature> kernels() { return {kernel_of<PersistentParameters<Real>>()}; }

    void reserve(Arena& arena) override { next_piece_ = arena.take<std::uint64_t>(1); }

private:
    std::uint32_t most_samples() const override { return samples_per_persistent_launch(this->job_); }
    void launch(std::uint32_t first_sample, std::uint32_t samples) override {
        JobOf<Real>& job = this->job_;
        clear(next_piece_, sizeof *next_piece_, job.stream);
        job.launch_blocks(blocks_, PersistentParameters<Real>{job.scene, job.film, first_sample, samples, job.cache,
                                                              job.totals, job.lengths(),
                                                              samples_per_strip(job, samples_per_piece_), next_piece_});
    }

    std::uint32_t blocks_;
    std::uint32_t samples_per_piece_;
    std::uint64_t* next_piece_ = nullptr;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<Persistent>();
    made.constants = regeneration_constants;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::persistent

#endif
