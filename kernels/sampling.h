// Maps from uniform numbers to the distributions that the kernels draw from. Each is tested by chi-square.
#pragma once

#include "kernels/in_range.h"

namespace pt {

// A uniform point on the unit disc from one of the square [-1, 1]^2. Shirley and Chiu, "A Low Distortion Map Between
// Disk and Square", JGT 2(3), 1997, in the branch-light form of pbrt; every angle lies in [-pi/4, pi/4].
template <class Real>
PT_HD inline Vec2<Real> concentric_disc_of_square(Real x, Real y) {
    const bool x_is_radius = absolute(x) > absolute(y);
    const Real radius = x_is_radius ? x : y;
    const Real other = x_is_radius ? y : x;
    // Coordinates are whole multiples of 2^-23 (in double 2^-31) and at most 1, so divide_in_range can divide them.
    Real ratio;
    if constexpr (draws_approximately<Real>) {
        ratio = keep_smaller(Real(1), nearly_divide(other, radius));  // keep_smaller ignores the NaN of 0 / 0
    } else {
        ratio = radius == Real(0) ? Real(0) : divide_in_range(other, radius);
    }
    const SinCos<Real> angle = nearly_sin_cos_octant(ratio * (pi<Real> / Real(4)));
    return {radius * (x_is_radius ? angle.cosine : angle.sine), radius * (x_is_radius ? angle.sine : angle.cosine)};
}

template <class Real>
PT_HD inline Vec2<Real> concentric_disc(Real u, Real v) {
    return concentric_disc_of_square(Real(2) * u - Real(1), Real(2) * v - Real(1));
}

// Samples the hemisphere around +z with pdf cos(theta) / pi (Malley's method), by a point of the square [-1, 1]^2.
template <class Real>
PT_HD inline Vec3<Real> cosine_hemisphere_of_square(Real x, Real y) {
    const Vec2<Real> disc = concentric_disc_of_square(x, y);
    const Real rest = Real(1) - disc.x * disc.x - disc.y * disc.y;
    // `rest` is a difference of numbers up to 1: if not 0, it is at least their last bit, and so in range for the root.
    return {disc.x, disc.y, rest > Real(0) ? nearly_square_root_in_range(rest) : Real(0)};
}

template <class Real>
PT_HD inline Vec3<Real> cosine_hemisphere(Real u, Real v) {
    return cosine_hemisphere_of_square(Real(2) * u - Real(1), Real(2) * v - Real(1));
}

// A direction uniform on the unit sphere, of density 1 / (4 pi).
template <class Real>
PT_HD inline Vec3<Real> uniform_sphere(Real u, Real v) {
    const Real z = Real(1) - Real(2) * u;
    const Real radius = square_root(max(Real(0), (Real(1) - z) * (Real(1) + z)));
    const SinCos<Real> azimuth = sin_cos_turn(v);
    return {radius * azimuth.cosine, radius * azimuth.sine, z};
}

// Samples the Henyey-Greenstein (1941) cosine between the old and the new direction of travel, inverted in closed form
// and freed of the division by g: (1 + g^2 - s^2) / 2g cancels for small g, where in float it moved the mean cosine by
// a few per cent. g in (-1, 1); g = 0 is exactly isotropic.
template <class Real>
PT_HD inline Real henyey_greenstein_cosine(Real g, Real u) {
    const Real isotropic = Real(1) - Real(2) * u;
    const Real divisor = Real(1) + g * isotropic;
    const Real s = (Real(1) - g) * (Real(1) + g) / divisor;
    return clamp(Real(0.5) * ((isotropic + g) / divisor * (Real(1) + s) + g), Real(-1), Real(1));
}

}  // namespace pt
