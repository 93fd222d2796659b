// Stage by stage over a queue of paths, a kernel each: generate, intersect, (sort), shade, (compact). The shape of both
// seeds, and of Laine, Karras and Aila 2013, "Megakernels considered harmful".
#pragma once

#if defined(__CUDACC_RTC__)

#include "variants/cuda/device.cuh"
#include "variants/cuda/sort_keys.cuh"

// The slot of the path at position i; no order: slot i.
__device__ inline std::uint32_t slot_at(const std::uint32_t* order, std::uint32_t i) {
    return order != nullptr ? order[i] : i;
}

// Path i: pixel i mod pixels, sample first_sample + i / pixels.
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    generate_paths(Scene scene, PathStore store, std::uint32_t* count, std::uint32_t pool, std::uint32_t first_sample,
                   HitCache cache) {
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = pool;
    }
    if (i < pool) {
        const std::uint32_t pixels = scene.pixel_count();
        Paths(store).store(i, first_path(scene, i % pixels, first_sample + i / pixels, cache));
    }
}

extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    intersect_paths(Scene scene, PathStore store, const std::uint32_t* order, const std::uint32_t* count, Hit* hits,
                    HitCache cache, std::uint32_t segment, SegmentCounts segments) {
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t live = 0;
    if (i < *count) {
        const std::uint32_t slot = slot_at(order, i);
        if (paths.alive(slot)) {
            live = 1;
            if (PT_CACHED && segment == 0) {
                hits[slot] = cache.hits[static_cast<std::size_t>(paths.pixel(slot)) * cache.rays +
                                        paths.sample(slot) % cache.rays];
            } else {
                hits[slot] = pt::closest_hit<Configuration>(scene, paths.ray(slot));
            }
        }
    }
    if (i == 0) {
        pt::atomic_add(&segments.in_play[segment], static_cast<std::uint64_t>(*count));
    }
    const std::uint32_t values[] = {live};
    std::uint64_t* const sums[] = {&segments.live[segment]};
    pt::cuda::add_over_block(values, sums);
}

// A key for every position below `bound`: those beyond the count, and ended paths, have the last.
extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    write_keys(Scene scene, PathStore store, const std::uint32_t* order, const std::uint32_t* count,
               std::uint32_t bound, const Hit* hits, std::uint32_t* keys, std::uint32_t bits,
               std::uint32_t last_key, pt::cuda::KeyBounds bounds, Totals* totals) {
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t sorted = 0;
    if (i < bound) {
        std::uint32_t key = last_key;
        const std::uint32_t slot = i < *count ? slot_at(order, i) : 0;
        if (i < *count && paths.alive(slot)) {
            Hit hit;
            std::uint32_t material = 0;
            if (sort_key::has_material) {
                hit = hits[slot];
                material = hit.side.exists() ? scene.object_material[hit.side.object()] : scene.materials.size;
            }
            key = (material << bits) | sort_key::rest(paths.ray(slot), hit, bounds);
            sorted = 1;
        }
        keys[i] = key;
    }
    const std::uint32_t values[] = {sorted};
    std::uint64_t* const sums[] = {&totals->sorted};
    pt::cuda::add_over_block(values, sums);
}

extern "C" __global__ void __launch_bounds__(PT_BLOCK)
    shade_paths(Scene scene, FilmView film, PathStore store, const std::uint32_t* order, const std::uint32_t* count,
                const Hit* hits, Totals* totals) {
    const Paths paths(store);
    PathCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < *count) {
        const std::uint32_t slot = slot_at(order, i);
        if (paths.alive(slot)) {
            Path path = paths.load(slot);
            if (!shade(scene, path, hits[slot], counters)) {
                pt::accumulate(film, path);
                counters.paths += 1;
                path.segment = Path::ended;
            }
            paths.store(slot, path);
        }
    }
    pt::cuda::add_counters(totals, counters, 0);
}

#else

#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront {

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront",
    .summary = "a kernel a stage over a queue of paths: generate, intersect, shade",
    .origin = "Laine, Karras and Aila 2013; both seeds",
    .baseline = on_cuda,
    .backends = on_cuda,
    .tunables = wavefront_tunables,
    .work_missing = wavefront_work_missing,
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
                        first_sample, job_.cache);
        }
        for (std::uint32_t segment = 0; segment < job_.longest_path && queue_.bound > 0; ++segment) {
            enqueue_segment(segment);
        }
    }

private:
    void enqueue_segment(std::uint32_t segment) {
        const bool last = segment + 1 == job_.longest_path;
        const bool sorts = job_.sorting != nullptr && !last;
        if (sorts && !job_.sort_key.has_material) {
            sort();
        }
        {
            const Stage stage(job_.stages, "intersect", job_.stream);
            job_.launch("intersect_paths", queue_.bound, job_.scene, queue_.paths, order(), queue_.count, queue_.hits,
                        job_.cache, segment, job_.segments);
        }
        if (sorts && job_.sort_key.has_material) {
            sort();
        }
        shade(sorts && job_.sort_key.has_material);
        job_.work.bounces += 1;
        job_.work.last_bounces += last ? 1u : 0u;
        if (job_.compaction != nullptr && !last) {
            compact(job_, queue_);
        }
    }

    void sort() {
        const Stage stage(job_.stages, "sort", job_.stream);
        const std::uint32_t materials = job_.sort_key.has_material ? job_.materials + 1 : 1;  // one for "missed"
        const std::uint32_t last_key = materials << job_.sort_key.bits;
        job_.launch("write_keys", queue_.bound, job_.scene, queue_.paths, order(), queue_.count, queue_.bound,
                    queue_.hits, queue_.keys, job_.sort_key.bits, last_key, job_.key_bounds, job_.totals);
        job_.sorting->sort(queue_, last_key + 1);
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
    prepare_batches(job, "generate_paths", 4, [&](std::uint32_t first_sample, std::uint32_t samples) {
        enqueue_batch(job, first_sample, samples);
    });
}

inline void render(Job& job) {
    run_batches(job, [&](std::uint32_t first_sample, std::uint32_t samples) {
        enqueue_batch(job, first_sample, samples);
    });
}

inline const Integrator hook{.render = render, .prepare = prepare, .has_queue = true, .stores_hits = true};

}  // namespace pt::cuda::integrator::wavefront

#endif
