// A queue that stays full: shading puts the next path in the place of one that ends, so every kernel finds as many
// paths alive as there are slots, until none is left to begin. Two kernels a round, between which paths can be sorted.
// The path pool of Laine, Karras and Aila 2013, "Megakernels considered harmful", and of Novák, Havran and Dachsbacher
// 2010, "Path regeneration for interactive path tracing".
#pragma once

#include "variants/cuda/append.cuh"
#include "variants/cuda/hit_keys.cuh"
#include "variants/integrator/wavefront_refill_parameters.cuh"

namespace pt::cuda {

__device__ inline ::Path path_of_number(const ::Scene& scene, const PathSupply& supply, std::uint32_t number,
                                        const ::HitCache& cache) {
    const std::uint32_t pixels = own_pixels(scene);
    const std::uint32_t pixel = image_pixel(number % pixels, scene.camera.width);
    return first_path(scene, pixel, supply.first_sample + number / pixels, cache);
}

__device__ inline std::uint32_t slot_of(const std::uint32_t* order, std::uint32_t position) {
    return order != nullptr ? order[position] : position;
}

}  // namespace pt::cuda

PT_KERNEL(fill_queue, pt::cuda::FillQueueParameters<Real>,
          (Scene parameter, PathStore store, std::uint32_t* count, std::uint32_t slots, pt::cuda::PathSupply supply,
           HitCache cache)) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = slots;
        *supply.next = slots;
    }
    if (i < slots) {
        Paths(store).put<carried_fields>(i, pt::cuda::path_of_number(scene.shade, supply, i, cache));
    }
}

PT_KERNEL(intersect_queue, pt::cuda::IntersectQueueParameters<Real>,
          (Scene parameter, PathStore store, const std::uint32_t* order, std::uint32_t slots, StoredHit* hits,
           std::uint32_t* keys, std::uint32_t bits, std::uint32_t chunk, std::uint32_t last_key,
           pt::cuda::KeyBounds bounds, pt::cuda::PathSupply supply, pt::cuda::ProgressReport report, Totals* totals)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *static_cast<volatile std::uint64_t*>(report.word) = std::uint64_t{report.round} << 32 | *supply.next;
    }
    bool alive = false;
    if (i < slots) {
        const std::uint32_t slot = pt::cuda::slot_of(order, i);
        std::uint32_t key = last_key;
        alive = paths.alive(slot);
        if (alive) {
            pt::Ray<Real> ray = paths.ray(slot);
            if constexpr (carried_fields.primitive) {
                ray.primitive = paths.primitive(slot);
            }
            const Hit hit = pt::closest_hit<Configuration>(scene.trace, ray);
            hits[slot] = {hit.t, hit.side};
            if constexpr (carried_fields.primitive) {
                paths.primitive(slot) = hit.primitive;
            }
            if (keys != nullptr) {
                key = pt::cuda::key_of(scene.shade, ray, hit, slot, bits, chunk, bounds);
            }
        }
        if (keys != nullptr) {
            keys[i] = key;
        }
    }
    pt::cuda::add_votes(&pt::cuda::own_copy(totals)->paths.rays, alive);
}

PT_KERNEL(shade_and_refill, pt::cuda::ShadeAndRefillParameters<Real>,
          (Scene parameter, FilmView film, PathStore store, const std::uint32_t* order, const std::uint32_t* count,
           const StoredHit* hits, pt::cuda::PathSupply supply, HitCache cache, Totals* totals, std::uint64_t* ended)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t slot = 0;
    bool has_ended = false;
    if (i < *count) {
        slot = pt::cuda::slot_of(order, i);
        if (paths.alive(slot)) {
            Path path = load_path(paths, slot, scene.shade);
            const StoredHit stored = hits[slot];
            if (shade(scene, path, Hit{stored.t, stored.side, path.primitive}, counters)) {
                paths.update<carried_fields>(slot, path);
            } else {
                pt::accumulate(film, path);
                counters.paths += 1;
                has_ended = true;
                if (ended != nullptr) {
                    pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
                }
            }
        }
    }
    // One atomic operation a block: those of every warp on one counter would take longer than the shading.
    const std::uint32_t number = pt::cuda::append_by_block(supply.next, has_ended);
    if (has_ended && number < supply.total) {
        paths.put<carried_fields>(slot, pt::cuda::path_of_number(scene.shade, supply, number, cache));
    } else if (has_ended) {
        paths.end(slot);
    }
    pt::cuda::add_shade_counters(totals, counters);
}
