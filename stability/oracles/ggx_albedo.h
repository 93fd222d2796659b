// The directional albedo of a white rough surface with single scattering, by quadrature: GGX distribution and Smith's
// height-correlated masking (Walter et al. 2007; Heitz, JCGT 3(2), 2014).
//
// Microfacets are integrated by tilt and azimuth, a ring of all azimuths for each tilt. Up to a first tilt the whole
// ring counts; then light mirrored by part of the ring comes from below the horizon, and an arc counts; from a second
// tilt on nothing does. Within both parts the integrand is smooth but for square roots at the ends of the second part,
// which a substitution removes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stability/oracles/gauss_legendre.h"

namespace pt::stability {

class GgxAlbedo {
public:
    // The albedo for a view direction with `cosine` to the normal, in (0, 1], and a roughness alpha in (0, 1].
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
        // Substitution for the tilts of which an arc counts: share = first (last / first)^w, w = (1 - cos(pi s)) / 2.
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

    // The share of microfacets, by projected area, that are steeper than `slope`.
    long double steeper_than(long double slope) const { return 1 / (1 + slope * slope / (alpha_ * alpha_)); }

    // The reflected light, averaged over azimuth, of the microfacets whose slope is exceeded by `share` of microfacets.
    long double ring(long double share) const {
        const long double slope = alpha_ * std::sqrt((1 - share) / share);
        const long double up = 1 / std::sqrt(1 + slope * slope), across = slope * up * x_;
        const long double least = z_ / (2 * up) - z_ * up;  // light is from above where across * cos(azimuth) > least
        if (least >= across) {
            return 0;
        }
        return arc(up, across, least <= -across ? std::numbers::pi_v<long double> : std::acos(least / across));
    }

    // Integrates the reflected light of a ring of microfacets over azimuths from 0 to `end`.
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
