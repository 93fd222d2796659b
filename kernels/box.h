// Ray tests and light sampling of boxes: axis-aligned in scene coordinates, oriented in their own frame.
// Slab test of Kay and Kajiya with Ize's rounding bound ("Robust BVH Ray Traversal", JCGT 2(2), 2013): without the
// factor 1 + 2 gamma(3), 4 % of the rays through an edge miss (docs/numerics.md S21).
#pragma once

#include "kernels/shape.h"

namespace pt {

// Slab test of a ray against the box [low, high]. The entry and exit planes are chosen by the sign of the direction,
// and every comparison is arranged so that a NaN (0 * infinity: the ray lies in a face's plane) is skipped.
template <class Real>
PT_HD inline Interval<Real> slab_interval(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                                          const Vec3<Real>& inverse) {
    const Real near_x = ((inverse.x < Real(0) ? high.x : low.x) - origin.x) * inverse.x;
    const Real near_y = ((inverse.y < Real(0) ? high.y : low.y) - origin.y) * inverse.y;
    const Real near_z = ((inverse.z < Real(0) ? high.z : low.z) - origin.z) * inverse.z;
    const Real far_x = ((inverse.x < Real(0) ? low.x : high.x) - origin.x) * inverse.x;
    const Real far_y = ((inverse.y < Real(0) ? low.y : high.y) - origin.y) * inverse.y;
    const Real far_z = ((inverse.z < Real(0) ? low.z : high.z) - origin.z) * inverse.z;
    Real near = -std::numeric_limits<Real>::infinity();
    near = keep_larger(near, near_x);
    near = keep_larger(near, near_y);
    near = keep_larger(near, near_z);
    Real far = std::numeric_limits<Real>::infinity();
    far = keep_smaller(far, far_x);
    far = keep_smaller(far, far_y);
    far = keep_smaller(far, far_z);
    return {near, far, near <= far * (Real(1) + Real(2) * gamma<Real>(3))};
}

// slab_interval for a reciprocal direction without infinite entries. No product is NaN then, so the nearer plane of
// each pair is simply the one with the smaller distance.
template <class Real>
PT_HD inline Interval<Real> finite_slab_interval(const Vec3<Real>& low, const Vec3<Real>& high,
                                                 const Vec3<Real>& origin, const Vec3<Real>& inverse) {
    const Vec3<Real> to_low = (low - origin) * inverse;
    const Vec3<Real> to_high = (high - origin) * inverse;
    const Real near = keep_larger(keep_larger(keep_smaller(to_low.x, to_high.x), keep_smaller(to_low.y, to_high.y)),
                                  keep_smaller(to_low.z, to_high.z));
    const Real far = keep_smaller(keep_smaller(keep_larger(to_low.x, to_high.x), keep_larger(to_low.y, to_high.y)),
                                  keep_larger(to_low.z, to_high.z));
    return {near, far, near <= far * (Real(1) + Real(2) * gamma<Real>(3))};
}

// Whether all entries of a vector's reciprocal are far from infinite.
template <class Real>
PT_HD inline bool has_finite_reciprocal(const Vec3<Real>& v) {
    return keep_smaller(keep_smaller(absolute(v.x), absolute(v.y)), absolute(v.z)) >= Real(0x1p-100);
}

// Component-wise reciprocal of a vector whose length is at most 1 but for rounding; infinite where a component is 0.
template <class Real>
PT_HD inline Vec3<Real> reciprocal(const Vec3<Real>& v) {
    if (has_finite_reciprocal(v)) {
        return {reciprocal_in_range(v.x), reciprocal_in_range(v.y), reciprocal_in_range(v.z)};
    }
    return {Real(1) / v.x, Real(1) / v.y, Real(1) / v.z};
}

// Axis of the face through which a ray enters (or leaves, if `inside`) the box [low, high]. The products are those that
// slab_interval forms, so the axis cannot contradict the hit.
template <class Real>
PT_HD inline int crossed_axis(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                              const Vec3<Real>& inverse, bool inside) {
    const bool x_low = (inverse.x < Real(0)) == inside;
    const bool y_low = (inverse.y < Real(0)) == inside;
    const bool z_low = (inverse.z < Real(0)) == inside;
    const Real x = ((x_low ? low.x : high.x) - origin.x) * inverse.x;
    const Real y = ((y_low ? low.y : high.y) - origin.y) * inverse.y;
    const Real z = ((z_low ? low.z : high.z) - origin.z) * inverse.z;
    int axis = 0;
    Real best = inside ? std::numeric_limits<Real>::infinity() : -std::numeric_limits<Real>::infinity();
    if (inside ? x < best : x > best) {
        best = x;
    }
    if (inside ? y < best : y > best) {
        best = y;
        axis = 1;
    }
    if (inside ? z < best : z > best) {
        axis = 2;
    }
    return axis;
}

// Moves a hit point p onto the face of a box that the ray crosses, within its edges, and gives its outward normal.
template <class Real>
PT_HD inline SurfacePoint<Real> face_point(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                                           const Vec3<Real>& inverse, bool inside, const Vec3<Real>& p) {
    const int axis = crossed_axis(low, high, origin, inverse, inside);
    SurfacePoint<Real> point{{clamp(p.x, low.x, high.x), clamp(p.y, low.y, high.y), clamp(p.z, low.z, high.z)},
                             {Real(0), Real(0), Real(0)}};
    if (axis == 0) {
        const bool is_low = (inverse.x < Real(0)) == inside;
        point.position.x = is_low ? low.x : high.x;
        point.normal.x = is_low ? Real(-1) : Real(1);
    } else if (axis == 1) {
        const bool is_low = (inverse.y < Real(0)) == inside;
        point.position.y = is_low ? low.y : high.y;
        point.normal.y = is_low ? Real(-1) : Real(1);
    } else {
        const bool is_low = (inverse.z < Real(0)) == inside;
        point.position.z = is_low ? low.z : high.z;
        point.normal.z = is_low ? Real(-1) : Real(1);
    }
    return point;
}

template <class Real>
PT_HD inline Real area_of_box(const Vec3<Real>& half) {
    return Real(8) * (half.y * half.z + half.z * half.x + half.x * half.y);
}

inline bool is_in_unit_box(const Vec3<double>& p) {
    return absolute(p.x) < 0.5 && absolute(p.y) < 0.5 && absolute(p.z) < 0.5;
}

// Samples a point on a box centred at the origin, uniformly by area; w chooses the face.
template <class Real>
PT_HD inline LightSample<Real> sample_box(const Vec3<Real>& half, Real u, Real v, Real w) {
    const Real yz = half.y * half.z;
    const Real zx = half.z * half.x;
    const Real xy = half.x * half.y;
    const Real total = yz + zx + xy;
    Real pick = w * Real(2);  // in [0, 2): integer part chooses the box's low or high side, fraction the axis
    const bool high = pick >= Real(1);
    pick = (high ? pick - Real(1) : pick) * total;
    const Real side = high ? Real(1) : Real(-1);
    const Real a = Real(2) * u - Real(1);
    const Real b = Real(2) * v - Real(1);
    const Real inverse_density = Real(8) * total;
    if (pick < yz) {
        return {{side * half.x, a * half.y, b * half.z}, {side, Real(0), Real(0)}, inverse_density};
    }
    if (pick < yz + zx) {
        return {{a * half.x, side * half.y, b * half.z}, {Real(0), side, Real(0)}, inverse_density};
    }
    return {{a * half.x, b * half.y, side * half.z}, {Real(0), Real(0), side}, inverse_density};
}

}  // namespace pt
