// Texts for Case::known_limit: known limits of estimators or of single precision. Each function returns a text only
// where its numbers predict the failure; a case that fails for other parameters counts as failed.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "harness/stability/case.h"

namespace pt::stability {

// For the limits below: fewest paths of a case's quick run, and number of rare events that an error estimate needs.
inline constexpr double quick_paths_at_least = 5e5;
inline constexpr double enough_events = 100;

inline std::string too_rare(double probability, double paths = quick_paths_at_least) {
    return paths * probability < enough_events ? "too few paths find or miss so small a light by chance for an error "
                                                 "to be told; cure: direct_light=nee, "
                                                 "or more samples"
                                               : "";
}

// The known limit of next-event estimation where connections to a light of radiance `bright` bring a pixel only the
// radiance `dim`. The film has room for 1024 times the brightest light: its quantum is 2^-30 of that light for up to
// 2^16 samples per pixel, and 2^-25 for 2^21.
inline std::string too_dim(double bright, double dim) {
    return 0x1p-25 * bright > 1e-6 * dim ? "the film's quantum is 2^-30 of the brightest light, or up to 2^-25 with "
                                           "more samples, and samples that "
                                           "are alike all round one way; cure: rounding by a random number of the "
                                           "sample's own, or a quantum from "
                                           "what samples carry"
                                         : "";
}

// The known limit of a light that a path hits by chance with probability `share`, or of too dim connections to it.
inline std::string rare_or_dim(const VariantTraits& variant, double share, double bright, double dim,
                               double paths = quick_paths_at_least) {
    return !variant.direct_light.connects ? too_rare(share, paths) : too_dim(bright, dim);
}

// The known limit of a ray inside a ball of high index whose chords pass near the centre along one line: each internal
// reflection turns the ray by a rounding error of the sine impact / ior, always in the same direction.
inline std::string turns_inside(const VariantTraits& variant, double impact, double ior, double hits) {
    const double drift = impact > 0 ? hits * 0x1p-24 * ior / impact : 0;
    return !variant.precision.is_double() && drift > 1e-3
               ? fmt::format(
                     "hundreds of internal reflections along one line turn a ray the same way by a rounding "
                     "each, up to {:.1g} of the sine by which it misses the centre; cure: precision=double",
                     drift)
               : "";
}

// The known limit of a furnace whose last reflections are below half the last bit of the sum so far.
inline std::string lost_tail(double emission, double albedo, double depth, const VariantTraits& variant) {
    const double last = emission * std::pow(albedo, depth - 1);
    const double sum = albedo < 1 ? emission / (1 - albedo) : emission * depth;
    return !variant.precision.is_double() && last < 0x1p-24 * sum && 0x1p-25 * sum / emission > 1e-7
               ? "a path's light is summed in single precision: reflections fainter than half its last bit are lost, "
                 "2^-25 / (1 - albedo) of the light in all; cure: a compensated sum of a path's light, or "
                 "precision=double"
               : "";
}

}  // namespace pt::stability
