// Stage by stage over a queue of paths, a kernel each: generate, intersect, (sort), shade, (compact). The shape of
// cis565, and of Laine, Karras and Aila 2013, "Megakernels considered harmful".
#pragma once

#include "variants/cuda/advance.cuh"
#include "variants/cuda/device.cuh"
#include "variants/cuda/queue_slots.cuh"
#include "variants/cuda/sort_keys.cuh"
#include "variants/integrator/wavefront_fetching.cuh"
#include "variants/integrator/wavefront_parameters.cuh"

// Starts path i in slot i; with a cursor the first sample is read from there.
PT_KERNEL(generate_paths, pt::cuda::GeneratePathsParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t* count, std::uint32_t pool,
           std::uint32_t first_sample, const std::uint32_t* cursor, HitCache cache)) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = pool;
    }
    if (i < pool) {
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        Paths(store).put<carried_fields>(i, pt::cuda::path_of_number(scene.shade, i, first, cache));
    }
}

// Traces the queue's rays, one position a thread unless traversal=persistent. With `keys`, also writes the sort key of
// every position below `bound`: ended paths and positions beyond the count have the last one.
PT_KERNEL(intersect_paths, pt::cuda::IntersectPathsParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, std::uint32_t bound, StoredHit* hits, HitCache cache, SegmentNumber segment,
           SegmentCounts segments, std::uint32_t* keys, std::uint32_t bits, std::uint32_t chunk, std::uint32_t last_key,
           pt::cuda::KeyBounds bounds)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    if constexpr (pt::cuda::fetches_paths<Accelerator>) {
        const pt::cuda::IntersectStage stage{scene,   paths, order, count, bound,    hits,  cache,
                                             segment, keys,  bits,  chunk, last_key, bounds};
        pt::cuda::intersect_fetched<Accelerator>(stage, segments);
        return;
    }
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t key = last_key;
    bool live = false;
    if (i < *count) {
        const std::uint32_t slot = pt::cuda::slot_at(order, i);
        if (paths.alive(slot)) {
            live = true;
            pt::Ray<Real> ray = paths.ray(slot);
            Hit hit;
            if (kernel_config.keeps_first_hits && segment == 0) {
                hit = cache.load<Configuration>(cache.index(paths.pixel(slot), paths.sample(slot)));
            } else {
                if constexpr (carried_fields.primitive) {
                    ray.primitive = paths.primitive(slot);
                }
                hit = pt::closest_hit<Configuration>(scene.trace, ray);
            }
            hits[slot] = {hit.t, hit.side};
            if constexpr (carried_fields.primitive) {
                paths.primitive(slot) = hit.primitive;
            }
            if (keys != nullptr) {
                key = pt::cuda::key_of(scene.shade, ray, hit, slot, bits, chunk, bounds);
            }
        }
    }
    if (keys != nullptr && i < bound) {
        keys[i] = key;
    }
    pt::cuda::add_segment_counts(segments, segment, live, *count);
}

// Writes the sort key of rays that are yet to be traced: ended paths and positions beyond the count have the last one.
PT_KERNEL(write_ray_keys, pt::cuda::WriteRayKeysParameters,
          (PathStore store, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t bound,
           std::uint32_t* keys, std::uint32_t last_key, pt::cuda::KeyBounds bounds)) {
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < bound) {
        std::uint32_t key = last_key;
        const std::uint32_t slot = i < *count ? pt::cuda::slot_at(order, i) : 0;
        if (i < *count && paths.alive(slot)) {
            key = sort_key::rest(paths.ray(slot), Hit(), bounds);
        }
        keys[i] = key;
    }
}

PT_KERNEL(shade_paths, pt::cuda::ShadePathsParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, const StoredHit* hits, Totals* totals)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < *count) {
        const std::uint32_t slot = pt::cuda::slot_at(order, i);
        if (paths.alive(slot)) {
            Path path = load_path(paths, slot, scene.shade);
            // The generator of cis565 is seeded by where a path lies in the queue, not by whose it is.
            const std::uint32_t pixel = path.pixel;
            if (contains(pt::sampler_of<Configuration>(scene.shade.seed), pt::Feature::minstd)) {
                path.pixel = i;
            }
            const StoredHit stored = hits[slot];
            const bool alive = shade(scene, path, Hit{stored.t, stored.side, path.primitive}, counters);
            path.pixel = pixel;
            if (alive) {
                paths.update<carried_fields>(slot, path);
            } else {
                pt::accumulate(film, path);
                counters.paths += 1;
                paths.end(slot);
            }
        }
    }
    pt::cuda::add_shade_counters(totals, counters);
}
