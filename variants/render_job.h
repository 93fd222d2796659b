// What a CPU integrator is handed: a scene, a film, the samples to take, and the choices of the other axes as objects.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "kernels/health.h"
#include "kernels/shade.h"
#include "layouts.h"  // generated: AnyPaths, a std::variant over every layout in variants/layout
#include "variants/descriptor.h"

namespace pt {

// The path queue of a wavefront on the CPU. A path lives in a slot; the paths in play are slots 0..count-1, or, if
// `indirect`, the slots order[0..count-1] in that order.
struct PathQueue {
    AnyPaths paths;
    std::vector<Hit<float>> hits;      // by slot of a path: closest hit of the path's current segment
    std::vector<std::uint32_t> order;  // slots of the paths in play, if `indirect`; `capacity` entries
    bool indirect = false;
    std::size_t count = 0;
    std::vector<std::uint32_t> keys;     // sort keys by position in play; filled only where a sort follows
    std::vector<std::uint32_t> scratch;  // second array of slots, for compactions and sorts that need one

    // Makes room for `capacity` paths. Memory is kept between renders, so that a timed render touches no fresh page.
    void reserve(std::size_t capacity);
    std::uint32_t slot(std::size_t i) const { return indirect ? order[i] : static_cast<std::uint32_t>(i); }
};

// A compaction on the CPU: takes the ended paths out of play, between two bounces.
class Compaction {
public:
    virtual ~Compaction() = default;
    // Sets queue.count to the number of paths in play after the compaction; the choice `none` leaves the queue as it
    // is.
    virtual void compact(PathQueue& queue) = 0;
    virtual bool is_active() const { return true; }
};

// A sort on the CPU: brings paths of equal key together before they are shaded.
class Sorting {
public:
    virtual ~Sorting() = default;
    // Sorts the paths in play by queue.keys, which holds one sort key for each of them, below key_count.
    virtual void sort(PathQueue& queue, std::uint32_t key_count) = 0;
    virtual bool is_active() const { return true; }
};

// The first hits of a few camera rays of every pixel, kept between samples: sample s uses ray s mod rays.
template <class Real>
struct FirstBounceCache {
    std::vector<Hit<Real>> hits;  // by pixel, then by ray of the pixel: first hits
    std::uint32_t rays = 1;
    std::uint32_t samples_seen = 0;  // samples of each pixel traced so far; the first `rays` of them fill the cache

    std::size_t index(std::uint32_t pixel, std::uint32_t sample) const {
        return std::size_t{pixel} * rays + sample % rays;
    }
    // Whether the cache already has the hit for the sample numbered `turn`, counted from 0 since the cache was made.
    bool has(std::uint32_t turn) const { return turn >= rays; }
};

// What memory allows the passes of a stage, by the bytes that they read and write at least.
struct MemoryBound {
    double bytes = 0;
    double ms = 0;  // time of a copy of so many bytes, pass by pass

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("bytes", self.bytes);
        visit("ms", self.ms);
    }
};

// Time of a render by stage. Only instrumented renders have one: it is never part of a timed sample.
struct StageTimes {
    std::vector<std::pair<std::string_view, double>> milliseconds;  // milliseconds of each stage, in order of first use
    std::map<std::string_view, MemoryBound> memory_bounds;  // of stages that only move paths or their numbers, by stage
    std::vector<std::uint64_t> live_paths;  // entry k: number of paths that were alive for segment k + 1

    void add(std::string_view stage, double ms);
    void add_live(std::size_t segment, std::uint64_t paths);
};

class StageClock {
public:
    StageClock(StageTimes* times, std::string_view stage) : times_(times), stage_(stage) {
        if (times_ != nullptr) {
            start_ = std::chrono::steady_clock::now();
        }
    }
    ~StageClock() {
        if (times_ != nullptr) {
            times_->add(stage_,
                        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count());
        }
    }
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;

private:
    StageTimes* times_;
    std::string_view stage_;
    std::chrono::steady_clock::time_point start_;
};

// A render as an integrator takes it. The path queue, and so compaction and sorting, exists in single precision only.
template <class Real>
struct RenderJobIn {
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;  // samples per pixel
    PathQueue* queue = nullptr;
    Compaction* compaction = nullptr;
    Sorting* sorting = nullptr;
    FirstBounceCache<Real>* cache = nullptr;  // first hits of camera rays; null: every camera ray is traced
    WorkCounters work;
    StageTimes* stages = nullptr;  // stage timer; null: the render is not instrumented
    HealthRequest health;          // request to audit paths, for an integrator that can do so
};
using RenderJob = RenderJobIn<float>;

}  // namespace pt
