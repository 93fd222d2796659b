// Stage by stage over a queue of paths, a kernel each: generate, intersect, (sort), shade, (compact). The shape of
// cis565, and of Laine, Karras and Aila 2013, "Megakernels considered harmful".
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"
#include "variants/cuda/sort_keys.cuh"

// Moves a graph's first sample on.
extern "C" __global__ void advance(std::uint32_t* cursor, std::uint32_t samples) {
    if (threadIdx.x == 0) {
        *cursor += samples;
    }
}

// The slot of the path at position i; no order: slot i.
__device__ inline std::uint32_t slot_at(const std::uint32_t* order, std::uint32_t i) {
    return order != nullptr ? order[i] : i;
}

// Path i: pixel i mod pixels, sample first_sample + i / pixels; with a cursor the first sample is there.
extern "C" __global__ void PT_LAUNCH_BOUNDS generate_paths(Scene parameter, PathStore store, std::uint32_t* count,
                                                           std::uint32_t pool, std::uint32_t first_sample,
                                                           const std::uint32_t* cursor, HitCache cache) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = pool;
    }
    if (i < pool) {
        const std::uint32_t pixels = scene.shade.pixel_count();
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        Paths(store).put<carried_fields>(i, first_path(scene.shade, i % pixels, first + i / pixels, cache));
    }
}

// With `keys`, also writes the sort key of every position below `bound`: ended paths and positions beyond the count
// have the last one.
extern "C" __global__ void PT_LAUNCH_BOUNDS intersect_paths(Scene parameter, PathStore store,
                                                            const std::uint32_t* order, const std::uint32_t* count,
                                                            std::uint32_t bound, Hit* hits, HitCache cache,
                                                            SegmentNumber segment, SegmentCounts segments,
                                                            std::uint32_t* keys, std::uint32_t bits,
                                                            std::uint32_t last_key, pt::cuda::KeyBounds bounds) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t key = last_key;
    bool live = false;
    if (i < *count) {
        const std::uint32_t slot = slot_at(order, i);
        if (paths.alive(slot)) {
            live = true;
            const pt::Ray<Real> ray = paths.ray(slot);
            Hit hit;
            if (PT_CACHED && segment == 0) {
                hit = cache.hits[static_cast<std::size_t>(paths.pixel(slot)) * cache.rays +
                                 paths.sample(slot) % cache.rays];
            } else {
                hit = pt::closest_hit<Configuration>(scene.trace, ray);
            }
            hits[slot] = hit;
            if (keys != nullptr) {
                const std::uint32_t material =
                    hit.side.exists() ? scene.shade.object_material[hit.side.object()] : scene.shade.materials.size;
                key = (material << bits) | sort_key::rest(ray, hit, bounds);
            }
        }
    }
    if (keys != nullptr && i < bound) {
        keys[i] = key;
    }
    pt::cuda::add_segment_counts(segments, segment, live, *count);
}

// The key of a ray that is yet to be traced, by the same rules.
extern "C" __global__ void PT_LAUNCH_BOUNDS write_ray_keys(PathStore store, const std::uint32_t* order,
                                                           const std::uint32_t* count, std::uint32_t bound,
                                                           std::uint32_t* keys, std::uint32_t last_key,
                                                           pt::cuda::KeyBounds bounds) {
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < bound) {
        std::uint32_t key = last_key;
        const std::uint32_t slot = i < *count ? slot_at(order, i) : 0;
        if (i < *count && paths.alive(slot)) {
            key = sort_key::rest(paths.ray(slot), Hit(), bounds);
        }
        keys[i] = key;
    }
}

