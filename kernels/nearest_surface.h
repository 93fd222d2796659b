// Outward normal at the point of a body's surface that is nearest to a point inside the body.
#pragma once

#include "kernels/shapes.h"

namespace pt {

// Shapes that cannot tell which point of their surface is nearest return the outward normal that is known already.
template <class Shape, class Real>
PT_HD inline Vec3<Real> outward_near(const Shape&, const Vec3<Real>&, const Vec3<Real>& known) {
    return known;
}

template <class Real>
PT_HD inline Vec3<Real> outward_near(const Sphere<Real>& sphere, const Vec3<Real>& point, const Vec3<Real>& known) {
    const Vec3<Real> from_centre = (point - sphere.centre) * sphere.inverse_radius;
    return dot(from_centre, from_centre) > Real(0x1p-40) ? normalize(from_centre) : known;
}

// Normal where a ray from an ellipsoid's centre through the point leaves: close to the surface, the nearest point.
template <class Real>
PT_HD inline Vec3<Real> outward_near(const Ellipsoid<Real>& ellipsoid, const Vec3<Real>& point,
                                     const Vec3<Real>& known) {
    const Vec3<Real> from_centre = ellipsoid.to_unit(point - ellipsoid.centre);
    return dot(from_centre, from_centre) > Real(0x1p-40) ? ellipsoid.normal(normalize(from_centre)) : known;
}

// The outward normal of a box's nearest face in the box's own frame, for a point p from the box's centre.
template <class Real>
PT_HD inline Vec3<Real> nearest_face(const Vec3<Real>& half, const Vec3<Real>& p) {
    const Real x = half.x - absolute(p.x), y = half.y - absolute(p.y), z = half.z - absolute(p.z);
    const auto side = [](Real along) { return along < Real(0) ? Real(-1) : Real(1); };
    return x <= y && x <= z ? Vec3<Real>{side(p.x), Real(0), Real(0)}
           : y <= z         ? Vec3<Real>{Real(0), side(p.y), Real(0)}
                            : Vec3<Real>{Real(0), Real(0), side(p.z)};
}
template <class Real>
PT_HD inline Vec3<Real> outward_near(const AxisBox<Real>& box, const Vec3<Real>& point, const Vec3<Real>&) {
    return nearest_face((box.high - box.low) * Real(0.5), point - (box.high + box.low) * Real(0.5));
}
template <class Real>
PT_HD inline Vec3<Real> outward_near(const OrientedBox<Real>& box, const Vec3<Real>& point, const Vec3<Real>&) {
    return box.to_world(nearest_face(box.half, box.to_local(point - box.centre)));
}

}  // namespace pt
