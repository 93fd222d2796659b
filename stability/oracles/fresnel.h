// Exact answers for dielectric boundaries, in long double: unpolarised reflectance, stacks of plates, diffuse averages.
// Fresnel's equations are used with q = n cos(theta_t) from q^2 = c^2 + (n^2 - 1) and n^2 - 1 = e (2 + e) for n = 1 +
// e, so that nothing cancels near n = 1; r_p has another form than in the kernels.
#pragma once

#include <cmath>

#include "stability/oracles/gauss_legendre.h"

namespace pt::stability {

// The exact Fresnel reflectance. `excess`: index ahead / index behind - 1.
inline long double reflectance(long double excess, long double cosine) {
    const long double k = excess * (2 + excess);
    if (k == 0) {
        return 0;  // equal refractive indices: the formulas below would give 0 / 0 at grazing incidence
    }
    const long double q_squared = cosine * cosine + k;
    if (q_squared <= 0) {
        return 1;
    }
    const long double q = std::sqrt(q_squared);
    const long double s = k / ((cosine + q) * (cosine + q));
    const long double p = k * (cosine - 1 / (cosine + q)) / ((1 + k) * cosine + q);
    return (s * s + p * p) / 2;
}

// The cosine of refraction. Precondition: no total internal reflection.
inline long double cosine_beyond(long double excess, long double cosine) {
    return std::sqrt(cosine * cosine + excess * (2 + excess)) / (1 + excess);
}

// The shares of light that a layer reflects and transmits, equal from both sides.
struct Shares {
    long double reflected, transmitted;
};

// The shares of two layers in series, with all reflections between them added up without interference (Stokes 1862).
inline Shares stacked(const Shares& a, const Shares& b) {
    const long double between = 1 - a.reflected * b.reflected;
    return {a.reflected + a.transmitted * a.transmitted * b.reflected / between,
            a.transmitted * b.transmitted / between};
}

inline Shares boundary(long double reflected) { return {reflected, 1 - reflected}; }

// The shares of a plate: two boundaries and an absorber between them that transmits a share `a` of the light.
inline Shares plate(long double reflected, long double a) {
    // A plate that reflects everything is treated apart, since the formulas below would give 0 / 0.
    if (reflected == 1) {
        return {1, 0};
    }
    const long double entered = 1 - reflected;
    const long double between = 1 - reflected * reflected * a * a;
    return {reflected + entered * entered * reflected * a * a / between, entered * entered * a / between};
}

inline Shares stack_of(int plates, const Shares& one) {
    Shares all = one;
    for (int i = 1; i < plates; ++i) {
        all = all.reflected == 1 ? all : stacked(all, one);
    }
    return all;
}

// The diffuse reflectance 2 int R(mu) mu dmu of a boundary seen from outside, for n > 1. The closed form (Duntley 1942,
// Walsh 1926) cancels near n = 1, where quadrature is used instead.
inline long double diffuse_reflectance(long double n) {
    if (n < 1.25L) {
        long double sum = 0;
        for (const Node& node : graded_nodes(0, 1)) {
            sum += node.weight * 2 * node.x * reflectance(n - 1, node.x);
        }
        return sum;
    }
    const long double n2 = n * n, n4 = n2 * n2;
    return 0.5L + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3.0L) * std::log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

// The diffuse reflectance of a boundary seen from within, from the balance of light that enters and leaves: radiance
// within is n^2 times as high.
inline long double internal_diffuse_reflectance(long double n) { return 1 - (1 - diffuse_reflectance(n)) / (n * n); }

}  // namespace pt::stability
