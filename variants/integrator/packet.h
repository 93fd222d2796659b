// The integrator packet: many paths side by side, each in a lane of arrays that stay in the first-level cache. The
// loops over lanes are vector instructions; what is rare, and the trees of meshes, go lane by lane. A lane whose path
// has ended takes the next one, so that all lanes are at work.
// Packets: Wald, Slusallek, Benthin and Wagner 2001; regeneration: Novak, Havran and Dachsbacher 2010.
#pragma once

#include <algorithm>
#include <atomic>
#include <iterator>
#include <numeric>

#include "variants/cpu/lanes_shade.h"
#include "variants/integrator/depth_first.h"
#include "variants/mesh_reasons.h"

namespace pt::integrator::packet {

inline Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (Reason reason = needs_no_queue(variant, "keeps its paths in lanes"); !reason.empty()) {
        return reason;
    }
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits",
                "keeps no first hits: needs first_bounce=off, not " + std::string(variant.first_bounce.name)};
    }
    return {};
}

inline constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "packet",
    .summary = "64 paths side by side in vector lanes, with regeneration; what is rare goes lane by lane",
    .origin = "Wald, Slusallek, Benthin and Wagner 2001; Novak, Havran and Dachsbacher 2010",
    .unsupported_reason = unsupported_reason,
    .check_counters = depth_first::check_counters,
};

// The paths of a range of pixels, sample by sample.
class PathRange {
public:
    PathRange(std::uint32_t begin, std::uint32_t end, std::uint32_t first_sample, std::uint32_t samples,
              std::uint32_t image_width)
        : end_(end),
          first_sample_(first_sample),
          end_sample_(first_sample + samples),
          image_width_(image_width),
          sample_(first_sample),
          place_(PixelPlace::of(begin, image_width)) {}

    bool is_empty() const { return place_.index == end_ || first_sample_ == end_sample_; }
    const PixelPlace& pixel() const { return place_; }
    std::uint32_t sample() const { return sample_; }
    void pop() {
        if (++sample_ == end_sample_) {
            sample_ = first_sample_;
            place_ = PixelPlace::of(place_.index + 1, image_width_);
        }
    }

private:
    std::uint32_t end_, first_sample_, end_sample_, image_width_;
    std::uint32_t sample_;
    PixelPlace place_;
};

// Camera rays of a range of paths, made a packet at a time.
template <class Config>
class CameraRays {
public:
    using Real = typename Config::Real;

    CameraRays(const SceneView<Real>& scene, const PathRange& range) : scene_(scene), range_(range) {}

    bool is_empty() const { return next_ == size_ && range_.is_empty(); }
    // Starts the next path in lane `l`. Precondition: not is_empty().
    void start(lanes::Paths<Real>& paths, std::uint32_t l) {
        if (next_ == size_) {
            generate();
        }
        const std::uint32_t k = next_++;
        paths.origin.set(l, origin_[k]);
        paths.direction.set(l, direction_[k]);
        paths.throughput.set(l, Vec3<Real>(Real(1)));
        paths.radiance.set(l, Vec3<Real>(Real(0)));
        paths.time[l] = time_[k];
        paths.bsdf_pdf[l] = Real(0);
        paths.pixel[l] = pixel_[k];
        paths.sample[l] = sample_[k];
        paths.segment[l] = 0;
        paths.origin_surface[l] = SurfaceId::nowhere;
        paths.medium[l] = scene_.camera.initial_medium;
        if constexpr (has<Config>(Feature::mesh)) {
            paths.primitive[l] = 0;
        }
    }

private:
    void generate() {
        next_ = size_ = 0;
        for (; size_ < lanes::width && !range_.is_empty(); ++size_, range_.pop()) {
            pixel_[size_] = range_.pixel().index;
            x_[size_] = range_.pixel().x;
            y_[size_] = range_.pixel().y;
            sample_[size_] = range_.sample();
        }
        const Camera<Real> camera = scene_.camera;
        const RandomSeed seed = scene_.seed;
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            const Path<Real> path =
                camera_path<Config>(camera, seed, {pixel_[l], x_[l], y_[l]}, sample_[l], sample_[l]);
            origin_.set(l, path.origin);
            direction_.set(l, path.direction);
            time_[l] = path.time;
        }
    }

    const SceneView<Real>& scene_;
    PathRange range_;
    std::uint32_t next_ = 0, size_ = 0;
    lanes::Vectors<Real> origin_, direction_;
    lanes::Lanes<Real> time_;
    lanes::Lanes<std::uint32_t> pixel_{}, x_{}, y_{}, sample_{};
};

using EndedAfter = std::vector<std::atomic<std::uint64_t>>;  // number of paths that ended, by their number of segments

template <class Config>
class Packet {
public:
    using Real = typename Config::Real;

