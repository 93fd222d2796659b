// The textbook forms that the robust ones of sphere.h, box.h, quad.h, dielectric.h and solid_angle.h are measured
// against (axis `robustness`): a fixed epsilon instead of the surface that a ray departed from, the school formula of
// the sphere, slabs without Ize's factor, points left where rounding put them, 1 - cos of a cone, Fresnel from
// 1 - cos^2. They are what renderers of a first course have (Shirley, "Ray Tracing in One Weekend"; CIS 565).
#pragma once

#include "kernels/scene_view.h"
#include "kernels/solid_angle.h"

namespace pt::naive {

// Scene units, whatever the scene's size.
template <class Real>
inline constexpr Real epsilon = Real(1e-4);

// t with a t^2 + b t + c = 0.
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
PT_HD inline Interval<Real> interval(const Sphere<Real>& sphere, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    const Vec3<Real> f = origin - sphere.centre;
    return roots(dot(direction, direction), Real(2) * dot(f, direction), dot(f, f) - sphere.radius * sphere.radius);
}

template <class Real>
PT_HD inline Interval<Real> interval(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Vec3<Real> f = e.to_unit(origin - e.centre);
    const Vec3<Real> g = e.to_unit(direction);
    return roots(dot(g, g), Real(2) * dot(f, g), dot(f, f) - Real(1));
}

template <class Real>
PT_HD inline Interval<Real> slabs(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                                  const Vec3<Real>& direction) {
    Interval<Real> crossing = slab_interval(
        low, high, origin, Vec3<Real>(Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z));
    crossing.hits = crossing.near <= crossing.far;
    return crossing;
}

template <class Real>
PT_HD inline Interval<Real> interval(const AxisBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return slabs(box.low, box.high, origin, direction);
}

template <class Real>
PT_HD inline Interval<Real> interval(const OrientedBox<Real>& box, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    return slabs(-box.half, box.half, box.to_local(origin - box.centre), box.to_local(direction));
}

template <class Real>
PT_HD inline Interval<Real> interval(const Quad<Real>& quad, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Real t = dot(quad.centre - origin, quad.normal) / dot(direction, quad.normal);
    const Vec3<Real> p = origin + direction * t - quad.centre;
    return {t, t, absolute(dot(p, quad.axis_u)) <= quad.half_u && absolute(dot(p, quad.axis_v)) <= quad.half_v};
}

// The outward normal of the face that a point of a box around 0 is nearest to.
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

template <class Real>
PT_HD inline Vec3<Real> normal_at(const Sphere<Real>& sphere, const Vec3<Real>& p) {
    return normalize(p - sphere.centre);
}
template <class Real>
PT_HD inline Vec3<Real> normal_at(const Ellipsoid<Real>& e, const Vec3<Real>& p) {
    return e.normal(e.to_unit(p - e.centre));
}
template <class Real>
PT_HD inline Vec3<Real> normal_at(const AxisBox<Real>& box, const Vec3<Real>& p) {
    return nearest_face((box.high - box.low) * Real(0.5), p - (box.high + box.low) * Real(0.5));
}
template <class Real>
PT_HD inline Vec3<Real> normal_at(const OrientedBox<Real>& box, const Vec3<Real>& p) {
    return box.to_world(nearest_face(box.half, box.to_local(p - box.centre)));
}
template <class Real>
PT_HD inline Vec3<Real> normal_at(const Quad<Real>& quad, const Vec3<Real>&) {
    return quad.normal;
}

// The reflectance from the cosines on both sides of the boundary, and these from 1 - cos^2. As fresnel() of
// dielectric.h: q = n cos(theta_t), n = index ahead / index behind.
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

// A cone of directions towards a sphere: 1 - cos as it stands.
template <class Real>
PT_HD inline Real one_minus_cosine(const Sphere<Real>& sphere, const Vec3<Real>& to_centre) {
    const Real sine_squared = sphere.radius * sphere.radius / dot(to_centre, to_centre);
    return sine_squared < Real(1) ? Real(1) - square_root(Real(1) - sine_squared) : Real(2);
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const Sphere<Real>& sphere, const Vec3<Real>& observer) {
    return Real(2) * pi<Real> * one_minus_cosine(sphere, sphere.centre - observer);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Sphere<Real>& sphere, const Vec3<Real>& observer, Real u,
                                                    Real v) {
    const Vec3<Real> to_centre = sphere.centre - observer;
    const Real below = one_minus_cosine(sphere, to_centre);
    const Real cosine = Real(1) - u * below;
    const Real sine = square_root(max(Real(0), Real(1) - cosine * cosine));
    const SinCos<Real> azimuth = sin_cos_turn(v);
    return {along(to_centre, {sine * azimuth.cosine, sine * azimuth.sine, cosine}), Real(2) * pi<Real> * below};
}

}  // namespace pt::naive
