// One thread a pixel, a path at a time from the camera to its end: the loop of depth_first as one kernel. Its generic
// kernel in exact arithmetic is the reference that bitwise claims on the GPU are held against.
#pragma once

#include "variants/cuda/branches.cuh"
#include "variants/integrator/megakernel_parameters.cuh"

// One kernel for whole paths: thread t takes the samples t / pixels, t / pixels + stride, ... of pixel t mod pixels.
// `ended`: paths by their number of segments, or null.
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
