// Textbook forms, against which the robust forms of shapes and of boundary.h are measured (axis `robustness`; a shape's
// own are in its header): a fixed ray epsilon instead of the surface that a ray starts on, the school formula of the
// sphere, slabs without Ize's factor, hit points left where rounding puts them, 1 - cos of a cone, Fresnel from 1 -
// cos^2. Renderers of a first course have them (Shirley, "Ray Tracing in One Weekend"; CIS 565).
#pragma once

#include "kernels/box.h"

namespace pt {

// The robust forms under names of their own, for namespace pt::naive, whose functions hide the usual names.
template <class Shape, class Real>
PT_HD inline Interval<Real> robust_interval(const Shape& shape, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return interval(shape, origin, direction);
}
template <class Shape, class Real>
PT_HD inline DirectionSample<Real> robust_direction(const Shape& shape, const Vec3<Real>& observer, Real u, Real v,
                                                    Real w) {
    return sample_direction(shape, observer, u, v, w);
}
template <class Shape, class Real>
PT_HD inline Real robust_inverse_pdf(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                     Real distance) {
    return inverse_direction_pdf(shape, observer, direction, distance);
}

}  // namespace pt

namespace pt::naive {

// A shape without a textbook form of its own is handled in the robust way.
template <class Shape, class Real>
PT_HD inline Interval<Real> interval(const Shape& shape, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return robust_interval(shape, origin, direction);
}
template <class Shape, class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Shape& shape, const Vec3<Real>& observer, Real u, Real v,
                                                    Real w) {
    return robust_direction(shape, observer, u, v, w);
}
template <class Shape, class Real>
PT_HD inline Real inverse_direction_pdf(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                        Real distance) {
    return robust_inverse_pdf(shape, observer, direction, distance);
}

// Textbook ray epsilon: hits nearer than this are ignored, in scene units whatever the scene's size.
template <class Real>
inline constexpr Real epsilon = Real(1e-4);

// The real roots t of a t^2 + b t + c = 0 in the textbook's form, the lesser first.
template <class Real>
PT_HD inline Interval<Real> roots(Real a, Real b, Real c) {
    const Real discriminant = b * b - Real(4) * a * c;
    if (!(discriminant > Real(0))) {
        return {Real(0), Real(0), false};
    }
    const Real root = square_root(discriminant);
    return {(-b - root) / (Real(2) * a), (-b + root) / (Real(2) * a), true};
}

template <class Real>
PT_HD inline Interval<Real> slabs(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                                  const Vec3<Real>& direction) {
    Interval<Real> crossing = slab_interval(
        low, high, origin, Vec3<Real>(Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z));
    crossing.hits = crossing.near <= crossing.far;
    return crossing;
}

// Outward normal of the box's face that is nearest to a point; the box is centred at the origin.
template <class Real>
PT_HD inline Vec3<Real> nearest_face(const Vec3<Real>& half, const Vec3<Real>& p) {
    const Real x = half.x - absolute(p.x);
    const Real y = half.y - absolute(p.y);
    const Real z = half.z - absolute(p.z);
    if (x <= y && x <= z) {
        return {p.x < Real(0) ? Real(-1) : Real(1), Real(0), Real(0)};
    }
    return y <= z ? Vec3<Real>{Real(0), p.y < Real(0) ? Real(-1) : Real(1), Real(0)}
                  : Vec3<Real>{Real(0), Real(0), p.z < Real(0) ? Real(-1) : Real(1)};
}

// Textbook Fresnel reflectance, from the cosines on both sides of the boundary, which come from 1 - cos^2. As for
// fresnel() of kernels/boundary.h, q = n cos(theta_t) with n = index ahead / index behind.
template <class Real>
struct Fresnel {
    Real reflectance, q;
};
template <class Real>
PT_HD inline Fresnel<Real> fresnel(Real relative_ior, Real cosine) {
    const Real sine = square_root(max(Real(0), Real(1) - cosine * cosine)) / relative_ior;
    if (sine >= Real(1)) {
        return {Real(1), Real(0)};
    }
    const Real beyond = square_root(max(Real(0), Real(1) - sine * sine));
    const Real parallel = (relative_ior * cosine - beyond) / (relative_ior * cosine + beyond);
    const Real perpendicular = (cosine - relative_ior * beyond) / (cosine + relative_ior * beyond);
    return {(parallel * parallel + perpendicular * perpendicular) / Real(2), relative_ior * beyond};
}

}  // namespace pt::naive
