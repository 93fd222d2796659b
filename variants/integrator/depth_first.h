// One path at a time from the camera to its end, all its state in registers: the CPU's own best shape, and the plainest
// one, so its generic kernel is the reference that every bitwise claim is held against.
#pragma once

#include <atomic>

#include "variants/cpu/parallel_for.h"
#include "variants/registry.h"

namespace pt::integrator::depth_first {

inline std::string does_not_apply(FeatureSet, const Variant& variant) {
    if (variant["compaction"] != "none") {
        return "has no queue to compact: needs compaction=none, not " + variant["compaction"];
    }
    if (variant["sorting"] != "none") {
        return "has no queue to sort: needs sorting=none, not " + variant["sorting"];
    }
    if (variant["layout"] != "aos") {
        return "keeps one path in registers, no array of paths: needs layout=aos, not " + variant["layout"];
    }
    return "";
}

inline std::string work_missing(const WorkCounters& work, std::uint64_t) {
    return work.bounces == 0 ? "" : "ran a queue";
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "depth_first",
    .summary = "a path at a time, state in registers (the megakernel's loop on a CPU core)",
    .origin = "Kajiya 1986",
    .reference = true,
    .does_not_apply = does_not_apply,
    .work_missing = work_missing,
};

inline constexpr std::size_t pixels_a_chunk = 64;

// The first segment's hit: from the cache where there is one and it is filled.
template <class Config>
Hit<typename Config::Real> first_hit(const SceneView<typename Config::Real>& scene,
                                     const Path<typename Config::Real>& path,
                                     std::vector<Hit<typename Config::Real>>* cache, bool filled) {
    if (cache == nullptr) {
        return intersect<Config>(scene, path);
    }
    if (!filled) {
        (*cache)[path.pixel] = intersect<Config>(scene, path);
    }
    return (*cache)[path.pixel];
}

// Traces one path to its end and returns the number of segments it had.
template <class Config>
std::uint32_t trace(const SceneView<typename Config::Real>& scene, const FilmView& film, std::uint32_t pixel,
                    std::uint32_t sample, std::vector<Hit<typename Config::Real>>* cache, bool cache_filled,
                    PathCounters& counters) {
    auto path = generate<Config>(scene, pixel, sample);
    auto hit = first_hit<Config>(scene, path, cache, cache_filled);
    while (shade<Config>(scene, path, hit, counters)) {
        hit = intersect<Config>(scene, path);
    }
    accumulate(film, path);
    counters.paths += 1;
    counters.rays += path.segment;
    return path.segment;
}

template <class Config>
void render(RenderJob& job) {
    std::atomic<std::uint64_t> rays = 0, paths = 0, connections = 0, unfinished = 0, fills = 0, hits = 0;
    std::vector<std::atomic<std::uint64_t>> ended_after(job.stages != nullptr ? job.scene.longest_path() + 1 : 0);
    std::vector<Hit<float>>* cache = job.cache != nullptr ? &job.cache->hits : nullptr;
    const bool filled_before = cache != nullptr && job.cache->filled;
    {
        const StageClock clock(job.stages, "trace");
        parallel_for(job.scene.pixel_count(), pixels_a_chunk, [&](std::size_t begin, std::size_t end) {
            PathCounters counters;
            std::uint64_t chunk_fills = 0;
            for (std::size_t pixel = begin; pixel < end; ++pixel) {
                for (std::uint32_t i = 0; i < job.samples; ++i) {
                    const bool filled = filled_before || i > 0;
                    chunk_fills += filled ? 0u : 1u;
                    const std::uint32_t length = trace<Config>(job.scene, job.film, static_cast<std::uint32_t>(pixel),
                                                               job.first_sample + i, cache, filled, counters);
                    if (!ended_after.empty()) {
                        ended_after[length].fetch_add(1, std::memory_order_relaxed);
                    }
                }
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
        job.cache->filled = true;
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
