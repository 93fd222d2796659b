// The megakernel with every path's state looked at between its stages (kernels/health.h): for what can go wrong, never
// for times. Its film is held to the reference's bits like any other's.
#pragma once

#include "variants/cuda/device.cuh"

#include "kernels/health.h"
#include "variants/integrator/audited_parameters.cuh"

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
