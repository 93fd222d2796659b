// Audits paths: traces them with the stages of shade.h and checks their state between stages for non-finite numbers,
// energy gains, self-intersections, bodies left that were not entered, and throughput cut off at the depth limit
// (docs/numerics.md 4.1). The stages are called as in other kernels, so the film has the same bits.
#pragma once

#include "kernels/shade.h"

namespace pt {

// Stages of a path segment at which its numbers are audited, in the order in which segments pass them.
enum class HealthSite : std::uint32_t { camera, hit, point, normal, direction, throughput, radiance };
inline constexpr std::uint32_t health_sites = 7;

// Audit counters of one or many paths: integer sums, minima and maxima, so the order of adding does not matter.
struct HealthCounters {
    static constexpr std::uint64_t nowhere = ~std::uint64_t{0};

    std::uint64_t paths = 0;
    std::uint64_t segments = 0;
    std::uint64_t nonfinite[health_sites] = {};
    // The first path (by pixel, sample, segment: HealthCounters::key) whose state was not finite at a site.
    std::uint64_t first_nonfinite[health_sites] = {nowhere, nowhere, nowhere, nowhere, nowhere, nowhere, nowhere};
    std::uint64_t negative = 0;       // throughputs or radiances with a negative channel
    std::uint64_t gains = 0;          // throughputs that sum to more than 3 (1 + 2^-20) without Russian roulette
    std::uint64_t self_hits = 0;      // hits on a body within a thousandth of its size by rays that have just left it
    std::uint64_t parity_errors = 0;  // hits on a body's inside (outside) by a path that is outside (inside) of it
    std::uint64_t first_self_hit = nowhere;
    std::uint64_t first_parity_error = nowhere;
    std::uint64_t escaped = 0;           // path segments that left the scene
    std::uint64_t capped = 0;            // paths that only the depth limit ended
    std::uint64_t capped_energy = 0;     // mean throughput of the paths in `capped`, added up in units of 2^-32
    std::uint64_t unfinished_walks = 0;  // paths lost in a subsurface random walk, as counted in PathCounters
    std::uint64_t worst_direction = 0;   // largest | |d|^2 - 1 | of a ray direction d, in 2^-40
    std::uint64_t worst_normal = 0;      // largest | |n|^2 - 1 | of a surface normal n, in 2^-40

    PT_HD void add(const HealthCounters& other);

    // A key that sorts faults by pixel, then sample, then segment, in 22, 22 and 20 bits.
    PT_HD static std::uint64_t key(std::uint32_t pixel, std::uint32_t sample, std::uint32_t segment) {
        return (static_cast<std::uint64_t>(pixel & 0x3fffffu) << 42) |
               (static_cast<std::uint64_t>(sample & 0x3fffffu) << 20) | (segment & 0xfffffu);
    }
};

// Merges two HealthCounters: calls `sum`, `least` or `most` with each pair of counters, whichever merges the pair.
template <class Counters, class Sum, class Least, class Most>
PT_HD inline void for_each_entry(Counters& into, const HealthCounters& from, Sum sum, Least least, Most most) {
    sum(into.paths, from.paths);
    sum(into.segments, from.segments);
    for (std::uint32_t site = 0; site < health_sites; ++site) {
        sum(into.nonfinite[site], from.nonfinite[site]);
        least(into.first_nonfinite[site], from.first_nonfinite[site]);
    }
    sum(into.negative, from.negative);
    sum(into.gains, from.gains);
    sum(into.self_hits, from.self_hits);
    sum(into.parity_errors, from.parity_errors);
    least(into.first_self_hit, from.first_self_hit);
    least(into.first_parity_error, from.first_parity_error);
    sum(into.escaped, from.escaped);
    sum(into.capped, from.capped);
    sum(into.capped_energy, from.capped_energy);
    sum(into.unfinished_walks, from.unfinished_walks);
    most(into.worst_direction, from.worst_direction);
    most(into.worst_normal, from.worst_normal);
}

PT_HD inline void HealthCounters::add(const HealthCounters& other) {
    for_each_entry(
        *this, other, [](std::uint64_t& into, std::uint64_t value) { into += value; },
        [](std::uint64_t& into, std::uint64_t value) { into = min(into, value); },
        [](std::uint64_t& into, std::uint64_t value) { into = max(into, value); });
}

// The bodies that a path is inside: bit i stands for object i, one of the first 64 objects.
using BodySet = std::uint64_t;

// Request to an integrator to audit its paths.
struct HealthRequest {
    HealthCounters* counters = nullptr;
    BodySet around_eye = 0;    // bodies that contain the eye
    bool knows_sides = false;  // camera rays start in the same bodies as the eye: no lens, no motion
};

template <class Real>
PT_HD inline bool is_finite(const Vec3<Real>& v) {
    // The vector's components are compared one by one: a sum of squares could overflow where no component does.
    constexpr Real largest = std::numeric_limits<Real>::max();
    return absolute(v.x) <= largest && absolute(v.y) <= largest && absolute(v.z) <= largest;
}

// Deviation of a vector's squared length from 1, in units of 2^-40.
template <class Real>
PT_HD inline std::uint64_t off_unit(const Vec3<Real>& v) {
    const double x = v.x;
    const double y = v.y;
    const double z = v.z;
    const double off = absolute(x * x + y * y + z * z - 1.0);
    return off < 1.0 ? static_cast<std::uint64_t>(off * 0x1p40) : std::uint64_t{1} << 40;
}

template <class Real>
PT_HD inline Real size_of(const SceneView<Real>& scene, std::uint32_t object) {
    Real size = Real(0);
    visit_shape<EveryShape<Real>>(scene, object, [&](const auto& shape) { size = size_of(shape); });
    return size;
}

// Audit of one path: the checks between two stages of its tracing.
template <class Config>
class Inspection {
public:
    using Real = typename Config::Real;

