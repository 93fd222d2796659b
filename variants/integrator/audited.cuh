// The integrator audited on CUDA: a megakernel that inspects every path's state between its stages (kernels/health.h),
// for what can go wrong, never for times. Its film is held to the reference's bits like any other's.
#pragma once

#include "kernels/film.h"
#include "kernels/health.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

template <class Real>
struct AuditedParameters {
    static constexpr const char* kernel = "audited";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    std::uint32_t stride;  // number of threads that share a pixel's samples
    HealthRequest health;
    Totals* totals;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "kernels/health.h"
#include "variants/cuda/device/device.cuh"

namespace pt::cuda {

__device__ inline void add_health(HealthCounters* totals, const HealthCounters& mine) {
    const auto address = [](std::uint64_t& entry) { return reinterpret_cast<unsigned long long*>(&entry); };
    for_each_entry(
        *totals, mine,
        [&](std::uint64_t& into, std::uint64_t value) {
            if (value != 0) {
                atomicAdd(address(into), static_cast<unsigned long long>(value));
            }
        },
        [&](std::uint64_t& into, std::uint64_t value) {
            if (value != HealthCounters::nowhere) {
                atomicMin(address(into), static_cast<unsigned long long>(value));
            }
        },
        [&](std::uint64_t& into, std::uint64_t value) {
            if (value != 0) {
                atomicMax(address(into), static_cast<unsigned long long>(value));
            }
        });
}

}  // namespace pt::cuda

PT_KERNEL(audited, pt::cuda::AuditedParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
           std::uint32_t stride, pt::HealthRequest health, Totals* totals)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    pt::HealthCounters mine;
    pt::PixelSum<Configuration> sum;
    const std::uint32_t pixels = pt::cuda::own_pixels(scene.shade);
    const std::uint32_t pixel = pt::cuda::image_pixel(pt::cuda::thread_number() % pixels, scene.shade.camera.width);
    const std::uint32_t part = pt::cuda::thread_number() / pixels;
    if (part < stride) {
        for (std::uint32_t i = part; i < samples; i += stride) {
            Path path = pt::generate<Configuration>(scene.shade, pixel, first_sample + i);
            pt::inspect_path<Configuration>(scene.shade, scene.trace, path, health.around_eye, health.knows_sides,
                                            counters, mine);
            sum.add(film, path.radiance);
            counters.rays += path.segment;
            counters.paths += 1;
        }
        sum.finish(film, pixel);
        pt::cuda::add_health(health.counters, mine);
    }
    pt::cuda::add_counters(totals, counters, 0);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::audited {
namespace {

Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits",
                "looks at every segment: needs first_bounce=off, not " + std::string(variant.first_bounce.name)};
    }
    return megakernel_unsupported_reason(features, variant);
}

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "audited",
    .summary = "megakernel that looks at every path's state between stages; for health, not for times",
    .origin = "Falcor's InvalidPixelDetectionPass",
    .traits = IntegratorTraits{.sums_in_order = true, .inspects = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class Audited final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<AuditedParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch(job.pixels * stride,
                   AuditedParameters<Real>{job.scene, job.film, first_sample, samples, stride, job.health, job.totals});
    }
};

const Registration registration(descriptor, {.cuda = {.integrator = integrator_hook<Audited>()}});

}  // namespace
}  // namespace pt::cuda::integrator::audited

#endif
