// Spheres, and NearSphere for spheres near the camera, as a ground sphere beneath it. kernels/unit_sphere.h explains
// why the discriminant and the roots are formed as they are.
#pragma once

#include "kernels/naive.h"
#include "kernels/solid_angle.h"
#include "kernels/unit_sphere.h"

namespace pt {

template <class Real>
struct Sphere {
    Vec3<Real> centre;
    Real radius;
    Real inverse_radius;
    Real eye_power = Real(0);       // power of the eye with respect to the sphere (power_at), for NearSphere
    std::uint32_t is_near_eye = 0;  // 1: the sphere is intersected as a NearSphere

    static constexpr const char* file_name = "sphere";
    static constexpr bool is_flat = false;
    static constexpr bool misses_at_zero = true;  // interval() gives a ray that misses distance 0 (kernels/intersect.h)
    static constexpr UnitShape unit_shape = UnitShape::sphere;
    static bool is_kind_of(const Placement& object) {
        return object.scale.x == object.scale.y && object.scale.y == object.scale.z;
    }
    static Sphere placed(const Placement& object) {
        return {rounded_to<Real>(object.centre), static_cast<Real>(0.5 * object.scale.x),
                static_cast<Real>(2.0 / object.scale.x)};
    }
    static bool contains(const Vec3<double>& p) { return dot(p, p) < 0.25; }
};

// A sphere in a kernel with Feature::near_sphere. If the eye is near the sphere, as above a ground sphere, |f|^2 - 1 of
// a ray origin f in the sphere's frame keeps only the digits of the height. But it is the power of the origin with
// respect to the sphere, which follows from the eye's, formed at load in doubled precision: positions are relative to
// the eye, so |o - c|^2 - r^2 = (|c|^2 - r^2) + o.(o - 2 c), and all terms are small near the eye.
template <class Real>
struct NearSphere : Sphere<Real> {};

// A sphere's frame only moves and scales evenly, so the ray direction stays a unit vector. Its square is 1 but for
// rounding, which would move t by no more than the direction's own rounding moves the point.
template <class Real>
PT_HD inline Interval<Real> interval(const Sphere<Real>& sphere, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    const Vec3<Real> f = (origin - sphere.centre) * sphere.inverse_radius;
    const Real b = -dot(f, direction);
    const Vec3<Real> closest = f + direction * b;
    const Real discriminant = Real(1) - dot(closest, closest);
    if (!(discriminant > Real(0))) {
        return {Real(0), Real(0), false};
    }
    // The discriminant is 1 - d with d >= 0: if not 0, it is at least the last bit of 1 or of d, in range for the root.
    const Real root = nearly_square_root_in_range(discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real other = nearly_divide(dot(f, f) - Real(1), q);
    return {keep_smaller(q, other) * sphere.radius, keep_larger(q, other) * sphere.radius, true};
}

// The power of a point with respect to a sphere near the eye, in square radii.
template <class Real>
PT_HD inline Real power_at(const Sphere<Real>& sphere, const Vec3<Real>& point) {
    const Vec3<Real> p = point * sphere.inverse_radius;
    return dot(p, p - sphere.centre * (Real(2) * sphere.inverse_radius)) + sphere.eye_power;
}

template <class Real>
PT_HD inline Interval<Real> interval(const NearSphere<Real>& sphere, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    if (sphere.is_near_eye == 0) {
        return interval<Real>(static_cast<const Sphere<Real>&>(sphere), origin, direction);
    }
    const Real b = -dot((origin - sphere.centre) * sphere.inverse_radius, direction);
    const Real power = power_at(sphere, origin);
    const Real discriminant = b * b - power;
    if (!(discriminant > Real(0))) {
        return {Real(0), Real(0), false};
    }
    const Real root = square_root(discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real other = power / q;
    return {keep_smaller(q, other) * sphere.radius, keep_larger(q, other) * sphere.radius, true};
}

template <class Real>
PT_HD inline Real chord(const Sphere<Real>& sphere, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return max(Real(0), Real(-2) * dot((origin - sphere.centre) * sphere.inverse_radius, direction)) * sphere.radius;
}

template <class Real>
PT_HD inline Real chord(const NearSphere<Real>& sphere, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return chord(static_cast<const Sphere<Real>&>(sphere), origin, direction);
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Sphere<Real>& sphere, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    const Vec3<Real> normal = nearly_unit(((origin - sphere.centre) + direction * t) * sphere.inverse_radius);
    return {sphere.centre + normal * sphere.radius, normal};
}

// A sphere near the eye may be too wide to be measured from its centre, so the hit point is pulled along the normal.
template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const NearSphere<Real>& sphere, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    if (sphere.is_near_eye == 0) {
        return surface_point<Real>(static_cast<const Sphere<Real>&>(sphere), origin, direction, t);
    }
    const Vec3<Real> point = origin + direction * t;
    const Vec3<Real> normal = nearly_unit((point - sphere.centre) * sphere.inverse_radius);
    return {point - normal * (Real(0.5) * power_at(sphere, point) * sphere.radius), normal};
}

template <class Real>
PT_HD inline LightSample<Real> sample_point(const Sphere<Real>& sphere, Real u, Real v, Real) {
    const Vec3<Real> normal = uniform_sphere(u, v);
    return {sphere.centre + normal * sphere.radius, normal, Real(4) * pi<Real> * sphere.radius * sphere.radius};
}

template <class Real>
PT_HD inline Cone<Real> cone_of(const Sphere<Real>& sphere, const Vec3<Real>& to_centre) {
    return Cone<Real>(sphere.radius / square_root(dot(to_centre, to_centre)));
}

// 1 / pdf, by solid angle, of directions towards a sphere: constant within the cone in which the sphere is seen.
template <class Real>
PT_HD inline Real inverse_direction_pdf(const Sphere<Real>& sphere, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real) {
    return cone_of(sphere, sphere.centre - observer).inverse_pdf();
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Sphere<Real>& sphere, const Vec3<Real>& observer, Real u,
                                                    Real v, Real) {
    const Vec3<Real> to_centre = sphere.centre - observer;
    const Cone<Real> cone = cone_of(sphere, to_centre);
    return {along(to_centre, cone.direction(u, v)), cone.inverse_pdf()};
}

template <class Real>
PT_HD inline Real area_of(const Sphere<Real>& sphere) {
    return Real(4) * pi<Real> * sphere.radius * sphere.radius;
}

template <class Real>
PT_HD inline Real size_of(const Sphere<Real>& sphere) {
    return sphere.radius;
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const Sphere<Real>& sphere) {
    return {sphere.centre - Vec3<Real>(sphere.radius), sphere.centre + Vec3<Real>(sphere.radius)};
}

PT_HD inline Sphere<double> widened(const Sphere<float>& s) {
    return {widened(s.centre), s.radius, 1.0 / static_cast<double>(s.radius), s.eye_power, s.is_near_eye};
}

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const Sphere<Real>& sphere, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    const Vec3<Real> f = origin - sphere.centre;
    return roots(dot(direction, direction), Real(2) * dot(f, direction), dot(f, f) - sphere.radius * sphere.radius);
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const Sphere<Real>& sphere, const Vec3<Real>& p) {
    return normalize(p - sphere.centre);
}

// 1 - cos of the half angle of the cone in which a sphere is seen, in the textbook's form; 2 from inside.
template <class Real>
PT_HD inline Real one_minus_cosine(const Sphere<Real>& sphere, const Vec3<Real>& to_centre) {
    const Real sine_squared = sphere.radius * sphere.radius / dot(to_centre, to_centre);
    return sine_squared < Real(1) ? Real(1) - square_root(Real(1) - sine_squared) : Real(2);
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const Sphere<Real>& sphere, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real) {
    return Real(2) * pi<Real> * one_minus_cosine(sphere, sphere.centre - observer);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Sphere<Real>& sphere, const Vec3<Real>& observer, Real u,
                                                    Real v, Real) {
    const Vec3<Real> to_centre = sphere.centre - observer;
    const Real below = one_minus_cosine(sphere, to_centre);
    const Real cosine = Real(1) - u * below;
    const Real sine = square_root(max(Real(0), Real(1) - cosine * cosine));
    const SinCos<Real> azimuth = sin_cos_turn(v);
    return {along(to_centre, {sine * azimuth.cosine, sine * azimuth.sine, cosine}), Real(2) * pi<Real> * below};
}

}  // namespace naive

}  // namespace pt
