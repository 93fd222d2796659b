// One kernel a bounce over a queue of paths: each thread traces and shades one segment of one path, and with
// compaction=atomic_append or block_scan_append puts the path, if it lives, into the next bounce's queue itself. The
// first bounce makes its camera ray in the same kernel.
#pragma once

#include "variants/cuda/advance.cuh"
#include "variants/cuda/append.cuh"
#include "variants/cuda/append_in_kernel.h"
#include "variants/cuda/queue_slots.cuh"
#include "variants/integrator/wavefront_fused_parameters.cuh"

// Paths stay in their slots unless the kernel appends.
// The queue is in tuned::append_counters parts, each with a counter of its own, since an append to one counter waits
// for all others: a GPU does a few hundred million atomic operations a second on one address. Block b appends to part b
// mod append_counters, which therefore never holds more than its share of the blocks.
using pt::cuda::counter_stride;
constexpr auto append_in_kernel = static_cast<pt::AppendInKernel>(tuned::append_in_kernel);
constexpr bool appends = append_in_kernel != pt::AppendInKernel::no;

__device__ inline std::uint32_t part_capacity(const PathStore& store) {
    return store.capacity / tuned::append_counters;
}

// The number of paths in the queue and, for the position of the calling thread, its slot. Every thread of the block
// must call locate().
struct Located {
    std::uint32_t total, slot;
};
__device__ inline Located locate(const PathStore& store, const std::uint32_t* counts, std::uint32_t position) {
    __shared__ std::uint32_t part_count[tuned::append_counters];
    for (std::uint32_t part = threadIdx.x; part < tuned::append_counters; part += kernel_config.block) {
        part_count[part] = counts[part * counter_stride];
    }
    __syncthreads();
    Located located{0, 0};
    for (std::uint32_t part = 0; part < tuned::append_counters; ++part) {
        const std::uint32_t before = located.total;
        located.total += part_count[part];
        if (position >= before && position < located.total) {
            located.slot = part * part_capacity(store) + (position - before);
        }
    }
    return located;
}

// Puts a path where the next bounce finds it. `is_new`: nothing of it lies in its slot yet. Every thread of the block
// must call it.
template <bool is_new>
__device__ inline void put_path(const Path& path, bool shaded, bool alive, std::uint32_t slot, const PathStore& out,
                                std::uint32_t* out_count) {
    const Paths paths(out);
    if constexpr (appends) {
        const std::uint32_t part = blockIdx.x % tuned::append_counters;
        std::uint32_t* const count = out_count + part * counter_stride;
        std::uint32_t position = 0;
        if constexpr (append_in_kernel == pt::AppendInKernel::by_warp) {
            position = pt::cuda::append_by_warp(count, alive);
        } else {
            position = pt::cuda::append_by_block(count, alive);
        }
        if (alive) {
            paths.put<carried_fields>(part * part_capacity(out) + position, path);
        }
    } else if (alive && is_new) {
        paths.put<carried_fields>(slot, path);
    } else if (alive) {
        paths.update<carried_fields>(slot, path);
    } else if (shaded && is_new) {
        Path ended = path;
        ended.segment = Path::ended;
        paths.put<carried_fields>(slot, ended);
    } else if (shaded) {
        paths.end(slot);
    }
}

// Traces and shades one segment; accumulates a path that ends. Returns whether it lives.
__device__ inline bool bounce(const SceneViews& scene, const FilmView& film, Path& path, const Hit& hit,
                              ThreadCounters& counters) {
    if (shade(scene, path, hit, counters)) {
        return true;
    }
    pt::accumulate(film, path);
    counters.paths += 1;
    return false;
}

// Starts path i (path_of_number) and traces its first bounce; with a cursor the first sample is read from there.
PT_KERNEL(first_bounce, pt::cuda::FirstBounceParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore out, std::uint32_t* out_count,
           std::uint32_t pool, std::uint32_t first_sample, const std::uint32_t* cursor, HitCache cache, Totals* totals,
           SegmentCounts segments)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    const bool mine = i < pool;
    bool alive = false;
    Path path;
    if (mine) {
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        path = pt::cuda::path_of_number(scene.shade, i, first, cache);
        alive = bounce(scene, film, path, first_hit(scene, path, cache), counters);
    }
    put_path<true>(path, mine, alive, i, out, out_count);
    if constexpr (!appends) {
        if (i == 0) {
            *out_count = pool;
        }
    }
    pt::cuda::add_segment_counts(segments, 0, mine, pool);
    pt::cuda::add_shade_counters(totals, counters);
}

// Traces one bounce of the paths at order[0..*in_count-1] of `in` (no order: at 0..*in_count-1; where the kernel
// appends: as located).
PT_KERNEL(next_bounce, pt::cuda::NextBounceParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore in, const std::uint32_t* order,
           const std::uint32_t* in_count, PathStore out, std::uint32_t* out_count, SegmentNumber segment,
           Totals* totals, SegmentCounts segments)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    bool live = false;
    bool alive = false;
    Path path;
    std::uint32_t in_play, slot;
    if constexpr (appends) {
        in_count += segment.passed() * tuned::append_counters * counter_stride;
        out_count += segment.passed() * tuned::append_counters * counter_stride;
        const Located located = locate(in, in_count, i);
        in_play = located.total;
        slot = located.slot;
    } else {
        in_play = *in_count;
        slot = i < in_play ? pt::cuda::slot_at(order, i) : i;
    }
    if (i < in_play) {
        live = Paths(in).alive(slot);
        if (live) {
            path = load_path(Paths(in), slot, scene.shade);
            alive = bounce(scene, film, path, trace(scene, path), counters);
        }
    }
    put_path<false>(path, live, alive, slot, out, out_count);
    pt::cuda::add_segment_counts(segments, segment, live, in_play);
    pt::cuda::add_shade_counters(totals, counters);
}