    Packet(const SceneView<Real>& scene, const FilmView& film, const lanes::LightTable<Real>& lights,
           const PathRange& range, EndedAfter& ended_after)
        : scene_(scene), film_(film), lights_(lights), camera_rays_(scene, range), ended_after_(ended_after) {}

    void trace_all(PathCounters& counters) {
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            paths_.store(l, Path<Real>{});
            refill(l);
        }
        for (std::uint32_t live = count_live(); live > 0; live = count_live()) {
            counters.rays += live;
            lanes::closest_hit<Config>(hits_, scene_, paths_, live_);
            const lanes::Flags before = live_;
            shade(counters);
            end_paths(before, counters);
        }
    }

private:
    std::uint32_t count_live() const { return std::accumulate(std::begin(live_.of), std::end(live_.of), 0u); }

    void shade(PathCounters& counters) {
        if constexpr (lanes::shades_in_lanes<Config>) {
            if (scene_.surfaces.size != 0) {
                lanes::shade<Config>(paths_, live_, scene_, hits_, connections_, lights_, counters);
                return;
            }
        }
        for (const std::uint32_t l : lanes::LaneList(live_)) {
            Path<Real> path = paths_.load(l);
            live_[l] = pt::shade<Config>(scene_, scene_, path, hits_[l], counters) ? 1u : 0u;
            paths_.store(l, path);
        }
    }

    // Ends the paths of the lanes that were live in `before` and no longer are; these lanes take the next paths.
    void end_paths(const lanes::Flags& before, PathCounters& counters) {
        lanes::Flags ended;
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            ended[l] = before[l] & ~live_[l];
        }
        const lanes::LaneList list(ended);
        counters.paths += list.size();
        for (const std::uint32_t l : list) {
            add_to_film(l);
            if (!ended_after_.empty()) {
                ended_after_[paths_.segment[l]].fetch_add(1, std::memory_order_relaxed);
            }
            refill(l);
        }
    }

    // Adds a lane's path to the film, without an atomic addition: a pixel's samples are all in one packet.
    void add_to_film(std::uint32_t l) {
        const FilmSum sum = film_.quanta(paths_.radiance[l]);
        std::int64_t* const target = film_.sums + 3 * static_cast<std::size_t>(paths_.pixel[l]);
        target[0] += sum.x;
        target[1] += sum.y;
        target[2] += sum.z;
    }

    void refill(std::uint32_t l) {
        live_[l] = camera_rays_.is_empty() ? 0u : 1u;
        if (live_[l] != 0) {
            camera_rays_.start(paths_, l);
        }
    }

    const SceneView<Real>& scene_;
    const FilmView& film_;
    const lanes::LightTable<Real>& lights_;
    CameraRays<Config> camera_rays_;
    EndedAfter& ended_after_;
    lanes::Paths<Real> paths_;
    lanes::Hits<Real> hits_{};  // hits of the lanes' rays; in kernels without meshes primitives stay 0
    lanes::Connections<Real> connections_{};
    lanes::Flags live_;  // lanes with a path; what the others compute is not used
};

// Number of pixels that a packet works through: enough paths that the last ones, with lanes idle, weigh little, but
// some chunks for every thread.
inline std::size_t pixels_per_chunk(std::size_t pixels, std::uint32_t samples) {
    constexpr std::size_t paths = 512 * lanes::width;
    const std::size_t fair = pixels / (8 * static_cast<std::size_t>(parallel_threads()));
    return std::max<std::size_t>(64, std::min(paths / std::max(samples, 1u), fair));
}

template <class Config>
void render(RenderJobIn<typename Config::Real>& job) {
    std::atomic<std::uint64_t> rays = 0, paths = 0, connections = 0, unfinished = 0;
    using Real = typename Config::Real;
    const auto lights = job.scene.next_event != 0 ? lanes::LightTable<Real>(job.scene) : lanes::LightTable<Real>();
    EndedAfter ended_after(job.stages != nullptr ? job.scene.longest_path() + 1 : 0);
    {
        const StageClock clock(job.stages, "trace");
        const std::size_t pixels = job.scene.pixel_count();
        parallel_for(pixels, pixels_per_chunk(pixels, job.samples), [&](std::size_t begin, std::size_t end) {
            const PathRange range(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), job.first_sample,
                                  job.samples, job.scene.camera.width);
            PathCounters counters;
            Packet<Config>(job.scene, job.film, lights, range, ended_after).trace_all(counters);
            rays += counters.rays;
            paths += counters.paths;
            connections += counters.connections;
            unfinished += counters.unfinished_walks;
        });
    }
    job.work.rays += rays;
    job.work.connections += connections;
    job.work.paths += paths;
    job.work.unfinished_walks += unfinished;
    if (job.stages != nullptr) {
        std::uint64_t live = paths;
        for (std::uint32_t segment = 0; segment < job.scene.longest_path(); ++segment) {
            job.stages->add_live(segment, live);
            live -= ended_after[segment + 1];
        }
    }
}

}  // namespace pt::integrator::packet
