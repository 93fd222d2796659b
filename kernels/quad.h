// Rectangles: two-sided, anywhere. A ray that starts on a quad never meets it again.
#pragma once

#include "kernels/sphere.h"

namespace pt {

template <class Real>
struct Quad {
    Vec3<Real> centre;
    Vec3<Real> normal;            // unit; the side that faces +y before the rotation
    Vec3<Real> axis_u, axis_v;    // unit
    Real half_u, half_v;
};

// Ray parameter of the quad's plane within its edges. The edges reach out by gamma(16) relative, the bound on the rounding
// of the hit point, so that two quads which share an edge leave no gap between them.
template <class Real>
PT_HD inline Interval<Real> interval(const Quad<Real>& quad, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Vec3<Real> to_centre = quad.centre - origin;
    const Real t = dot(to_centre, quad.normal) / dot(direction, quad.normal);
    const Vec3<Real> p = direction * t - to_centre;
    const Real reach = Real(1) + gamma<Real>(16);
    const bool within = absolute(dot(p, quad.axis_u)) <= quad.half_u * reach && absolute(dot(p, quad.axis_v)) <= quad.half_v * reach;
    return {t, t, within};
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Quad<Real>& quad, const Vec3<Real>& origin, const Vec3<Real>& direction,
                                              Real t) {
    const Vec3<Real> p = (origin - quad.centre) + direction * t;
    const Real u = clamp(dot(p, quad.axis_u), -quad.half_u, quad.half_u);
    const Real v = clamp(dot(p, quad.axis_v), -quad.half_v, quad.half_v);
    return {quad.centre + quad.axis_u * u + quad.axis_v * v, quad.normal};
}

}  // namespace pt
