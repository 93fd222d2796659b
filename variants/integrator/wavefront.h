// The integrator wavefront on the CPU: all paths of a sample advance together: generate once, then intersect, (sort,)
// shade, (compact) for every bounce, each stage over the whole queue. The last possible segment is neither sorted nor
// compacted: every path ends there. Laine, Karras and Aila, "Megakernels Considered Harmful", HPG 2013; cis565.
#pragma once

#include <atomic>

#include "variants/cpu/parallel_for.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::integrator::wavefront {

inline std::string check_counters(const WorkCounters& work, std::uint64_t samples) {
    return work.bounces >= samples ? "" : "ran fewer bounces over the queue than samples";
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront",
    .summary = "separate generate, intersect and shade over a queue of all paths, one sample a pixel in flight",
    .origin = "Laine, Karras and Aila 2013; cis565",
    .baseline = on_cpu,
    .traits = IntegratorTraits{.has_queue = true, .seeds_by_position = true},
    .check_counters = check_counters,
};

inline constexpr std::size_t paths_per_chunk = 1024;

template <class Config, class Paths>
class Wavefront {
public:
    Wavefront(RenderJob& job, Paths& paths) : job_(job), queue_(*job.queue), paths_(paths) {}

    void render_sample(std::uint32_t sample) {
        generate_all(sample);
        for (std::uint32_t segment = 0; segment < job_.scene.longest_path() && queue_.count > 0; ++segment) {
            const std::uint64_t live = intersect_all(segment == 0, sample);
            if (live == 0) {
                break;
            }
            if (job_.stages != nullptr) {
                job_.stages->add_live(segment, live);
            }
            const bool last = segment + 1 == job_.scene.longest_path();
            job_.work.bounces += 1;
            job_.work.last_bounces += last ? 1u : 0u;
            job_.work.last_paths += last ? live : 0u;
            if (job_.sorting->is_active() && !last) {
                sort(live);
            }
            shade_all();
            if (job_.compaction->is_active() && !last) {
                compact();
            }
        }
        job_.work.paths += job_.scene.pixel_count();
        if (job_.cache != nullptr) {
            job_.cache->samples_seen += 1;
        }
    }

private:
    void generate_all(std::uint32_t sample) {
        const StageClock clock(job_.stages, "generate");
        queue_.count = job_.scene.pixel_count();
        queue_.indirect = false;
        const std::uint32_t camera_sample = job_.cache != nullptr ? sample % job_.cache->rays : sample;
        parallel_for(queue_.count, paths_per_chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                paths_.store(i, generate<Config>(job_.scene, static_cast<std::uint32_t>(i), sample, camera_sample));
            }
        });
    }

    // Traces the queue's rays. Returns how many paths were alive; each traced a ray or took its hit from the cache.
    std::uint64_t intersect_all(bool first, std::uint32_t sample) {
        const StageClock clock(job_.stages, "intersect");
        std::atomic<std::uint64_t> live = 0;
        const bool use_cache = first && job_.cache != nullptr;
        const bool filled = use_cache && job_.cache->has(job_.cache->samples_seen);
        parallel_for(queue_.count, paths_per_chunk, [&](std::size_t begin, std::size_t end) {
            std::uint64_t chunk_live = 0;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t slot = queue_.slot(i);
                if (!paths_.alive(slot)) {
                    continue;
                }
                chunk_live += 1;
                if (filled) {
                    queue_.hits[slot] = job_.cache->hits[job_.cache->index(paths_.pixel(slot), sample)];
                    continue;
                }
                Ray<float> ray = paths_.ray(slot);
                if constexpr (has<Config>(Feature::mesh)) {
                    ray.primitive = paths_.primitive(slot);
                }
                queue_.hits[slot] = closest_hit<Config>(job_.scene, ray);
                if (use_cache) {
                    job_.cache->hits[job_.cache->index(paths_.pixel(slot), sample)] = queue_.hits[slot];
                }
            }
            live += chunk_live;
        });
        job_.work.rays += filled ? 0 : live.load();
        job_.work.cache_hits += filled ? live.load() : 0;
        job_.work.cache_fills += use_cache && !filled ? live.load() : 0;
        return live;
    }

    // Sorts the queue by the hit's material; paths that left the scene come next, ended paths last.
    void sort(std::uint64_t live) {
        const StageClock clock(job_.stages, "sort");
        const std::uint32_t missed = job_.scene.materials.size;
        parallel_for(queue_.count, paths_per_chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t slot = queue_.slot(i);
                const SurfaceId side = queue_.hits[slot].side;
                queue_.keys[i] = !paths_.alive(slot) ? missed + 1
                                 : side.exists()     ? job_.scene.object_material[side.object()]
                                                     : missed;
            }
        });
        const std::size_t before = queue_.count;
        job_.sorting->sort(queue_, missed + 2);
        if (queue_.count != before) {
            throw std::runtime_error("the sort changed the count of paths in play from " + std::to_string(before) +
                                     " to " + std::to_string(queue_.count) + ", allowed: the same");
        }
        job_.work.sorts += 1;
        job_.work.sorted += live;
    }

    void shade_all() {
        const StageClock clock(job_.stages, "shade");
        std::atomic<std::uint64_t> rays = 0, connections = 0, unfinished = 0;
        parallel_for(queue_.count, paths_per_chunk, [&](std::size_t begin, std::size_t end) {
            PathCounters counters;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t slot = queue_.slot(i);
                if (!paths_.alive(slot)) {
                    continue;
                }
                Path<float> path = paths_.load(slot);
                // The random numbers of cis565 are seeded by where a path lies in the queue, not by its pixel.
                const std::uint32_t pixel = path.pixel;
                if (contains(sampler_of<Config>(job_.scene.seed), Feature::minstd)) {
                    path.pixel = static_cast<std::uint32_t>(i);
                }
                const bool alive = shade<Config>(job_.scene, job_.scene, path, queue_.hits[slot], counters);
                path.pixel = pixel;
                if (!alive) {
                    accumulate(job_.film, path);
                    path.segment = Path<float>::ended;
                }
                paths_.store(slot, path);
            }
            rays += counters.rays;
            connections += counters.connections;
            unfinished += counters.unfinished_walks;
        });
        job_.work.rays += rays;
        job_.work.connections += connections;
        job_.work.unfinished_walks += unfinished;
    }

    void compact() {
        const StageClock clock(job_.stages, "compact");
        const std::size_t before = queue_.count;
        job_.compaction->compact(queue_);
        check_count_after("compaction", before, queue_.count);
        job_.work.compactions += 1;
        job_.work.compacted_away += before - queue_.count;
    }

    RenderJob& job_;
    PathQueue& queue_;
    Paths& paths_;
};

template <class Config>
void render(RenderJob& job) {
    job.queue->reserve(job.scene.pixel_count());
    std::visit(
        [&](auto& paths) {
            Wavefront<Config, std::remove_reference_t<decltype(paths)>> wavefront(job, paths);
            for (std::uint32_t i = 0; i < job.samples; ++i) {
                wavefront.render_sample(job.first_sample + i);
            }
        },
        job.queue->paths);
}

}  // namespace pt::integrator::wavefront
