// The integrator megakernel_regen: one kernel, a warp for a strip of 32 pixels. A lane whose path ended takes another
// of the strip's while the others go on, so that the warp stays full until its strip is done. Path regeneration: Novák,
// Havran and Dachsbacher 2010. Ending a path and taking another costs a warp the same for one lane as for many, so
// lanes may be made to wait for each other (regenerate_at).
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

template <class Real>
struct MegakernelRegenParameters {
    static constexpr const char* kernel = "megakernel_regen";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    std::uint32_t stride;  // number of warps that share the samples of a strip of pixels
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // counts of paths by their number of segments; null: not counted
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/warp_items.cuh"

// The samples of a strip of pixels that one warp takes: every `stride`-th.
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

// Traces paths with regeneration: warp w takes strip w mod strips, and of it samples w / strips, w / strips + stride,
// ...
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

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::megakernel_regen {
namespace {

constexpr Tunable tunables[] = {megakernel_tunables[0], megakernel_tunables[1], megakernel_tunables[2],
                                megakernel_tunables[3], regeneration_tunable};

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel_regen",
    .summary =
        "one kernel, a warp a strip of pixels; a lane whose path ended takes one that waits; full warps begin paths",
    .origin = "Novák, Havran and Dachsbacher 2010 (path regeneration)",
    .traits = IntegratorTraits{.keeps_branches = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class MegakernelRegen final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<MegakernelRegenParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch((job.pixels + warp_size - 1) / warp_size * warp_size * stride,
                   MegakernelRegenParameters<Real>{job.scene, job.film, first_sample, samples, stride, job.cache,
                                                   job.totals, job.lengths()});
    }
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<MegakernelRegen>();
    made.constants = regeneration_constants;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::megakernel_regen

#endif
