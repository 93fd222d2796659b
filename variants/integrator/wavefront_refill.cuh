// A queue that stays full: the next path takes the place of one that ends. Refilled at once, every kernel finds as many
// paths alive as there are slots, until none is left to begin. Two kernels a round, between which paths can be sorted,
// and a third in rounds after which a queue is refilled that is so now and then. Where a block replaces paths, it first
// gathers the slots of those that ended, so that its first warps make the camera rays of the next ones together.
// The path pool of Laine, Karras and Aila 2013, "Megakernels considered harmful", and of Novák, Havran and Dachsbacher
// 2010, "Path regeneration for interactive path tracing".
#pragma once

#include "variants/cuda/append.cuh"
#include "variants/cuda/hit_keys.cuh"
#include "variants/cuda/queue_slots.cuh"
#include "variants/integrator/wavefront_refill_parameters.cuh"

namespace pt::cuda {

// Replaces the paths in `slot` of the threads whose path has `ended`, or marks them as ended where none is left. Every
// thread of the block must call it.
__device__ inline void refill(const ::Scene& scene, const ::Paths& paths, const PathSupply& supply, bool ended,
                              std::uint32_t slot, const ::HitCache& cache) {
    const Gathered free_slots = gather_by_block(supply.next, ended, slot);
    if (threadIdx.x < free_slots.count) {
        const std::uint32_t number = free_slots.first + threadIdx.x;
        const std::uint32_t free_slot = free_slots.values[threadIdx.x];
        if (number < supply.total) {
            paths.put<carried_fields>(free_slot, path_of_number(scene, number, supply.first_sample, cache));
        } else {
            paths.end(free_slot);
        }
    }
}

}  // namespace pt::cuda

PT_KERNEL(fill_queue, pt::cuda::FillQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t* count, std::uint32_t slots,
           pt::cuda::PathSupply supply, HitCache cache)) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = slots;
        *supply.next = slots;
    }
    if (i < slots) {
        Paths(store).put<carried_fields>(i, pt::cuda::path_of_number(scene.shade, i, supply.first_sample, cache));
    }
}

PT_KERNEL(intersect_queue, pt::cuda::IntersectQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, const std::uint32_t* order, std::uint32_t slots,
           StoredHit* hits, std::uint32_t* keys, std::uint32_t bits, std::uint32_t chunk, std::uint32_t last_key,
           pt::cuda::KeyBounds bounds, pt::cuda::PathSupply supply, pt::cuda::ProgressReport report, Totals* totals)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *static_cast<volatile std::uint64_t*>(report.word) = std::uint64_t{report.round} << 32 | *supply.next;
    }
    bool alive = false;
    if (i < slots) {
        const std::uint32_t slot = pt::cuda::slot_at(order, i);
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
          (const __grid_constant__ Scene parameter, FilmView film, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, const StoredHit* hits, pt::cuda::PathSupply supply, HitCache cache,
           Totals* totals, std::uint64_t* ended)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t slot = 0;
    bool has_ended = false;
    if (i < *count) {
        slot = pt::cuda::slot_at(order, i);
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
    if (supply.total != 0) {
        pt::cuda::refill(scene.shade, paths, supply, has_ended, slot, cache);
    } else if (has_ended) {
        paths.end(slot);
    }
    pt::cuda::add_shade_counters(totals, counters);
}

PT_KERNEL(refill_queue, pt::cuda::RefillQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t slots, pt::cuda::PathSupply supply,
           HitCache cache)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    pt::cuda::refill(scene.shade, paths, supply, i < slots && !paths.alive(i), i, cache);
}