    PT_HD Inspection(const SceneView<Real>& scene, BodySet around_eye, bool knows_sides, HealthCounters& counters)
        : scene_(scene), inside_(around_eye), knows_sides_(knows_sides), counters_(counters) {}

    PT_HD void camera(const Path<Real>& path) { look(HealthSite::camera, is_finite(path.direction), path); }

    PT_HD void hit(const Path<Real>& path, const Hit<Real>& hit) {
        counters_.segments += 1;
        note_most(counters_.worst_direction, off_unit(path.direction));
        if (!hit.side.exists()) {
            counters_.escaped += 1;
            return;
        }
        look(HealthSite::hit, hit.t >= Real(0) && hit.t <= std::numeric_limits<Real>::max(), path);
        const std::uint32_t object = hit.side.object();
        const bool same_body = path.origin_surface.exists() && path.origin_surface.object() == object;
        if (same_body && !path.origin_surface.inside() && hit.t < Real(1e-3) * size_of(scene_, object)) {
            counters_.self_hits += 1;
            note_least(counters_.first_self_hit, key_of(path));
        }
        if (knows_sides_ && !is_flat(scene_, object) && object < 64 &&
            hit.side.inside() != (((inside_ >> object) & 1u) != 0)) {
            counters_.parity_errors += 1;
            note_least(counters_.first_parity_error, key_of(path));
            inside_ ^= BodySet{1} << object;
        }
        const SurfacePoint<Real> point = surface_at<Config>(scene_, ray_of(path), hit);
        look(HealthSite::point, is_finite(point.position), path);
        look(HealthSite::normal, is_finite(point.normal), path);
        note_most(counters_.worst_normal, off_unit(point.normal));
        met_ = hit.side;
    }

    PT_HD void shaded(const Path<Real>& path, bool alive) {
        look(HealthSite::radiance, is_finite(path.radiance), path);
        counters_.negative += is_negative(path.radiance) ? 1u : 0u;
        if (!alive) {
            return;
        }
        look(HealthSite::direction, is_finite(path.direction), path);
        look(HealthSite::throughput, is_finite(path.throughput), path);
        counters_.negative += is_negative(path.throughput) ? 1u : 0u;
        if (scene_.roulette_start == 0 && scene_.adjoint == nullptr) {
            const Real sum = path.throughput.x + path.throughput.y + path.throughput.z;
            counters_.gains += sum > Real(3) * (Real(1) + Real(0x1p-20)) ? 1u : 0u;
        }
        // Tracks the bodies around the path, which crosses a surface if it leaves on the other side than it came from.
        if (met_.exists() && path.origin_surface.exists() && path.origin_surface.object() == met_.object() &&
            path.origin_surface.inside() != met_.inside() && met_.object() < 64) {
            inside_ ^= BodySet{1} << met_.object();
        }
    }

    // Counts a path that ended, and its throughput if only the depth limit ended it. `throughput`: the path's
    // throughput at its last hit.
    PT_HD void ended(const Path<Real>& path, const Hit<Real>& hit, const Vec3<Real>& throughput) {
        counters_.paths += 1;
        if (path.segment >= scene_.depth && hit.side.exists() &&
            scene_.surfaces[hit.side.object()].type != MaterialType::emitter) {
            const double mean = (static_cast<double>(throughput.x) + throughput.y + throughput.z) / 3.0;
            counters_.capped += 1;
            counters_.capped_energy += mean >= 0 && mean < 16 ? static_cast<std::uint64_t>(mean * 0x1p32) : 0;
        }
    }

private:
    PT_HD static std::uint64_t key_of(const Path<Real>& path) {
        return HealthCounters::key(path.pixel, path.sample, path.segment);
    }
    PT_HD static bool is_negative(const Vec3<Real>& v) { return v.x < Real(0) || v.y < Real(0) || v.z < Real(0); }
    PT_HD static void note_least(std::uint64_t& kept, std::uint64_t value) { kept = min(kept, value); }
    PT_HD static void note_most(std::uint64_t& kept, std::uint64_t value) { kept = max(kept, value); }
    PT_HD void look(HealthSite site, bool is_good, const Path<Real>& path) {
        if (!is_good) {
            const auto index = static_cast<std::uint32_t>(site);
            counters_.nonfinite[index] += 1;
            note_least(counters_.first_nonfinite[index], key_of(path));
        }
    }

    const SceneView<Real>& scene_;
    BodySet inside_;
    bool knows_sides_;
    SurfaceId met_;
    HealthCounters& counters_;
};

// Traces a whole path and audits it. The light that the path has collected is then in path.radiance.
template <class Config>
PT_HD inline void inspect_path(const SceneView<typename Config::Real>& scene,
                               const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                               BodySet around_eye, bool knows_sides, auto& counters, HealthCounters& health) {
    using Real = typename Config::Real;
    Inspection<Config> inspection(scene, around_eye, knows_sides, health);
    inspection.camera(path);
    Hit<Real> hit;
    Vec3<Real> throughput = path.throughput;
    const auto lost_before = counters.unfinished_walks;
    for (bool alive = true; alive;) {
        hit = closest_hit<Config>(traced, ray_of(path));
        inspection.hit(path, hit);
        throughput = path.throughput;
        alive = shade<Config>(scene, traced, path, hit, counters);
        inspection.shaded(path, alive);
    }
    inspection.ended(path, hit, throughput);
    health.unfinished_walks += counters.unfinished_walks - lost_before;
}

}  // namespace pt
