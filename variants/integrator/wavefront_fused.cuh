// One kernel a bounce over a queue of paths: each thread traces and shades one segment of one path, and with
// compaction=atomic_append or block_scan_append puts the path, if it lives, into the next bounce's queue itself. The
// first bounce makes its camera ray in the same kernel.
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/append.cuh"

// PT_APPEND: 0 paths stay in their slots, 1 warp-aggregated append, 2 block-scan append.
// Puts a path that was shaded where the next bounce finds it. Every thread of the block must call it.
__device__ inline void put_path(const Path& path, bool shaded, bool alive, std::uint32_t slot, const PathStore& out,
                                std::uint32_t* out_count) {
#if PT_APPEND == 1
    const std::uint32_t position = pt::cuda::append_by_warp(out_count, alive);
#elif PT_APPEND == 2
    const std::uint32_t position = pt::cuda::append_by_block(out_count, alive);
#else
    const std::uint32_t position = slot;
    alive = shaded;  // an ended path is marked in place
#endif
    if (alive) {
        Paths(out).store(position, path);
    }
}

// Traces and shades one segment; marks and accumulates a path that ends. Returns whether it lives.
__device__ inline bool bounce(const Scene& scene, const FilmView& film, Path& path, const Hit& hit,
                              PathCounters& counters) {
    if (shade(scene, path, hit, counters)) {
        return true;
    }
    pt::accumulate(film, path);
    counters.paths += 1;
    path.segment = Path::ended;
    return false;
}

__device__ inline void count_segment(Totals* totals, const PathCounters& counters, bool live, std::uint32_t segment,
                                     std::uint32_t in_play, const SegmentCounts& segments) {
    if (pt::cuda::thread_number() == 0) {
        pt::atomic_add(&segments.in_play[segment], static_cast<std::uint64_t>(in_play));
    }
    const std::uint32_t values[] = {live ? 1u : 0u, static_cast<std::uint32_t>(counters.paths)};
    std::uint64_t* const sums[] = {&segments.live[segment], &totals->paths.paths};
    pt::cuda::add_over_block(values, sums);
    if constexpr (pt::has<Configuration>(pt::Feature::final_bounce) ||
                  pt::has<Configuration>(pt::Feature::subsurface)) {
        const std::uint32_t rare[] = {static_cast<std::uint32_t>(counters.connections),
                                      static_cast<std::uint32_t>(counters.unfinished_walks)};
        std::uint64_t* const rare_sums[] = {&totals->paths.connections, &totals->paths.unfinished_walks};
        pt::cuda::add_over_block(rare, rare_sums);
    }
}

// Path i: pixel i mod pixels, sample first_sample + i / pixels.
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    first_bounce(Scene scene, FilmView film, PathStore out, std::uint32_t* out_count, std::uint32_t pool,
                 std::uint32_t first_sample, HitCache cache, Totals* totals, SegmentCounts segments) {
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    const bool mine = i < pool;
    bool alive = false;
    Path path;
    if (mine) {
        const std::uint32_t pixels = scene.pixel_count();
        path = first_path(scene, i % pixels, first_sample + i / pixels, cache);
        alive = bounce(scene, film, path, first_hit(scene, path, cache), counters);
    }
    put_path(path, mine, alive, i, out, out_count);
#if PT_APPEND == 0
    if (i == 0) {
        *out_count = pool;
    }
#endif
    count_segment(totals, counters, mine, 0, pool, segments);
}

// One bounce of the paths at order[0..*in_count-1] of `in` (no order: at 0..*in_count-1).
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    next_bounce(Scene scene, FilmView film, PathStore in, const std::uint32_t* order, const std::uint32_t* in_count,
                PathStore out, std::uint32_t* out_count, std::uint32_t segment, Totals* totals,
                SegmentCounts segments) {
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    bool live = false;
    bool alive = false;
    Path path;
    std::uint32_t slot = i;
    if (i < *in_count) {
        slot = order != nullptr ? order[i] : i;
        live = Paths(in).alive(slot);
        if (live) {
            path = Paths(in).load(slot);
            alive = bounce(scene, film, path, pt::intersect<Configuration>(scene, path), counters);
        }
    }
    put_path(path, live, alive, slot, out, out_count);
    count_segment(totals, counters, live, segment, *in_count, segments);
}

