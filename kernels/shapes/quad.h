// Quads: two-sided rectangles of any place and orientation. A ray that starts on a quad never hits it again.
#pragma once

#include "kernels/light_sampling.h"
#include "kernels/naive.h"

namespace pt {

template <class Real>
struct Quad {
    Vec3<Real> centre;
    Vec3<Real> normal;          // unit normal of the quad, on the side that faces +y before the rotation
    Vec3<Real> axis_u, axis_v;  // unit vectors along the sides of the quad
    Real half_u, half_v;

    static constexpr const char* file_name = "quad";
    static constexpr bool is_flat = true;
    static constexpr UnitShape unit_shape = UnitShape::quad;
    static bool is_kind_of(const Placement&) { return true; }
    static Quad placed(const Placement& object) {
        return {rounded_to<Real>(object.centre),         rounded_to<Real>(object.column[1]),
                rounded_to<Real>(object.column[0]),      rounded_to<Real>(object.column[2]),
                static_cast<Real>(0.5 * object.scale.x), static_cast<Real>(0.5 * object.scale.z)};
    }
    static bool contains(const Vec3<double>&) { return false; }
};

// Intersects a ray with a quad: the ray parameter of its plane, within its edges. The edges reach out by gamma(16)
// times the lengths that form the hit point, a bound on its rounding, so that quads which share an edge leave no gap
// between them.
template <class Real>
PT_HD inline Interval<Real> interval(const Quad<Real>& quad, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Vec3<Real> to_centre = quad.centre - origin;
    const Real t = dot(to_centre, quad.normal) / dot(direction, quad.normal);
    const Vec3<Real> p = direction * t - to_centre;
    const Real reach = gamma<Real>(16) * (absolute(t) + quad.half_u + quad.half_v);
    const bool within =
        absolute(dot(p, quad.axis_u)) <= quad.half_u + reach && absolute(dot(p, quad.axis_v)) <= quad.half_v + reach;
    return {t, t, within};
}

// Moves the hit point onto the quad and inside its edges by a bound on its rounding: a path that starts in the corner
// of a room must be in front of the neighbour's plane, not on it or behind it, or it would leave through the edge.
template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Quad<Real>& quad, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    const Vec3<Real> p = (origin - quad.centre) + direction * t;
    const Real margin = gamma<Real>(16) * (absolute(quad.centre.x) + absolute(quad.centre.y) + absolute(quad.centre.z) +
                                           quad.half_u + quad.half_v);
    const Real reach_u = max(Real(0), quad.half_u - margin);
    const Real reach_v = max(Real(0), quad.half_v - margin);
    const Real u = clamp(dot(p, quad.axis_u), -reach_u, reach_u);
    const Real v = clamp(dot(p, quad.axis_v), -reach_v, reach_v);
    return {quad.centre + quad.axis_u * u + quad.axis_v * v, quad.normal};
}

template <class Real>
PT_HD inline LightSample<Real> sample_point(const Quad<Real>& quad, Real u, Real v, Real) {
    const Real a = (Real(2) * u - Real(1)) * quad.half_u;
    const Real b = (Real(2) * v - Real(1)) * quad.half_v;
    return {quad.centre + quad.axis_u * a + quad.axis_v * b, quad.normal, Real(4) * quad.half_u * quad.half_v};
}

template <class Real>
PT_HD inline SeenBox<Real> seen_from(const Quad<Real>& quad, const Vec3<Real>& observer) {
    const Vec3<Real> from_centre = observer - quad.centre;
    return {{dot(from_centre, quad.axis_u), dot(from_centre, quad.normal), dot(from_centre, quad.axis_v)},
            {quad.half_u, Real(0), quad.half_v}};
}

template <class Real>
PT_HD inline Vec3<Real> box_to_local(const Quad<Real>& quad, const Vec3<Real>& v) {
    return {dot(v, quad.axis_u), dot(v, quad.normal), dot(v, quad.axis_v)};
}
template <class Real>
PT_HD inline Vec3<Real> box_to_world(const Quad<Real>& quad, const Vec3<Real>& v) {
    return quad.axis_u * v.x + quad.normal * v.y + quad.axis_v * v.z;
}
template <class Real>
PT_HD inline BoxFrame<Real> box_frame(const Quad<Real>& quad, const Vec3<Real>& observer) {
    return {box_to_local(quad, observer - quad.centre), {quad.half_u, Real(0), quad.half_v}};
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const Quad<Real>& quad, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real distance) {
    return seen_from(quad, observer).inverse_pdf(distance);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Quad<Real>& quad, const Vec3<Real>& observer, Real u, Real v,
                                                    Real w) {
    DirectionSample<Real> sample = seen_from(quad, observer).sample(u, v, w);
    sample.direction =
        quad.axis_u * sample.direction.x + quad.normal * sample.direction.y + quad.axis_v * sample.direction.z;
    return sample;
}

template <class Real>
PT_HD inline Real area_of(const Quad<Real>& quad) {
    return Real(4) * quad.half_u * quad.half_v;
}

template <class Real>
PT_HD inline Real size_of(const Quad<Real>& quad) {
    return max(quad.half_u, quad.half_v);
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const Quad<Real>& quad) {
    Vec3<Real> half;
    for (int axis = 0; axis < 3; ++axis) {
        half[axis] = absolute(quad.axis_u[axis]) * quad.half_u + absolute(quad.axis_v[axis]) * quad.half_v;
    }
    return {quad.centre - half, quad.centre + half};
}

PT_HD inline Quad<double> widened(const Quad<float>& q) {
    return {widened(q.centre), widened(q.normal), widened(q.axis_u), widened(q.axis_v), q.half_u, q.half_v};
}

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const Quad<Real>& quad, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Real t = dot(quad.centre - origin, quad.normal) / dot(direction, quad.normal);
    const Vec3<Real> p = origin + direction * t - quad.centre;
    return {t, t, absolute(dot(p, quad.axis_u)) <= quad.half_u && absolute(dot(p, quad.axis_v)) <= quad.half_v};
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const Quad<Real>& quad, const Vec3<Real>&) {
    return quad.normal;
}

}  // namespace naive

}  // namespace pt
