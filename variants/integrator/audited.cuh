// The megakernel with every path's state looked at between its stages (kernels/health.h): for what can go wrong, never
// for times. Its film is held to the reference's bits like any other's.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"

#include "kernels/health.h"

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

extern "C" __global__ void PT_LAUNCH_BOUNDS audited(Scene parameter, FilmView film, std::uint32_t first_sample,
                                                    std::uint32_t samples, std::uint32_t stride,
                                                    pt::HealthRequest health, Totals* totals) {
    const SceneViews scene(parameter);
    PathCounters counters;
    pt::HealthCounters mine;
    pt::PixelSum<Configuration> sum;
    const std::uint32_t pixel = pt::cuda::thread_number() % scene.shade.pixel_count();
    const std::uint32_t part = pt::cuda::thread_number() / scene.shade.pixel_count();
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

#else

#include "variants/cuda/megakernels.h"

namespace pt::cuda::integrator::audited {

inline Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits",
                "looks at every segment: needs first_bounce=off, not " + std::string(variant.first_bounce.name)};
    }
    return megakernel_unsupported_reason(features, variant);
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "audited",
    .summary = "megakernel that looks at every path's state between stages; for health, not for times",
    .origin = "Falcor's InvalidPixelDetectionPass",
    .traits = IntegratorTraits{.sums_in_order = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = megakernel_work_missing,
};

inline void render(Job& job) {
    const Stage stage(job.stages, "trace", job.stream);
    const std::uint32_t most = samples_per_launch(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t samples = std::min(most, job.samples - done);
        const std::uint32_t stride = std::min(job.samples_in_flight, samples);
        job.launch("audited", job.pixels * stride, job.scene, job.film, job.first_sample + done, samples, stride,
                   job.health, job.totals);
        done += samples;
    }
}

inline const Integrator hook{.render = render, .kernels = {"audited"}};

}  // namespace pt::cuda::integrator::audited

#endif
