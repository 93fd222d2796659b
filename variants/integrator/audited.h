// The integrator audited on the CPU: depth_first that inspects every path's state between its stages
// (kernels/health.h), for what can go wrong, never for times. Its film is held to the reference's bits like any other.
#pragma once

#include <mutex>

#include "kernels/health.h"
#include "variants/integrator/depth_first.h"

namespace pt::integrator::audited {

inline Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits",
                "looks at every segment: needs first_bounce=off, not " + std::string(variant.first_bounce.name)};
    }
    return depth_first::unsupported_reason(features, variant);
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "audited",
    .summary = "depth_first that looks at every path's state between stages; for health, not for times",
    .origin = "Falcor's InvalidPixelDetectionPass",
    .traits = IntegratorTraits{.sums_in_order = true},
    .unsupported_reason = unsupported_reason,
    .check_counters = depth_first::check_counters,
};

inline constexpr KernelSets kernel_sets{
    .in_double = true,
    .generic_alone = true,
};

template <class Config>
void render(RenderJobIn<typename Config::Real>& job) {
    std::mutex mutex;
    parallel_for(job.scene.pixel_count(), depth_first::pixels_per_chunk, [&](std::size_t begin, std::size_t end) {
        PathCounters counters;
        HealthCounters health;
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            PixelSum<Config> sum;
            for (std::uint32_t i = 0; i < job.samples; ++i) {
                auto path = generate<Config>(job.scene, static_cast<std::uint32_t>(pixel), job.first_sample + i);
                inspect_path<Config>(job.scene, job.scene, path, job.health.around_eye, job.health.knows_sides,
                                     counters, health);
                sum.add(job.film, path.radiance);
                counters.rays += path.segment;
            }
            sum.finish(job.film, static_cast<std::uint32_t>(pixel));
        }
        const std::lock_guard lock(mutex);
        job.health.counters->add(health);
        job.work.rays += counters.rays;
        job.work.paths += health.paths;
        job.work.connections += counters.connections;
        job.work.unfinished_walks += counters.unfinished_walks;
    });
}

}  // namespace pt::integrator::audited
