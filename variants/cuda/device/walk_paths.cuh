// The kernel that takes the subsurface walks of a queue's paths to their ends: part of the programs of integrators with
// a queue, if the scene has subsurface bodies. A lane whose walk has ended takes the next walker, so a warp does not
// wait for the longest of 32 walks.
#pragma once

#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/walkers.cuh"

// A warp takes new walkers once at most so many of its lanes walk: taking one walker costs as much as taking many.
inline constexpr int walking_at_fetch = 20;

// Stores a path that has left its body where the next segment reads it, and ends a path that was lost on its walk.
__device__ inline void put_after_walk(const FilmView& film, const Path& path, bool alive, const Walker& walker,
                                      const PathStore& in, const PathStore& out, std::uint32_t* out_count,
                                      std::uint32_t parts, ThreadCounters& counters) {
    if (!alive) {
        pt::accumulate(film, path);
        counters.paths += 1;
    }
    if (out_count == nullptr) {
        if (alive) {
            Paths(in).update<carried_fields>(walker.slot, path);
        } else {
            Paths(in).end(walker.slot);
        }
    } else if (alive) {
        std::uint32_t* const count = out_count + walker.place * pt::cuda::counter_stride;
        const std::uint32_t position = atomicAdd(count, 1u);
        Paths(out).put<carried_fields>(walker.place * (out.capacity / parts) + position, path);
    }
}

PT_KERNEL(walk_paths, pt::cuda::WalkPathsParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, pt::cuda::WalkerList list, PathStore in,
           PathStore out, std::uint32_t* out_count, std::uint32_t parts, SegmentNumber segment, Totals* totals)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    if (out_count != nullptr) {
        out_count += segment.passed() * parts * pt::cuda::counter_stride;
    }
    pt::cuda::WalkersToTake walkers(list);
    Walker walker;
    Path path;
    std::uint32_t pixel = 0;
    bool walks = false;
    unsigned walking = 0;  // lanes of the warp that are on a walk
    do {
        if (walkers.some_left() && __popc(walking) <= walking_at_fetch) {
            if (walkers.take(!walks, walker)) {
                walks = true;
                path = load_path(Paths(in), walker.slot, scene.shade);
                pixel = path.pixel;
                if (contains(pt::sampler_of<Configuration>(scene.shade.seed), pt::Feature::minstd)) {
                    path.pixel = walker.place;  // minstd is seeded by queue position in shading, too
                }
            }
        }
        if (walks) {
            const bool alive = pt::walk_on<Configuration>(scene.shade, path, walker.walk, counters);
            walks = alive && walker.walk.is_on();
            if (!walks) {
                path.pixel = pixel;
                put_after_walk(film, path, alive, walker, in, out, out_count, parts, counters);
            }
        }
        walking = __ballot_sync(pt::cuda::all_lanes, walks);
    } while (walking != 0 || walkers.some_left());
    pt::cuda::add_counters(totals, counters, 0);
    pt::cuda::finish_list(list.counts);
}
