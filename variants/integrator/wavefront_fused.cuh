// One kernel a bounce over a queue of paths: each thread traces and shades one segment of one path, and with
// compaction=atomic_append or block_scan_append puts the path, if it lives, into the next bounce's queue itself. The
// first bounce makes its camera ray in the same kernel.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/append.cuh"

// PT_APPEND: 0 paths stay in their slots, 1 warp-aggregated append, 2 block-scan append.
//
// An append to one counter waits for all others: a GPU does a few hundred million atomic operations a second on one
// address. So the queue is in PT_COUNTERS parts, each with a counter of its own; block b appends to part b mod
// PT_COUNTERS, which therefore never holds more than its share of the blocks.
constexpr std::uint32_t counter_stride = 32;  // words: counters lie in different cache lines

__device__ inline std::uint32_t part_capacity(const PathStore& store) { return store.capacity / PT_COUNTERS; }

#if PT_APPEND > 0
// Where the queue's paths lie: the total and, for the position of the calling thread, the slot. Every thread of the
// block must call it.
struct Located {
    std::uint32_t total, slot;
};
__device__ inline Located locate(const PathStore& store, const std::uint32_t* counts, std::uint32_t position) {
    __shared__ std::uint32_t part_count[PT_COUNTERS];
    for (std::uint32_t part = threadIdx.x; part < PT_COUNTERS; part += PT_BLOCK) {
        part_count[part] = counts[part * counter_stride];
    }
    __syncthreads();
    Located located{0, 0};
    for (std::uint32_t part = 0; part < PT_COUNTERS; ++part) {
        const std::uint32_t before = located.total;
        located.total += part_count[part];
        if (position >= before && position < located.total) {
            located.slot = part * part_capacity(store) + (position - before);
        }
    }
    return located;
}
#endif

// Puts a path where the next bounce finds it. `is_new`: nothing of it lies in its slot yet. Every thread of the block
// must call it.
template <bool is_new>
__device__ inline void put_path(const Path& path, bool shaded, bool alive, std::uint32_t slot, const PathStore& out,
                                std::uint32_t* out_count) {
    const Paths paths(out);
#if PT_APPEND > 0
    const std::uint32_t part = blockIdx.x % PT_COUNTERS;
    std::uint32_t* const count = out_count + part * counter_stride;
#if PT_APPEND == 1
    const std::uint32_t position = pt::cuda::append_by_warp(count, alive);
#else
    const std::uint32_t position = pt::cuda::append_by_block(count, alive);
#endif
    if (alive) {
        paths.put<carried_fields>(part * part_capacity(out) + position, path);
    }
#else
    if (alive && is_new) {
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
#endif
}

// Traces and shades one segment; accumulates a path that ends. Returns whether it lives.
__device__ inline bool bounce(const SceneViews& scene, const FilmView& film, Path& path, const Hit& hit,
                              PathCounters& counters) {
    if (shade(scene, path, hit, counters)) {
        return true;
    }
    pt::accumulate(film, path);
    counters.paths += 1;
    return false;
}

// Moves a graph's first sample on.
extern "C" __global__ void advance(std::uint32_t* cursor, std::uint32_t samples) {
    if (threadIdx.x == 0) {
        *cursor += samples;
    }
}

// Path i: pixel i mod pixels, sample first_sample + i / pixels; with a cursor the first sample is there.
extern "C" __global__ void PT_LAUNCH_BOUNDS first_bounce(Scene parameter, FilmView film, PathStore out,
                                                         std::uint32_t* out_count, std::uint32_t pool,
                                                         std::uint32_t first_sample, const std::uint32_t* cursor,
                                                         HitCache cache, Totals* totals, SegmentCounts segments) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    const bool mine = i < pool;
    bool alive = false;
    Path path;
    if (mine) {
        const std::uint32_t pixels = scene.shade.pixel_count();
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        path = first_path(scene.shade, i % pixels, first + i / pixels, cache);
        alive = bounce(scene, film, path, first_hit(scene, path, cache), counters);
    }
    put_path<true>(path, mine, alive, i, out, out_count);
#if PT_APPEND == 0
    if (i == 0) {
        *out_count = pool;
    }
#endif
    pt::cuda::add_segment_counts(segments, 0, mine, pool);
    pt::cuda::add_shade_counters(totals, counters);
}

// One bounce of the paths at order[0..*in_count-1] of `in` (no order: at 0..*in_count-1; PT_APPEND: as located).
extern "C" __global__ void PT_LAUNCH_BOUNDS next_bounce(Scene parameter, FilmView film, PathStore in,
                                                        const std::uint32_t* order, const std::uint32_t* in_count,
                                                        PathStore out, std::uint32_t* out_count, SegmentNumber segment,
                                                        Totals* totals, SegmentCounts segments) {
    const SceneViews scene(parameter);
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    bool live = false;
    bool alive = false;
    Path path;
#if PT_APPEND > 0
    in_count += segment.passed() * PT_COUNTERS * counter_stride;
    out_count += segment.passed() * PT_COUNTERS * counter_stride;
    const Located located = locate(in, in_count, i);
    const std::uint32_t in_play = located.total;
    const std::uint32_t slot = located.slot;
#else
    const std::uint32_t in_play = *in_count;
    const std::uint32_t slot = i < in_play && order != nullptr ? order[i] : i;
#endif
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

#else

#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront_fused {

inline constexpr Tunable tunables[] = {
    wavefront_tunables[0],
    wavefront_tunables[1],
    wavefront_tunables[2],
    wavefront_tunables[3],
    wavefront_tunables[4],
    {"append_counters", 16, 1, 64, 1, "parts of the queue, with a counter each, where the kernel appends"}};

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront_fused",
    .summary = "one kernel a bounce over a queue of paths; appending compactions are part of it",
    .origin = "pbrt-v4's and Cycles' queues, taken to one kernel",
    .traits = IntegratorTraits{.has_queue = true, .can_loop = true, .appends_in_kernel = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        if (!variant.sorting.sorts) {
            return {};
        }
        return {"no_point_to_sort",
                "intersects and shades in one kernel, there is no point at which to sort: needs sorting=none, not " +
                    std::string(variant.sorting.name)};
    },
    .check_counters = wavefront_work_missing,
};

