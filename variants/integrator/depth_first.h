// The integrator depth_first: one path at a time from the camera to its end, all its state in registers. It is the
// CPU's best shape and the plainest, so its generic kernel is the reference that every bitwise claim is held against.
#pragma once

#include <atomic>

#include "kernels/path_tree.h"
#include "variants/cpu/parallel_for.h"
#include "variants/no_queue.h"
#include "variants/registry.h"

namespace pt::integrator::depth_first {

inline Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    return needs_no_queue(variant, "keeps one path in registers");
}

inline std::string check_counters(const WorkCounters& work, std::uint64_t) {
    return work.bounces == 0 ? "" : "ran a queue";
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "depth_first",
    .summary = "a path at a time, state in registers (the megakernel's loop on a CPU core)",
    .origin = "Kajiya 1986",
    .reference = on_cpu,
    .traits = IntegratorTraits{.sums_in_order = true, .keeps_branches = true},
    .unsupported_reason = unsupported_reason,
    .check_counters = check_counters,
};

inline constexpr KernelSets kernel_sets{
    .in_double = true,
    .with_path_trees = true,
};

inline constexpr std::size_t pixels_per_chunk = 64;

// Traces one path that may split, from its first hit on; returns the number of segments up to the longest branch's end.
template <class Config>
std::uint32_t trace_tree(const SceneView<typename Config::Real>& scene, const FilmView& film, PixelSum<Config>& sum,
                         Path<typename Config::Real>& path, Hit<typename Config::Real> hit, PathCounters& counters) {
    PathTree<Config> tree;
    for (bool has_branch = true; has_branch; has_branch = tree.take_next(path)) {
        hit = tree.resumes() ? tree.hit() : hit;
        while (shade_in_tree<Config>(scene, scene, path, hit, counters, tree)) {
            hit = intersect<Config>(scene, path);
        }
    }
    sum.add(film, path.radiance);
    counters.rays += tree.rays();
    return tree.longest();
}

// Traces one path to its end and returns its number of segments. With a first-hit cache, the camera ray is one of those
// kept, and its hit comes from the cache unless this path is the one that fills it.
template <class Config>
std::uint32_t trace(const SceneView<typename Config::Real>& scene, const FilmView& film, PixelSum<Config>& sum,
                    std::uint32_t pixel, std::uint32_t sample, FirstBounceCache<typename Config::Real>* cache,
                    bool cache_has_it, PathCounters& counters) {
    using Real = typename Config::Real;
    const std::uint32_t camera_sample = cache != nullptr ? sample % cache->rays : sample;
    auto path = generate<Config>(scene, pixel, sample, camera_sample);
    Hit<Real> hit = cache_has_it ? cache->hits[cache->index(pixel, sample)] : intersect<Config>(scene, path);
    if (cache != nullptr && !cache_has_it) {
        cache->hits[cache->index(pixel, sample)] = hit;
    }
    counters.paths += 1;
    if constexpr (has<Config>(Feature::splitting)) {
        return trace_tree<Config>(scene, film, sum, path, hit, counters);
    }
    while (shade<Config>(scene, scene, path, hit, counters)) {
        hit = intersect<Config>(scene, path);
    }
    sum.add(film, path.radiance);
    counters.rays += path.segment;
    return path.segment;
}

template <class Config>
void render(RenderJobIn<typename Config::Real>& job) {
    std::atomic<std::uint64_t> rays = 0, paths = 0, connections = 0, unfinished = 0, fills = 0, hits = 0;
    std::vector<std::atomic<std::uint64_t>> ended_after(job.stages != nullptr ? job.scene.longest_path() + 1 : 0);
    FirstBounceCache<typename Config::Real>* const cache = job.cache;
    {
        const StageClock clock(job.stages, "trace");
        parallel_for(job.scene.pixel_count(), pixels_per_chunk, [&](std::size_t begin, std::size_t end) {
            PathCounters counters;
            std::uint64_t chunk_fills = 0;
            for (std::size_t pixel = begin; pixel < end; ++pixel) {
                PixelSum<Config> sum;
                for (std::uint32_t i = 0; i < job.samples; ++i) {
                    const bool has_it = cache != nullptr && cache->has(cache->samples_seen + i);
                    chunk_fills += has_it ? 0u : 1u;
                    const std::uint32_t length =
                        trace<Config>(job.scene, job.film, sum, static_cast<std::uint32_t>(pixel), job.first_sample + i,
                                      cache, has_it, counters);
                    if (!ended_after.empty()) {
                        ended_after[length].fetch_add(1, std::memory_order_relaxed);
                    }
                }
                sum.finish(job.film, static_cast<std::uint32_t>(pixel));
            }
            rays += counters.rays;
            paths += counters.paths;
            connections += counters.connections;
            unfinished += counters.unfinished_walks;
            if (cache != nullptr) {
                fills += chunk_fills;
                hits += counters.paths - chunk_fills;
            }
        });
    }
    if (cache != nullptr) {
        cache->samples_seen += job.samples;
    }
    job.work.rays += rays - hits;
    job.work.connections += connections;
    job.work.paths += paths;
    job.work.unfinished_walks += unfinished;
    job.work.cache_fills += fills;
    job.work.cache_hits += hits;
    if (job.stages != nullptr) {
        std::uint64_t live = paths;
        for (std::uint32_t segment = 0; segment < job.scene.longest_path(); ++segment) {
            job.stages->add_live(segment, live);
            live -= ended_after[segment + 1];
        }
    }
}

}  // namespace pt::integrator::depth_first
