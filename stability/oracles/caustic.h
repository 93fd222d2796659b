// Exact answer for a spherical lamp within a ball of clear glass at the centre of a diffuse sphere: the share of the
// wall's light that ends at the lamp. A ray from the wall (radius 1) with impact parameter q is bent to q / n within
// the ball and hits the lamp if q / n is less than its radius; q^2 is uniform on [0, 1]. Internal reflection keeps q /
// n, so rays that miss the lamp never reach it. Fresnel: Born and Wolf, "Principles of Optics", 1.5.2.
#pragma once

#include <algorithm>
#include <cmath>

namespace pt::stability {

// Unpolarised Fresnel reflectance of a dielectric of index n, seen from outside.
inline double fresnel_reflectance(double n, double sine_squared) {
    const double c = std::sqrt(1 - sine_squared), t = std::sqrt(n * n - sine_squared);
    const double s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
    return 0.5 * (s * s + p * p);
}

// The view factor from the wall to a lamp of radius a in a glass ball of radius b: a^2 n^2 less the reflected part.
inline double glazed_lamp_share(double a, double b, double n) {
    const double last = std::min(n * a, b);
    // Substituting q^2 = last^2 (1 - x^2) makes the root at grazing incidence smooth; Simpson's rule integrates over x.
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