// In words, the stride between counters included (counter_stride).
inline std::size_t counters_per_segment(const Job& job) { return std::size_t{job.append_counters} * 32; }
inline std::size_t append_count_bytes(const Job& job) {
    return counters_per_segment(job) * job.longest_path * sizeof(std::uint32_t);
}

class Batch {
public:
    explicit Batch(Job& job) : job_(job), queue_(job.queue), appends_(job.appends_in_kernel) {}

    void enqueue(std::uint32_t first_sample, std::uint32_t samples) {
        queue_.bound = job_.pixels * samples;
        if (appends_) {
            // Counters for every segment, all cleared at once: clearing between two bounces would cost a gap each time.
            PT_CUDA_CHECK(cudaMemsetAsync(job_.append_counts, 0, append_count_bytes(job_), job_.stream));
            queue_.count = counts_after(0);
        }
        {
            const Stage stage(job_.stages, "first bounce", job_.stream);
            job_.launch("first_bounce", queue_.bound, job_.scene, job_.film, queue_.paths, queue_.count, queue_.bound,
                        first_sample, job_.cursor, job_.cache, job_.totals, job_.segments);
        }
        ended(0);
        const std::uint32_t looped = enqueue_loop(job_, [&] { return enqueue_round(); });
        if (appends_) {
            queue_.count = counts_after(looped);
        }
        for (std::uint32_t segment = 1 + looped; segment < job_.longest_path && queue_.bound > 0; ++segment) {
            EndOfPaths end(job_, segment);
            enqueue_segment(segment);
            ended(segment);
            if (end.is_reached()) {
                break;
            }
        }
    }

private:
    // Where the paths that live after a segment are counted.
    std::uint32_t* counts_after(std::uint32_t segment) const {
        return job_.append_counts + std::size_t{segment} * counters_per_segment(job_);
    }

    LiveCounts enqueue_round() {
        Queue before = queue_;
        for (const std::uint32_t segment : {1u, 2u}) {
            enqueue_segment(segment);
            ended(segment);
        }
        const std::uint32_t* const counts = queue_.count;
        if (!appends_) {
            check_round_trip(before, queue_);
            return {.counts = counts};
        }
        queue_.count = before.count;
        check_round_trip(before, queue_);
        return {counts, job_.append_counters, 32, static_cast<std::uint32_t>(counters_per_segment(job_))};
    }

    void enqueue_segment(std::uint32_t segment) {
        const PathStore out = appends_ ? queue_.spare : queue_.paths;
        std::uint32_t* const out_count = appends_ ? counts_after(segment) : queue_.count;
        {
            const Stage stage(job_.stages, "bounce", job_.stream);
            job_.launch("next_bounce", queue_.bound, job_.scene, job_.film, queue_.paths,
                        queue_.indirect ? queue_.order : nullptr, queue_.count, out, out_count, job_.segment(segment),
                        job_.totals, job_.segments);
        }
        if (appends_) {
            queue_.swap_paths();
            queue_.count = out_count;
        }
    }

    // After a segment: counts it, and compacts where the kernel did not.
    void ended(std::uint32_t segment) {
        const bool last = segment + 1 == job_.longest_path;
        job_.work.bounces += 1;
        job_.work.last_bounces += last ? 1u : 0u;
        if (job_.compaction != nullptr && !last) {
            compact(job_, queue_);
        }
    }

    Job& job_;
    Queue queue_;
    bool appends_;
};

inline void enqueue_batch(Job& job, std::uint32_t first_sample, std::uint32_t samples) {
    Batch(job).enqueue(first_sample, samples);
}

inline void prepare(Job& job) {
    prepare_batches(
        job, [&](std::uint32_t first_sample, std::uint32_t samples) { enqueue_batch(job, first_sample, samples); });
}

inline void render(Job& job) {
    run_batches(job,
                [&](std::uint32_t first_sample, std::uint32_t samples) { enqueue_batch(job, first_sample, samples); });
}

inline std::vector<std::string> defines(const Variant& variant) {
    const AppendInKernel append = traits_of(variant, Backend::cuda).compaction.append_in_kernel;
    return {"-DPT_APPEND=" + std::to_string(static_cast<int>(append)),
            "-DPT_COUNTERS=" + std::to_string(tunable(variant, "append_counters", Backend::cuda))};
}

inline const Integrator hook{
    .render = render,
    .prepare = prepare,
    .defines = defines,
    .kernels = {"first_bounce", "next_bounce"},
};

}  // namespace pt::cuda::integrator::wavefront_fused

#endif
