// The kernel that fills the first-bounce cache: part of the programs of the variants that have one.
#pragma once

#include "variants/cuda/device/device.cuh"

// Traces the camera rays that `samples` samples, no more than the cache keeps, will use: one thread a pixel.
PT_UNBOUNDED_KERNEL(fill_cache, pt::cuda::FillCacheParameters<Real>,
                    (const __grid_constant__ Scene parameter, HitCache cache, std::uint32_t first_sample,
                     std::uint32_t samples, Totals* totals)) {
    const SceneViews scene(parameter);
    const std::uint32_t own = pt::cuda::thread_number();
    std::uint32_t fills = 0;
    if (own < pt::cuda::own_pixels(scene.shade)) {
        const std::uint32_t pixel = pt::cuda::image_pixel(own, scene.shade.camera.width);
        for (std::uint32_t i = 0; i < samples; ++i) {
            const std::uint32_t ray = (first_sample + i) % cache.rays;
            const Path path = pt::generate<Configuration>(scene.shade, pixel, ray, ray);
            cache.store<Configuration>(cache.index(pixel, ray), trace(scene, path));
            fills += 1;
        }
    }
    const std::uint32_t values[] = {fills, fills};
    Totals* const mine = pt::cuda::own_copy(totals);
    std::uint64_t* const sums[] = {&mine->cache_fills, &mine->paths.rays};
    pt::cuda::add_over_block(values, sums);
}
