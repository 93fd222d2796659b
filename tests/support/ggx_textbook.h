// The textbook's GGX and Smith's masking (Walter et al. 2007), in the surface's frame and in double, and quadrature
// over facets by its map of the unit square, in which D cos(theta) is constant: tan^2(theta) = alpha^2 u / (1 - u).
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/math.h"

namespace pt::test::ggx {

inline Vec3<double> direction_at(double cosine, double turn) {
    const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
    return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}

inline double distribution(double alpha, double facet_cosine) {
    const double tangent_squared = 1 / (facet_cosine * facet_cosine) - 1;
    const double square = facet_cosine * facet_cosine * (1 + tangent_squared / (alpha * alpha));
    return 1 / (pi<double> * alpha * alpha * square * square);
}

inline double smith_lambda(double alpha, double cosine) {
    return (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
}

inline double masking(double alpha, double cosine) { return 1 / (1 + smith_lambda(alpha, cosine)); }

struct Facet {
    Vec3<double> normal;
    double measure;  // du / dt: facets per cell of the grid
};

// u = 1 - (1 - t)^2, so that the facets' slopes times their number stay finite.
inline Facet facet_at(double alpha, double t, double turn) {
    const double rest = (1 - t) * (1 - t);
    const double tangent = alpha * std::sqrt((1 - rest) / rest);
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    return {{tangent * cosine * std::cos(turn), tangent * cosine * std::sin(turn), cosine}, 2 * (1 - t)};
}

// The mean over the unit square of f(t, turn / 2 pi), by midpoints.
template <class F>
inline double mean_over_square(int side, const F& f) {
    double sum = 0;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            sum += f((i + 0.5) / side, (j + 0.5) / side);
        }
    }
    return sum / side / side;
}

}  // namespace pt::test::ggx
