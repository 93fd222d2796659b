// Quantities that the cases with glass read from a film. The lamps before and behind a body have different colours, so
// one film shows what was reflected, what was transmitted and, in the channel that both lamps share, whether light was
// lost.
#pragma once

#include <algorithm>
#include <cmath>

#include "harness/stability/case.h"
#include "stability/oracles/fresnel.h"

namespace pt::stability {

inline constexpr std::uint32_t without_end = 1000000;
inline const Vec3d lamp_behind(1, 0, 1), lamp_before(0, 1, 1);

// Tolerance for the share of paths that are reflected, or transmitted: four standard errors, by the binomial law, if
// fewer than 40 paths decide the share, since batches of so few do not show their spread; otherwise 0.
inline double few_events(long double share, std::uint64_t paths) {
    const long double odd = std::min(std::abs(share), std::abs(1 - share));
    const bool is_few = odd * static_cast<long double>(paths) < 40;
    return is_few ? static_cast<double>(4 * std::sqrt(std::max(odd, 1e-18L) / static_cast<long double>(paths))) : 0;
}

// The tolerance of an estimate whose paths are reflected or transmitted at random at boundaries.
inline Tolerance chance_tolerance(long double share, std::uint64_t paths, double more_single = 0) {
    const double few = few_events(share, paths);
    return {1e-6 + more_single + few, 1e-8 + few,
            "numerics.md S24: 1e-6 in single precision, for a reflectance is met in steps of 2^-24 (2^-32 in double); "
            "where few paths decide, 4 standard errors of the binomial law"};
}

inline Quantity nothing_lost(const std::string& name) {
    return exactly(name, [](const RenderResult& result) { return mean_channel(result, 2); }, 1,
                   {0, 0, "every path ends in a lamp of radiance 1, with weight 1"});
}

inline std::vector<Quantity> shares(const Shares& exact, std::uint64_t paths, double more_single = 0) {
    return {{.name = "transmitted",
             .of = [](const RenderResult& result) { return mean_channel(result, 0); },
             .exact = static_cast<double>(exact.transmitted),
             .tolerance = chance_tolerance(exact.transmitted, paths, more_single)},
            {.name = "reflected",
             .of = [](const RenderResult& result) { return mean_channel(result, 1); },
             .exact = static_cast<double>(exact.reflected),
             .tolerance = chance_tolerance(exact.reflected, paths, more_single)}};
}

inline Quantity all_one(const std::string& name) {
    return every_pixel_is(name, 1, {0, 0, "every path leaves in the end, with weight 1"});
}

// Adds the body that the parameter `shape` selects: 0 sphere, 1 ellipsoid, 2 box, 3 rotated box.
inline void add_body(SceneText& scene, std::uint32_t shape, const std::string& material) {
    if (shape == 0) {
        scene.sphere(material, {0, 0, 0}, 2);
    } else if (shape == 1) {
        scene.ellipsoid(material, {0, 0, 0}, {2, 1, 1.5}, {10, 20, 30});
    } else {
        scene.box(material, {0, 0, 0}, {1.5, 1, 2}, shape == 2 ? Vec3d(0.0) : Vec3d(10, 20, 30));
    }
}

}  // namespace pt::stability
