// The kernel of wavefront_refill that takes subsurface walks on, for scenes that have some. A walk takes some steps a
// round, so that no round waits for a long one.
#pragma once

#include "variants/integrator/wavefront_refill.cuh"

namespace pt::cuda {

// Puts the next path to begin into a slot, or marks the slot as ended if no path is left or the slot is filled later.
__device__ inline void replace_path(const ::Scene& scene, const ::Paths& paths, const PathSupply& supply,
                                    std::uint32_t slot, const ::HitCache& cache) {
    const std::uint32_t number = supply.total != 0 ? atomicAdd(supply.next, 1u) : 0;
    if (number < supply.total) {
        paths.put<carried_fields>(slot, path_of_number(scene, number, supply.first_sample, cache));
    } else {
        paths.end(slot);
    }
}

}  // namespace pt::cuda

// Takes the walks of `list` on by up to tuned::walk_steps steps each, and puts those that go on into `again`. Where a
// path is lost on its walk, the next path takes its slot.
PT_KERNEL(walk_on, pt::cuda::WalkOnParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore store, StoredHit* hits,
           pt::cuda::WalkerList list, pt::cuda::WalkerList again, pt::cuda::PathSupply supply, HitCache cache,
           Totals* totals, std::uint64_t* ended)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    pt::cuda::WalkersToTake walkers(list);
    while (walkers.some_left()) {
        Walker walker;
        const bool has_one = walkers.take(true, walker);
        bool alive = has_one;
        if (has_one) {
            Path path = load_path(paths, walker.slot, scene.shade);
            for (std::uint32_t step = 0; alive && walker.walk.is_on() && step < tuned::walk_steps; ++step) {
                alive = pt::walk_on<Configuration>(scene.shade, path, walker.walk, counters);
            }
            if (!alive) {
                pt::accumulate(film, path);
                counters.paths += 1;
                if (ended != nullptr) {
                    pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
                }
                pt::cuda::replace_path(scene.shade, paths, supply, walker.slot, cache);
            } else {
                paths.update<carried_fields>(walker.slot, path);
            }
            if (!alive || !walker.walk.is_on()) {
                hits[walker.slot].t = 0;
            }
        }
        if (!alive) {
            walker.walk.step = pt::Walk::none;
        }
        pt::cuda::put_walkers(again, walker.walk, walker.slot, 0);
    }
    pt::cuda::add_counters(totals, counters, 0);
    pt::cuda::finish_list(list.counts);
}
