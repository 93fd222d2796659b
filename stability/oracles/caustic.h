// A lamp inside a ball of clear glass at the centre of a diffuse sphere: what share of the wall's light ends at it.
// Light from the wall (radius 1) that has the impact parameter q is bent to q / n within the ball and meets the lamp if
// that is less than its radius; the wall's q^2 is uniform on [0, 1]. Born and Wolf, "Principles of Optics", 1.5.2
// (Fresnel); no light that misses the lamp at first is totally reflected towards it, for q / n is kept.
#pragma once

#include <algorithm>
#include <cmath>

namespace pt::stability {

// Unpolarised reflectance from outside a medium of index n.
inline double fresnel_reflectance(double n, double sine_squared) {
    const double c = std::sqrt(1 - sine_squared), t = std::sqrt(n * n - sine_squared);
    const double s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
    return 0.5 * (s * s + p * p);
}

// The view factor from the wall to a lamp of radius a in a ball of radius b: a^2 n^2 less what is reflected.
inline double glazed_lamp_share(double a, double b, double n) {
    const double last = std::min(n * a, b);
    // The integral is over x with q^2 = last^2 (1 - x^2), so that the root at grazing incidence becomes smooth, by
    // Simpson's rule.
    constexpr int steps = 1 << 12;
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
        const double x = static_cast<double>(i) / steps;
        const double sine_squared = last * last * (1 - x * x) / (b * b);
        const double weight = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * 2 * x * (1 - fresnel_reflectance(n, std::min(1.0, sine_squared)));
    }
    return last * last * sum / (3 * steps);
}

}  // namespace pt::stability