extern "C" __global__ void PT_LAUNCH_BOUNDS shade_paths(Scene parameter, FilmView film, PathStore store,
                                                        const std::uint32_t* order, const std::uint32_t* count,
                                                        const Hit* hits, Totals* totals) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < *count) {
        const std::uint32_t slot = slot_at(order, i);
        if (paths.alive(slot)) {
            Path path = load_path(paths, slot, scene.shade);
            // The generator of cis565 is seeded by where a path lies in the queue, not by whose it is.
            const std::uint32_t pixel = path.pixel;
            if (contains(pt::sampler_of<Configuration>(scene.shade.seed), pt::Feature::minstd)) {
                path.pixel = i;
            }
            const bool alive = shade(scene, path, hits[slot], counters);
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

#else

#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront",
    .summary = "a kernel a stage over a queue of paths: generate, intersect, shade",
    .origin = "Laine, Karras and Aila 2013; cis565",
    .baseline = on_cuda,
    .traits = IntegratorTraits{.has_queue = true, .can_loop = true, .seeds_by_position = true},
    .backends = on_cuda,
    .tunables = wavefront_tunables,
    .check_counters = wavefront_work_missing,
};

// One batch: every path of it from its camera ray to its end.
class Batch {
public:
    explicit Batch(Job& job) : job_(job), queue_(job.queue) {}

    void enqueue(std::uint32_t first_sample, std::uint32_t samples) {
        queue_.bound = job_.pixels * samples;
        {
            const Stage stage(job_.stages, "generate", job_.stream);
            job_.launch("generate_paths", queue_.bound, job_.scene, queue_.paths, queue_.count, queue_.bound,
                        first_sample, job_.cursor, job_.cache);
        }
        enqueue_segment(0);
        for (std::uint32_t segment = 1 + enqueue_loop(job_, [&] { return enqueue_round(); });
             segment < job_.longest_path && queue_.bound > 0; ++segment) {
            EndOfPaths end(job_, segment);
            enqueue_segment(segment);
            if (end.is_reached()) {
                break;
            }
        }
    }

private:
    LiveCounts enqueue_round() {
        const Queue before = queue_;
        enqueue_segment(1);
        enqueue_segment(2);
        check_round_trip(before, queue_);
        return {.counts = queue_.count};
    }

    void enqueue_segment(std::uint32_t segment) {
        const bool last = segment + 1 == job_.longest_path;
        const bool sorts = job_.sorting != nullptr && !last;
        const bool by_hit = job_.sort_key.has_material;
        if (sorts && !by_hit) {
            const Stage stage(job_.stages, "sort", job_.stream);
            job_.launch("write_ray_keys", queue_.bound, queue_.paths, order(), queue_.count, queue_.bound, queue_.keys,
                        last_key(), job_.key_bounds);
            sort();
        }
        {
            const Stage stage(job_.stages, "intersect", job_.stream);
            std::uint32_t* const keys = sorts && by_hit ? queue_.keys : nullptr;
            job_.launch("intersect_paths", queue_.bound, job_.scene, queue_.paths, order(), queue_.count, queue_.bound,
                        queue_.hits, job_.cache, job_.segment(segment), job_.segments, keys, job_.sort_key.bits,
                        last_key(), job_.key_bounds);
        }
        if (sorts && by_hit) {
            const Stage stage(job_.stages, "sort", job_.stream);
            sort();
        }
        shade(sorts && by_hit);
        job_.work.bounces += 1;
        job_.work.last_bounces += last ? 1u : 0u;
        if (job_.compaction != nullptr && !last) {
            compact(job_, queue_);
        }
    }

    // One material more than the scene has: "missed".
    std::uint32_t last_key() const {
        return (job_.sort_key.has_material ? job_.materials + 1 : 1) << job_.sort_key.bits;
    }

    void sort() {
        job_.sorting->sort(queue_, last_key() + 1);
        job_.work.sorts += 1;
    }

    void shade(bool sorted) {
        const Stage stage(job_.stages, "shade", job_.stream);
        std::vector<ShadeRange> ranges = sorted ? job_.sorting->shade_ranges() : std::vector<ShadeRange>();
        if (ranges.empty()) {
            ranges.push_back({order(), queue_.count});
        }
        for (const ShadeRange& range : ranges) {
            job_.launch("shade_paths", queue_.bound, job_.scene, job_.film, queue_.paths, range.order, range.count,
                        queue_.hits, job_.totals);
        }
    }

    const std::uint32_t* order() const { return queue_.indirect ? queue_.order : nullptr; }

    Job& job_;
    Queue queue_;
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

inline const Integrator hook{
    .render = render,
    .prepare = prepare,
    .kernels = {"generate_paths", "intersect_paths", "shade_paths"},
    .stores_hits = true,
};

}  // namespace pt::cuda::integrator::wavefront

#endif
