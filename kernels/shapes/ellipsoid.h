// Ellipsoids: affine images of the unit sphere.
#pragma once

#include "kernels/naive.h"
#include "kernels/solid_angle.h"
#include "kernels/unit_sphere.h"

namespace pt {

// An ellipsoid as the affine image p = centre + to_world * f of the unit sphere |f| = 1.
template <class Real>
struct Ellipsoid {
    Vec3<Real> centre;
    Vec3<Real> semi_axis[3];     // columns of the matrix from the unit sphere to the scene: the ellipsoid's semi-axes
    Vec3<Real> inverse_axis[3];  // rows of the matrix from the scene to the ellipsoid's unit sphere

    PT_HD Vec3<Real> to_unit(const Vec3<Real>& v) const {
        return {dot(inverse_axis[0], v), dot(inverse_axis[1], v), dot(inverse_axis[2], v)};
    }
    PT_HD Vec3<Real> to_world(const Vec3<Real>& f) const {
        return semi_axis[0] * f.x + semi_axis[1] * f.y + semi_axis[2] * f.z;
    }
    // Outward normal at the image of the unit sphere's point f; normals transform by the inverse transpose.
    PT_HD Vec3<Real> normal(const Vec3<Real>& f) const {
        return normalize(inverse_axis[0] * f.x + inverse_axis[1] * f.y + inverse_axis[2] * f.z);
    }

    static constexpr const char* file_name = "sphere";
    static constexpr bool is_flat = false;
    static constexpr UnitShape unit_shape = UnitShape::sphere;
    static bool is_kind_of(const Placement&) { return true; }
    static Ellipsoid placed(const Placement& object) {
        Ellipsoid ellipsoid{};
        ellipsoid.centre = rounded_to<Real>(object.centre);
        for (int axis = 0; axis < 3; ++axis) {
            ellipsoid.semi_axis[axis] = rounded_to<Real>(object.column[axis] * (0.5 * object.scale[axis]));
            ellipsoid.inverse_axis[axis] = rounded_to<Real>(object.column[axis] / (0.5 * object.scale[axis]));
        }
        return ellipsoid;
    }
    static bool contains(const Vec3<double>& p) { return dot(p, p) < 0.25; }
};

template <class Real>
PT_HD inline Interval<Real> interval(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return unit_sphere_interval(e.to_unit(origin - e.centre), e.to_unit(direction));
}

template <class Real>
PT_HD inline Real chord(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return unit_sphere_chord(e.to_unit(origin - e.centre), e.to_unit(direction));
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const Ellipsoid<Real>& e, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool = false) {
    const Vec3<Real> f = normalize(e.to_unit((origin - e.centre) + direction * t));
    return {e.centre + e.to_world(f), e.normal(f)};
}

// Samples an ellipsoid by a uniform point on the unit sphere. The area element of the image is the length of the
// cofactor matrix times f, which points along the normal. The matrix's columns are products of two lengths: they stay
// in range where a determinant (three) or a square (four) leaves it, from 1e-18 to 1e18 scene units.
template <class Real>
PT_HD inline LightSample<Real> sample_point(const Ellipsoid<Real>& e, Real u, Real v, Real) {
    const Vec3<Real> f = uniform_sphere(u, v);
    const Vec3<Real> normal = e.normal(f);
    const Vec3<Real> cofactor = cross(e.semi_axis[1], e.semi_axis[2]) * f.x +
                                cross(e.semi_axis[2], e.semi_axis[0]) * f.y +
                                cross(e.semi_axis[0], e.semi_axis[1]) * f.z;
    return {e.centre + e.to_world(f), normal, Real(4) * pi<Real> * dot(cofactor, normal)};
}

// Solid angle in the world over solid angle in the unit sphere's frame: |det| / length^3, with `length` that of the
// image of a unit vector. Each axis is divided by it first, so that no cube of a length arises.
template <class Real>
PT_HD inline Real ellipsoid_stretch(const Ellipsoid<Real>& e, Real length) {
    const Real inverse = Real(1) / length;
    return absolute(dot(e.semi_axis[0] * inverse, cross(e.semi_axis[1] * inverse, e.semi_axis[2] * inverse)));
}

template <class Real>
PT_HD inline Cone<Real> cone_of(const Ellipsoid<Real>&, const Vec3<Real>& to_centre_in_unit) {
    return Cone<Real>(Real(1) / square_root(dot(to_centre_in_unit, to_centre_in_unit)));
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const Ellipsoid<Real>& e, const Vec3<Real>& observer,
                                        const Vec3<Real>& direction, Real) {
    const Vec3<Real> in_unit = e.to_unit(direction);
    return cone_of(e, e.to_unit(e.centre - observer)).inverse_pdf() *
           ellipsoid_stretch(e, Real(1) / square_root(dot(in_unit, in_unit)));
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Ellipsoid<Real>& e, const Vec3<Real>& observer, Real u,
                                                    Real v, Real) {
    const Vec3<Real> to_centre = e.to_unit(e.centre - observer);
    const Cone<Real> cone = cone_of(e, to_centre);
    const Vec3<Real> image = e.to_world(along(to_centre, cone.direction(u, v)));
    const Real length = square_root(dot(image, image));
    return {image * (Real(1) / length), cone.inverse_pdf() * ellipsoid_stretch(e, length)};
}

template <class Real>
PT_HD inline Real size_of(const Ellipsoid<Real>& e) {
    return square_root(max(dot(e.semi_axis[0], e.semi_axis[0]),
                           max(dot(e.semi_axis[1], e.semi_axis[1]), dot(e.semi_axis[2], e.semi_axis[2]))));
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const Ellipsoid<Real>& e) {
    Vec3<Real> half;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3<Real> row{e.semi_axis[0][axis], e.semi_axis[1][axis], e.semi_axis[2][axis]};
        half[axis] = square_root(dot(row, row));
    }
    return {e.centre - half, e.centre + half};
}

// An ellipsoid in double. The inverse is formed anew: rounded to single precision it does not invert the axes.
PT_HD inline Ellipsoid<double> widened(const Ellipsoid<float>& e) {
    Ellipsoid<double> wide{
        widened(e.centre), {widened(e.semi_axis[0]), widened(e.semi_axis[1]), widened(e.semi_axis[2])}, {}};
    for (int i = 0; i < 3; ++i) {
        const Vec3<double> area = cross(wide.semi_axis[(i + 1) % 3], wide.semi_axis[(i + 2) % 3]);
        wide.inverse_axis[i] = area * (1.0 / dot(wide.semi_axis[i], area));
    }
    return wide;
}

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const Ellipsoid<Real>& e, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Vec3<Real> f = e.to_unit(origin - e.centre);
    const Vec3<Real> g = e.to_unit(direction);
    return roots(dot(g, g), Real(2) * dot(f, g), dot(f, f) - Real(1));
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const Ellipsoid<Real>& e, const Vec3<Real>& p) {
    return e.normal(e.to_unit(p - e.centre));
}

}  // namespace naive

}  // namespace pt
