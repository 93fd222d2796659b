// A smooth boundary, and reflection and refraction at it: Snell's law and the exact unpolarised Fresnel reflectance,
// with total internal reflection. Stable form (docs/numerics.md S26): with n = index ahead / index behind, c = cosine
// of incidence, k = (n-1)(n+1), q = sqrt(k + c^2) = n cos(theta_t):  r_s = -k / (c + q)^2,  r_p = r_s (c q - s^2) / (c
// q + s^2),  s^2 = (1-c)(1+c). It is right to 6e-7 for every n >= 1 where the textbook's 1 - cos^2 turns index 1 into a
// mirror at grazing angles. q^2 itself is n^2 - s^2 near normal incidence, where k + c^2 would cancel for n far
// below 1.
#pragma once

#include "kernels/config.h"
#include "kernels/naive.h"

namespace pt {

// A dielectric boundary seen from one side. relative_ior = index ahead / index behind; `k` = (n - 1)(n + 1) is formed
// in double at load, where 1 - n^2 cannot cancel.
template <class Real>
struct Boundary {
    Real relative_ior;
    Real inverse_relative_ior;
    Real k;
};

template <class Real>
PT_HD inline Vec3<Real> reflect(const Vec3<Real>& direction, const Vec3<Real>& normal) {
    return renormalize(direction - normal * (Real(2) * dot(direction, normal)));
}

template <class Real>
struct Refraction {
    Real reflectance;  // Fresnel reflectance; 1 under total internal reflection
    Real q;            // n cos(theta_t), with the relative index n and the angle of refraction theta_t
};

// Fresnel reflectance at a boundary for a cosine of incidence in [0, 1].
template <class Real>
PT_HD inline Refraction<Real> fresnel(const Boundary<Real>& boundary, Real cosine) {
    if (boundary.k == Real(0)) {
        return {Real(0), cosine};
    }
    const Real sine_squared = (Real(1) - cosine) * (Real(1) + cosine);
    const Real q_squared = sine_squared < Real(0.5) ? boundary.relative_ior * boundary.relative_ior - sine_squared
                                                    : boundary.k + cosine * cosine;
    if (!(q_squared > Real(0))) {
        return {Real(1), Real(0)};
    }
    const Real q = square_root(q_squared);
    const Real sum = cosine + q;
    const Real r_s = -boundary.k / (sum * sum);
    const Real r_p = r_s * ((cosine * q - sine_squared) / (cosine * q + sine_squared));
    return {Real(0.5) * (r_s * r_s + r_p * r_p), q};
}

// The Fresnel reflectance in the form that the kernel is compiled for: the stable form, or the textbook's (naive
// kernels).
template <class Config>
PT_HD inline Refraction<typename Config::Real> fresnel(const Boundary<typename Config::Real>& boundary,
                                                       typename Config::Real cosine) {
    if constexpr (has<Config>(Feature::naive)) {
        const auto textbook = naive::fresnel(boundary.relative_ior, cosine);
        return {textbook.reflectance, textbook.q};
    } else {
        return fresnel(boundary, cosine);
    }
}

// Direction of the ray refracted at a smooth boundary; `normal` is on the incoming side.
template <class Real>
PT_HD inline Vec3<Real> refract(const Boundary<Real>& boundary, const Vec3<Real>& direction, const Vec3<Real>& normal,
                                Real cosine, Real q) {
    return normalize((direction + normal * (cosine - q)) * boundary.inverse_relative_ior);
}

template <class Real>
PT_HD inline Real cosine_of_incidence(const Vec3<Real>& direction, const Vec3<Real>& normal) {
    return clamp(-dot(direction, normal), Real(0), Real(1));
}

}  // namespace pt
