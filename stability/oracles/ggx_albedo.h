// What a white rough surface keeps of an even light when each ray meets one facet: the directional albedo of the GGX
// distribution under Smith's height-correlated masking (Walter et al. 2007; Heitz, JCGT 3(2), 2014), by quadrature.
//
// Facets are integrated by their tilt and azimuth. Up to the tilt at which the first facet of a ring mirrors light from
// below the horizon whole rings count, beyond it arcs of them, and beyond a second tilt nothing: between these the
// integrand is smooth, but for square roots at the ends of the second part, which its substitution takes away.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stability/oracles/gauss_legendre.h"

namespace pt::stability {

class GgxAlbedo {
public:
    // The albedo of a rough surface. `cosine` of the viewer's direction to the normal, in (0, 1]; alpha in (0, 1].
    GgxAlbedo(long double alpha, long double cosine)
        : alpha_(alpha), z_(cosine), x_(std::sqrt((1 - cosine) * (1 + cosine))), masked_(smith_lambda(cosine)) {}

    double value() const {
        constexpr long double right_angle = std::numbers::pi_v<long double> / 2;
        const long double angle = std::atan2(x_, z_);
        const long double first = steeper_than(std::tan((right_angle - angle) / 2));
        const long double last = steeper_than(std::tan((right_angle + angle) / 2));
        long double sum = 0;
        for (long double high = 1; high > first; high = std::max(high / 2, first)) {
            const long double low = std::max(high / 2, first);
            for (const Node& node : nodes()) {
                sum += (high - low) * node.weight * ring(low + (high - low) * node.x);
            }
        }
        // The substitution is share = first (last / first)^w with w = (1 - cos(pi s)) / 2.
        const long double ratio = std::log(last / first);
        for (const Node& node : nodes()) {
            const long double turn = std::numbers::pi_v<long double> * node.x;
            const long double share = first * std::exp(ratio * (1 - std::cos(turn)) / 2);
            sum -= node.weight * ring(share) * share * ratio * std::sin(turn) * std::numbers::pi_v<long double> / 2;
        }
        return static_cast<double>(sum);
    }

private:
    static const std::vector<Node>& nodes() {
        static const std::vector<Node> made = gauss_legendre(64);
        return made;
    }

    long double smith_lambda(long double c) const {
        return (std::sqrt(1 + alpha_ * alpha_ * (1 - c * c) / (c * c)) - 1) / 2;
    }

    // The share of facets, by the area that they cover, whose slope is greater.
    long double steeper_than(long double slope) const { return 1 / (1 + slope * slope / (alpha_ * alpha_)); }

    // The light kept by those facets than whose slope a share of all facets is steeper: the mean over their azimuths.
    long double ring(long double share) const {
        const long double slope = alpha_ * std::sqrt((1 - share) / share);
        const long double up = 1 / std::sqrt(1 + slope * slope), across = slope * up * x_;
        const long double least = z_ / (2 * up) - z_ * up;  // of across cos(azimuth), for light above the horizon
        if (least >= across) {
            return 0;
        }
        return arc(up, across, least <= -across ? std::numbers::pi_v<long double> : std::acos(least / across));
    }

    // Integral over azimuths from 0 to `end`.
    long double arc(long double up, long double across, long double end) const {
        long double sum = 0;
        for (const Node& node : nodes()) {
            const long double facing = across * std::cos(end * node.x) + z_ * up;
            const long double incoming = std::min(2 * facing * up - z_, 1.0L);
            if (facing > 0 && incoming > 0) {
                sum += node.weight * facing / (z_ * up) / (1 + masked_ + smith_lambda(incoming));
            }
        }
        return sum * end / std::numbers::pi_v<long double>;
    }

    long double alpha_, z_, x_, masked_;
};

}  // namespace pt::stability
