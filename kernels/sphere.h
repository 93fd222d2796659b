// Spheres and ellipsoids. Both are solved as a unit sphere in the object's own frame, so the arithmetic does not see
// the scene's scale. Discriminant and roots as in Haines, Günther and Akenine-Möller, "Precision Improvements for
// Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019.
// A ray that starts on the surface never uses an epsilon: it knows which root it starts from and takes the other one
// (docs/numerics.md S15: no self-hit and chords to 3e-7 for radii 1e-6 to 1e6).
#pragma once

#include "kernels/in_range.h"
#include "kernels/path.h"

namespace pt {

template <class Real>
struct Sphere {
    Vec3<Real> centre;
    Real radius;
    Real inverse_radius;
    Real eye_power = Real(0);       // of a NearSphere
    std::uint32_t is_near_eye = 0;  // 1: is to be treated as one
};

// A sphere in a kernel with Feature::near_sphere. Of a sphere that the eye is near, as the ground beneath it, |f|^2 - 1
// keeps only the digits in which the eye's height differs from none. But it is the power of the point with respect to
// the sphere, and that of any origin follows from the eye's, which is formed at load in doubled precision: positions
// are relative to the eye, so |o - c|^2 - r^2 = (|c|^2 - r^2) + o.(o - 2 c), and all terms are small near the eye.
template <class Real>
struct NearSphere : Sphere<Real> {};

// An affine image of the unit sphere: p = centre + to_world * f, with |f| = 1.
template <class Real>
struct Ellipsoid {
    Vec3<Real> centre;
    Vec3<Real> semi_axis[3];     // columns of to_world
    Vec3<Real> inverse_axis[3];  // rows of its inverse

    PT_HD Vec3<Real> to_unit(const Vec3<Real>& v) const {
        return {dot(inverse_axis[0], v), dot(inverse_axis[1], v), dot(inverse_axis[2], v)};
    }
    PT_HD Vec3<Real> to_world(const Vec3<Real>& f) const {
        return semi_axis[0] * f.x + semi_axis[1] * f.y + semi_axis[2] * f.z;
    }
    // Normals go by the inverse transpose.
    PT_HD Vec3<Real> normal(const Vec3<Real>& f) const {
        return normalize(inverse_axis[0] * f.x + inverse_axis[1] * f.y + inverse_axis[2] * f.z);
    }
};

// Where a line enters and leaves a convex body, in ray parameter. No hit: hits == false.
template <class Real>
struct Interval {
    Real near, far;
    bool hits;
};

// The unit sphere, for a ray f + t g; g of any length.
template <class Real>
PT_HD inline Interval<Real> unit_sphere_interval(const Vec3<Real>& f, const Vec3<Real>& g) {
    const Real a = dot(g, g);
    const Real b = -dot(f, g);
    const Vec3<Real> closest = f + g * (b / a);
    const Real discriminant = Real(1) - dot(closest, closest);
    if (!(discriminant > Real(0))) {
        return {Real(0), Real(0), false};
    }
    const Real root = square_root(a * discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real first = (dot(f, f) - Real(1)) / q;
    const Real second = q / a;
    return {min(first, second), max(first, second), true};
}

// The second root for a ray that starts on the unit sphere and runs inside it: t = -2 f.g / g.g.
template <class Real>
PT_HD inline Real unit_sphere_chord(const Vec3<Real>& f, const Vec3<Real>& g) {
    return max(Real(0), Real(-2) * dot(f, g) / dot(g, g));
}

// A sphere's frame only moves and scales evenly, so the direction stays a unit vector: its square, 1 but for rounding,
// would move t by no more than the direction's own rounding moves the point.
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
    // One less a number up to 1: if it is not 0, it is no less than that number's last bit.
    const Real root = square_root_in_range(discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real other = (dot(f, f) - Real(1)) / q;
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
PT_HD inline Interval<Real> interval(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return unit_sphere_interval(e.to_unit(origin - e.centre), e.to_unit(direction));
}

template <class Real>
PT_HD inline Real chord(const Sphere<Real>& sphere, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return max(Real(0), Real(-2) * dot((origin - sphere.centre) * sphere.inverse_radius, direction)) * sphere.radius;
}

template <class Real>
PT_HD inline Real chord(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return unit_sphere_chord(e.to_unit(origin - e.centre), e.to_unit(direction));
}

// A point pulled back onto the surface, with the outward unit normal there.
template <class Real>
struct SurfacePoint {
    Vec3<Real> position, normal;
};

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Sphere<Real>& sphere, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    const Vec3<Real> normal = nearly_unit(((origin - sphere.centre) + direction * t) * sphere.inverse_radius);
    return {sphere.centre + normal * sphere.radius, normal};
}

// A sphere that is near the eye may be too wide to be measured from its centre: the point is pulled along the normal.
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
PT_HD inline SurfacePoint<Real> surface_point(const Ellipsoid<Real>& e, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    const Vec3<Real> f = normalize(e.to_unit((origin - e.centre) + direction * t));
    return {e.centre + e.to_world(f), e.normal(f)};
}

}  // namespace pt