#else

#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront_fused {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront_fused",
    .summary = "one kernel a bounce over a queue of paths; appending compactions are part of it",
    .origin = "pbrt-v4's and Cycles' queues, taken to one kernel",
    .backends = on_cuda,
    .tunables = wavefront_tunables,
    .does_not_apply = [](FeatureSet, const Variant& variant) -> std::string {
        return variant["sorting"] == "none"
                   ? ""
                   : "intersects and shades in one kernel, there is no point at which to sort: needs sorting=none, not " +
                         variant["sorting"];
    },
    .work_missing = wavefront_work_missing,
};

// How the kernel itself compacts; 0: not, a compaction comes after it.
inline int append_in_kernel(const Variant& variant) {
    return variant["compaction"] == "atomic_append" ? 1 : variant["compaction"] == "block_scan_append" ? 2 : 0;
}

class Batch {
public:
    explicit Batch(Job& job) : job_(job), queue_(job.queue), appends_(job.appends_in_kernel) {}

    void enqueue(std::uint32_t first_sample, std::uint32_t samples) {
        queue_.bound = job_.pixels * samples;
        if (appends_) {
            clear(queue_.count);
        }
        {
            const Stage stage(job_.stages, "first bounce", job_.stream);
            job_.launch("first_bounce", queue_.bound, job_.scene, job_.film, queue_.paths, queue_.count, queue_.bound,
                        first_sample, job_.cache, job_.totals, job_.segments);
        }
        ended(0);
        for (std::uint32_t segment = 1; segment < job_.longest_path && queue_.bound > 0; ++segment) {
            enqueue_segment(segment);
            ended(segment);
        }
    }

private:
    void enqueue_segment(std::uint32_t segment) {
        const PathStore out = appends_ ? queue_.spare : queue_.paths;
        std::uint32_t* const out_count = appends_ ? queue_.count_spare : queue_.count;
        if (appends_) {
            clear(out_count);
        }
        {
            const Stage stage(job_.stages, "bounce", job_.stream);
            job_.launch("next_bounce", queue_.bound, job_.scene, job_.film, queue_.paths,
                        queue_.indirect ? queue_.order : nullptr, queue_.count, out, out_count, segment, job_.totals,
                        job_.segments);
        }
        if (appends_) {
            queue_.swap_paths();
            queue_.swap_count();
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

    void clear(std::uint32_t* count) {
        PT_CUDA_CHECK(cudaMemsetAsync(count, 0, sizeof(std::uint32_t), job_.stream));
    }

    Job& job_;
    Queue queue_;
    bool appends_;
};

inline void enqueue_batch(Job& job, std::uint32_t first_sample, std::uint32_t samples) {
    Batch(job).enqueue(first_sample, samples);
}

inline void prepare(Job& job) {
    prepare_batches(job, "first_bounce", 5, [&](std::uint32_t first_sample, std::uint32_t samples) {
        enqueue_batch(job, first_sample, samples);
    });
}

inline void render(Job& job) {
    run_batches(job, [&](std::uint32_t first_sample, std::uint32_t samples) {
        enqueue_batch(job, first_sample, samples);
    });
}

inline std::vector<std::string> defines(const Variant& variant) {
    return {"-DPT_APPEND=" + std::to_string(append_in_kernel(variant))};
}

inline const Integrator hook{
    .render = render,
    .prepare = prepare,
    .defines = defines,
    .has_queue = true,
    .appends_in_kernel = [](const Variant& variant) { return append_in_kernel(variant) != 0; },
};

}  // namespace pt::cuda::integrator::wavefront_fused

#endif
