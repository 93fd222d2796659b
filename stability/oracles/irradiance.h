// Exact irradiance E / Le at a point with normal +y from one light of uniform radiance. Closed forms: docs/numerics.md
// S6 to S8 (Howell's catalogue of configuration factors; for a sphere across the horizon A. Snyder, "Area Light Sources
// for Real-Time Graphics", 1996). Flattened ellipsoid: Lambert's contour integral along its outline.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/math.h"

namespace pt::stability {

// Irradiance from a rectangle a x b parallel to the receiver, with one corner straight above the point at height h.
inline double rectangle_irradiance(double a, double b, double h) {
    const double x = a / h, y = b / h;
    return 0.5 * (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                  y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y)));
}

// Irradiance from a sphere whose centre is `distance` radii away, at `angle` from the normal.
inline double sphere_irradiance(double distance, double angle) {
    const double cosine = std::cos(angle), h = distance;
    if (h <= 1) {
        return pi<double>;  // the receiving point is inside the sphere
    }
    if (cosine >= 1 / h) {
        return pi<double> * cosine / (h * h);  // the whole sphere is above the horizon
    }
    if (cosine <= -1 / h) {
        return 0;
    }
    const double k2 = 1 - h * h * cosine * cosine;
    const double edge = std::clamp(-cosine * std::sqrt((h * h - 1) / (1 - cosine * cosine)), -1.0, 1.0);
    return (cosine * std::acos(edge) - std::sqrt(k2 * (h * h - 1))) / (h * h) + std::atan(std::sqrt(k2 / (h * h - 1)));
}

// Irradiance from an ellipsoid with semi-axes (r, half_thickness, r) that lies wholly above the horizon, centred at
// height h and `offset`: E = 1/2 of the contour integral of (p x dp).n / p^2. The trapezium rule converges
// exponentially here, since the integrand is periodic.
inline double flat_ellipsoid_irradiance(double r, double half_thickness, double h, double offset) {
    const Vec3<double> axes(r, half_thickness, r), centre(offset, h, 0);
    const Vec3<double> observer = -centre / axes;  // receiving point, in the space where the ellipsoid is a unit sphere
    const double square = dot(observer, observer);
    const Frame<double> frame(observer / std::sqrt(square));
    const double radius = std::sqrt(1 - 1 / square);
    constexpr int steps = 1 << 14;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double phi = 2 * pi<double> * i / steps;
        const Vec3<double> p =
            centre +
            axes * (observer / square + (frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi)) * radius);
        const Vec3<double> step = axes * (frame.bitangent * std::cos(phi) - frame.tangent * std::sin(phi)) * radius;
        sum += (p.z * step.x - p.x * step.z) / dot(p, p);
    }
    return std::abs(sum) * pi<double> / steps;
}

}  // namespace pt::stability
