// What every integrator on CUDA is handed: the scene and the film on the device, compiled kernels, a stream, the
// samples to take, and where it counts what it does.
#pragma once

#include <algorithm>

#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/totals.h"
#include "variants/cuda/runtime/stage_events.h"
#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::cuda {

struct Job {
    const Module* module = nullptr;
    FilmView film;                    // view of the film, in device memory
    std::uint32_t pixels = 0;         // number of the image's pixels that this device renders
    std::uint32_t image_pixels = 0;   // number of pixels of the whole film and of the first-bounce cache
    std::uint32_t longest_path = 1;   // most segments that a path may have
    std::uint32_t most_branches = 1;  // most branches into which one sample's path may split
    std::uint32_t materials = 0;
    // Samples per pixel to take in this job: the whole render's, or those of one part, from checkpoint to checkpoint.
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;
    std::uint32_t all_samples = 1;  // samples per pixel of the whole render
    std::uint32_t block = 128;      // threads of a thread block
    std::uint32_t multiprocessors = 1;
    cudaStream_t stream = nullptr;

    std::uint32_t kept_rays = 0;    // camera rays of a pixel that the first-bounce cache keeps; 0: there is none
    std::uint32_t cached_rays = 0;  // how many of the kept_rays earlier parts of the render have traced
    Totals* totals = nullptr;
    HealthRequest health;  // audit that the integrator `audited` makes, with counters in device memory
    SegmentCounts segments;
    StageEvents* stages = nullptr;  // stage timers; null: the render is not instrumented
    WorkCounters work;

    // Counts of ended paths by their number of segments, for integrators without a queue; null where nobody asked.
    std::uint64_t* lengths() const { return stages != nullptr ? segments.live : nullptr; }

    template <class Parameters>
    void launch(std::uint32_t threads, const Parameters& parameters) {
        launch_blocks((threads + block - 1) / block, parameters);
    }
    template <class Parameters>
    void launch_blocks(std::uint32_t blocks, const Parameters& parameters) {
        launch_blocks(blocks, block, parameters);
    }
    template <class Parameters>
    void launch_blocks(std::uint32_t blocks, std::uint32_t threads_a_block, const Parameters& parameters) {
        if (blocks != 0) {
            module->launch(blocks, threads_a_block, stream, parameters);
            work.launches += 1;
        }
    }
};

template <class Real>
struct JobOf : Job {
    SceneView<Real> scene = {};  // the scene, with pointers to device memory
    HitCache<Real> cache;
};

// Number of camera rays per pixel that the job's samples use and the first-bounce cache lacks; they count as cached
// after the call. Sample s uses ray s mod rays: a render's first samples need a ray each, later samples none.
inline std::uint32_t take_missing_rays(Job& job) {
    const std::uint32_t missing = std::min(job.kept_rays - job.cached_rays, job.samples);
    job.cached_rays += missing;
    return missing;
}

// Traces the rays that the first-bounce cache, if there is one, still misses.
template <class Real>
void fill_cache(JobOf<Real>& job) {
    const std::uint32_t missing = take_missing_rays(job);
    if (missing == 0) {
        return;
    }
    const Stage stage(job.stages, "fill cache", job.stream);
    job.launch(job.pixels, FillCacheParameters<Real>{job.scene, job.cache, job.first_sample, missing, job.totals});
}

}  // namespace pt::cuda
