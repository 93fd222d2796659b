// Exact answers for closed spaces whose walls reflect and emit uniformly, with or without a lamp at the centre:
// geometric series (docs/numerics.md S1 and S5). Depth counts ray segments.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "harness/render/film.h"
#include "harness/stability/case.h"

namespace pt::stability {

// The radiance in a furnace: the emission times the sum of albedo^j for j = 0 .. segments - 1.
inline double furnace(double emission, double albedo, double segments) {
    return albedo == 1 ? emission * segments : emission * -std::expm1(segments * std::log(albedo)) / (1 - albedo);
}

// The largest rounding error of a sample added to a film whose samples carry a radiance of up to `bound`.
inline double half_quantum(double bound) { return 0.5 / film_scale(bound, 1u << 16); }

// The tolerance of a furnace: one rounding of throughput and radiance for each segment of the geometric series, and
// half of the film's quantum.
inline Tolerance furnace_tolerance(double emission, double albedo, double depth) {
    const double exact = furnace(emission, albedo, depth);
    const double quantum = half_quantum(emission * (1 + std::min(1 / (1 - albedo), depth)));
    return {(depth <= 1024 ? 1e-6 : 1e-5) * exact + quantum, 1e-13 * std::max(1.0, depth / 1024) * exact + quantum,
            "numerics.md S1: throughput and sum of a geometric series; and half the film's quantum"};
}

// The radiance of a diffuse sphere of radius 1 around a black lamp of radius a and radiance 1 at its centre. The wall
// sees the lamp with the view factor s = a^2; the radiance is s rho + s rho^2 (1 - s) + ..., with `reflections` terms.
inline double lamp_radiance(double a, double albedo, double reflections) {
    const double s = a * a;
    const double ends = 1 - albedo * (1 - s);  // share of the paths at the wall that never come back to the wall
    return s * albedo * -std::expm1(reflections * std::log1p(-ends)) / ends;
}

// The number of paths of length `depth` that have `segments` segments in all, limited to 16 to 2^25.
inline std::uint64_t paths_for(double segments, double depth) {
    return static_cast<std::uint64_t>(std::clamp(segments / depth, 16.0, 0x1p25));
}

// The quantities measured in a furnace: every pixel has the exact radiance, and no path leaks out.
inline std::vector<Quantity> furnace_quantities(double emission, double albedo, std::uint32_t depth) {
    const double exact = furnace(emission, albedo, depth);
    return {
        every_pixel_is("radiance of the pixel that is farthest off", exact, furnace_tolerance(emission, albedo, depth)),
        exactly("segments missing of a path", missing_segments(depth), 0, {0, 0, "a closed space loses no path"})};
}

inline Rendering furnace_rendering(const SceneText& scene, double emission, double albedo, std::uint32_t depth) {
    // A furnace's image has 8 x 8 pixels, and each gets at least one sample.
    return {.scene = scene.json(),
            .quick_paths = std::max<std::uint64_t>(64, paths_for(1e6, depth)),
            .full_paths = std::max<std::uint64_t>(64, paths_for(3e7, depth)),
            .quantities = furnace_quantities(emission, albedo, depth)};
}

}  // namespace pt::stability
