// The integrator megakernel: one thread a pixel, a path at a time from the camera to its end, the loop of depth_first
// as one kernel. In exact arithmetic it is the reference that bitwise claims on the GPU are held against.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

template <class Real>
struct MegakernelParameters {
    static constexpr const char* kernel = "megakernel";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    std::uint32_t stride;  // number of threads that share a pixel's samples
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // counts of paths by their number of segments; null: not counted
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/branches.cuh"

// Traces whole paths: thread t takes the samples t / pixels, t / pixels + stride, ... of pixel t mod pixels.
PT_KERNEL(megakernel, pt::cuda::MegakernelParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
           std::uint32_t stride, HitCache cache, Totals* totals, std::uint64_t* ended)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    pt::PixelSum<Configuration> sum;
    const std::uint32_t pixels = pt::cuda::own_pixels(scene.shade);
    const std::uint32_t pixel = pt::cuda::image_pixel(pt::cuda::thread_number() % pixels, scene.shade.camera.width);
    const std::uint32_t part = pt::cuda::thread_number() / pixels;
    if (part < stride) {
        for (std::uint32_t i = part; i < samples; i += stride) {
            Path path = first_path(scene.shade, pixel, first_sample + i, cache);
            BranchesHere branches;
            branches.finish(scene, path, cache, counters);
            sum.add(film, path.radiance);
            counters.rays += branches.rays(path) - (kernel_config.keeps_first_hits ? 1 : 0);
            counters.paths += 1;
            if (ended != nullptr) {
                pt::atomic_add(&ended[branches.longest(path) - 1], std::uint64_t{1});
            }
        }
        sum.finish(film, pixel);
    }
    pt::cuda::add_counters(totals, counters, kernel_config.keeps_first_hits ? counters.paths : 0);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::megakernel {
namespace {

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel",
    .summary = "one kernel, a thread a pixel, a path at a time, state in registers",
    .origin = "Aila and Laine 2009 for the shape",
    .reference = on_cuda,
    .traits = IntegratorTraits{.sums_in_order = true, .keeps_branches = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class PlainMegakernel final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<MegakernelParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch(job.pixels * stride, MegakernelParameters<Real>{job.scene, job.film, first_sample, samples, stride,
                                                                   job.cache, job.totals, job.lengths()});
    }
};

const Registration registration(descriptor, {.cuda = {.integrator = integrator_hook<PlainMegakernel>()}});

}  // namespace
}  // namespace pt::cuda::integrator::megakernel

#endif
