// A warp that works off a list of items (a sample of a pixel each): lanes whose paths ended take the next ones
// together, by their rank among themselves, without an atomic operation. What megakernel_regen and persistent share.
#pragma once

#include "variants/cuda/device.cuh"

// Items 0 to count - 1 of a strip of 32 pixels: item i is pixel first_pixel + i mod 32, sample first_sample +
// (i / 32) * sample_stride. A strip may reach beyond the last pixel; such items are passed over.
struct Items {
    std::uint32_t count;
    std::uint32_t pixels;  // the device's own
    std::uint32_t width;   // of the image
    pt::PixelPlace first;  // among its own
    std::uint32_t first_sample, sample_stride;

    __device__ bool exists(std::uint32_t item) const { return item < count && first.index + item % warp_size < pixels; }
    // One division a strip instead of one a path.
    __device__ pt::PixelPlace place(std::uint32_t item) const {
        const std::uint32_t step = item % warp_size;
        const std::uint32_t x = first.x + step;
        const bool wraps = x >= width;
        if (width < warp_size) {
            return pt::PixelPlace::of(first.index + step, width);
        }
        return {first.index + step, wraps ? x - width : x, first.y + (wraps ? 1u : 0u)};
    }
    __device__ std::uint32_t sample(std::uint32_t item) const {
        return first_sample + item / warp_size * sample_stride;
    }
};

// Traces them all. Every lane of the warp must call it, with the same items. `ended`: as in megakernel.
__device__ inline void trace_items(const SceneViews& scene, const FilmView& film, const Items& items,
                                   const HitCache& cache, ThreadCounters& counters, std::uint64_t* ended) {
    constexpr unsigned all_lanes = 0xffffffffu;
    std::uint32_t next = 0;  // the same in all lanes
    bool alive = false;
    bool holds = false;  // a path, alive or ended
    pt::Walk walk;
    Path path;
    do {
        const unsigned living = __ballot_sync(all_lanes, alive);
        if (__popc(living) <= static_cast<int>(tuned::regenerate_at)) {
            if (!alive) {
                if (holds) {
                    pt::accumulate(film, path);
                    counters.rays += path.segment - (kernel_config.keeps_first_hits ? 1 : 0);
                    counters.paths += 1;
                    if (ended != nullptr) {
                        pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
                    }
                }
                const std::uint32_t item = next + __popc(~living & ((1u << pt::cuda::lane()) - 1u));
                alive = holds = items.exists(item);
                if (alive) {
                    path = first_path(scene.shade, pt::cuda::in_image(items.place(item), items.width),
                                      items.sample(item), cache);
                }
            }
            // Of 32 free lanes one takes an item that exists, so none is left behind where a strip is cut.
            next += __popc(~living);
        }
        if (alive) {
            alive = take_step(scene, path, walk, cache, counters);
        }
    } while (__any_sync(all_lanes, holds));
}
