// Rectangles: two-sided, anywhere. A ray that starts on a quad never meets it again.
#pragma once

#include "kernels/sphere.h"

namespace pt {

template <class Real>
struct Quad {
    Vec3<Real> centre;
    Vec3<Real> normal;          // unit; the side that faces +y before the rotation
    Vec3<Real> axis_u, axis_v;  // unit
    Real half_u, half_v;
};

// Ray parameter of the quad's plane within its edges. The edges reach out by gamma(16) times the lengths that the hit
// point is formed from, a bound on its rounding, so that two quads which share an edge leave no gap between them.
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

// The hit point pulled onto the quad, and inside its edges by the same bound: a path that starts in the corner of a
// room must stand before its neighbour's plane, not on it or behind it, or it would leave the room through the edge.
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

}  // namespace pt
