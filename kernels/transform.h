// Objects in the general form of CIS 565 path tracers: a unit box, unit sphere or unit quad under a 4x4 matrix. A ray
// is taken into the object's frame by the inverse matrix, intersected there, and the point taken back; normals go by
// the inverse transpose. Every object costs the same, whatever its shape could save.
#pragma once

#include "kernels/box.h"
#include "kernels/unit_sphere.h"

namespace pt {

template <class Real>
struct Transform {
    Vec3<Real> row[3];     // rows of the 3x3 part of the inverse of the object's matrix
    Vec3<Real> offset;     // last column of the inverse of the object's matrix (its translation)
    Vec3<Real> column[3];  // columns of the 3x3 part of the object's matrix
    Vec3<Real> centre;     // last column of the object's matrix (its translation), relative to the camera's eye
    UnitShape shape;

    PT_HD Vec3<Real> direction_to_local(const Vec3<Real>& v) const {
        return {dot(row[0], v), dot(row[1], v), dot(row[2], v)};
    }
    PT_HD Vec3<Real> point_to_local(const Vec3<Real>& p) const { return direction_to_local(p) + offset; }
    PT_HD Vec3<Real> point_to_world(const Vec3<Real>& p) const {
        return column[0] * p.x + column[1] * p.y + column[2] * p.z + centre;
    }
    PT_HD Vec3<Real> normal_to_world(const Vec3<Real>& n) const {
        return normalize(row[0] * n.x + row[1] * n.y + row[2] * n.z);
    }
};

// Where a ray meets the unit quad, as in kernels/shapes/quad.h: its edges are widened by the hit point's rounding.
template <class Real>
PT_HD inline Interval<Real> unit_quad_interval(const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Real t = -origin.y / direction.y;
    const Vec3<Real> p = origin + direction * t;
    const Real reach = Real(0.5) + gamma<Real>(16) * (absolute(origin.x) + absolute(origin.z) +
                                                      (absolute(direction.x) + absolute(direction.z)) * absolute(t));
    return {t, t, absolute(p.x) <= reach && absolute(p.z) <= reach};
}

template <class Real>
PT_HD inline Interval<Real> interval(const Transform<Real>& object, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    const Vec3<Real> o = object.point_to_local(origin);
    const Vec3<Real> d = object.direction_to_local(direction);
    if (object.shape == UnitShape::sphere) {
        return unit_sphere_interval(o * Real(2), d * Real(2));
    }
    if (object.shape == UnitShape::quad) {
        return unit_quad_interval(o, d);
    }
    return slab_interval(Vec3<Real>(Real(-0.5)), Vec3<Real>(Real(0.5)), o,
                         Vec3<Real>(Real(1) / d.x, Real(1) / d.y, Real(1) / d.z));
}

// The distance through a convex body for a ray that starts on it and runs inside.
template <class Real>
PT_HD inline Real chord(const Transform<Real>& object, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    if (object.shape == UnitShape::sphere) {
        return unit_sphere_chord(object.point_to_local(origin) * Real(2),
                                 object.direction_to_local(direction) * Real(2));
    }
    return max(interval(object, origin, direction).far, Real(0));
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Transform<Real>& object, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool inside) {
    const Vec3<Real> o = object.point_to_local(origin);
    const Vec3<Real> d = object.direction_to_local(direction);
    const Vec3<Real> p = o + d * t;
    if (object.shape == UnitShape::sphere) {
        const Vec3<Real> f = normalize(p);
        return {object.point_to_world(f * Real(0.5)), object.normal_to_world(f)};
    }
    if (object.shape == UnitShape::quad) {
        // The point is kept inside the quad's edges by the bound on its rounding, as in kernels/shapes/quad.h.
        const Real reach =
            Real(0.5) - gamma<Real>(16) * (absolute(object.offset.x) + absolute(object.offset.z) + Real(1));
        const Real inner = max(Real(0), reach);
        return {object.point_to_world({clamp(p.x, -inner, inner), Real(0), clamp(p.z, -inner, inner)}),
                object.normal_to_world({Real(0), Real(1), Real(0)})};
    }
    const Vec3<Real> inverse(Real(1) / d.x, Real(1) / d.y, Real(1) / d.z);
    const SurfacePoint<Real> local = face_point(Vec3<Real>(Real(-0.5)), Vec3<Real>(Real(0.5)), o, inverse, inside, p);
    return {object.point_to_world(local.position), object.normal_to_world(local.normal)};
}

}  // namespace pt
