// Directions towards a convex light, drawn by solid angle as seen from a point: a cone for spheres, the cone in its own
// frame for ellipsoids, spherical rectangles for the near faces of boxes and for quads. The weight of a sample is then
// bounded however near the light is, where sampling by area has weights that grow as 1 / distance^2 (a lamp that
// touches a ceiling gives that infinite variance). Far boxes and quads are sampled by projected area: their solid
// angle, a difference of angles, would lose its digits. Cone: Shirley, Wang and Zimmerman, "Monte Carlo Techniques for
// Direct Lighting Calculations", TOG 15(1), 1996. Rectangle: Ureña, Fajardo and King, "An Area-Preserving
// Parametrization for Spherical Rectangles", EGSR 2013, with its four angles as arc tangents and the division by a sine
// taken out.
#pragma once

#include "kernels/box.h"
#include "kernels/quad.h"
#include "kernels/sampling.h"

namespace pt {

// `inverse_pdf` is 1 / density by solid angle, at most 4 pi; 0: there is nothing to sample.
template <class Real>
struct DirectionSample {
    Vec3<Real> direction;  // unit
    Real inverse_pdf;
};

// What a unit sphere fills of the sky of a point at a distance: 2 pi (1 - cos) of a cone, everything from inside.
template <class Real>
struct Cone {
    Real one_minus_cosine;  // 2: the whole sphere of directions

    // `radius_over_distance` above 1: inside.
    PT_HD explicit Cone(Real radius_over_distance) : one_minus_cosine(Real(2)) {
        if (radius_over_distance < Real(1)) {
            const Real cosine = square_root((Real(1) - radius_over_distance) * (Real(1) + radius_over_distance));
            one_minus_cosine = radius_over_distance * radius_over_distance / (Real(1) + cosine);
        }
    }
    PT_HD Real inverse_pdf() const { return Real(2) * pi<Real> * one_minus_cosine; }
    // Around +z.
    PT_HD Vec3<Real> direction(Real u, Real v) const {
        const Real below = u * one_minus_cosine;
        const Real sine = square_root(max(Real(0), below * (Real(2) - below)));
        const SinCos<Real> azimuth = sin_cos_turn(v);
        return {sine * azimuth.cosine, sine * azimuth.sine, Real(1) - below};
    }
};

template <class Real>
PT_HD inline Cone<Real> cone_of(const Sphere<Real>& sphere, const Vec3<Real>& to_centre) {
    return Cone<Real>(sphere.radius / square_root(dot(to_centre, to_centre)));
}

// 1 / density of the directions that sample_direction gives, in the direction of a ray that meets the light after
// `distance`.
template <class Real>
PT_HD inline Real inverse_direction_pdf(const Sphere<Real>& sphere, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real) {
    return cone_of(sphere, sphere.centre - observer).inverse_pdf();
}

template <class Real>
PT_HD inline Vec3<Real> along(const Vec3<Real>& axis, const Vec3<Real>& local) {
    const Real square = dot(axis, axis);
    // At the very centre every axis will do.
    return square > Real(0) ? Frame<Real>(axis * (Real(1) / square_root(square))).to_world(local) : local;
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Sphere<Real>& sphere, const Vec3<Real>& observer, Real u,
                                                    Real v, Real) {
    const Vec3<Real> to_centre = sphere.centre - observer;
    const Cone<Real> cone = cone_of(sphere, to_centre);
    return {along(to_centre, cone.direction(u, v)), cone.inverse_pdf()};
}

// Solid angle in the world over solid angle in the unit sphere's frame: |det| / length^3, with `length` that of the
// image of a unit vector. Each axis is divided by it first, so that no cube of a length is formed.
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

// A rectangle in the plane z = `height` above the observer, with its sides along x and y.
template <class Real>
struct SphericalRectangle {
    Real x0, x1, y0, y1, height;
    Real skew;         // what a share of the solid angle is counted from
    Real solid_angle;  // not above 0, or NaN: not to be seen

    PT_HD SphericalRectangle(Real low_x, Real high_x, Real low_y, Real high_y, Real z)
        : x0(low_x), x1(high_x), y0(low_y), y1(high_y), height(z) {
        skew = corner(x0, y0) - corner(x0, y1);
        solid_angle = corner(x1, y1) - corner(x1, y0) + skew;
    }
    // The point for which u of the solid angle lies on the side of x0, and v of the rest on that of y0.
    PT_HD Vec3<Real> point(Real u, Real v) const {
        const SinCos<Real> angle = sin_cos(u * solid_angle - skew);
        const Real b0 = -y0 / square_root(y0 * y0 + height * height);
        const Real b1 = y1 / square_root(y1 * y1 + height * height);
        const Real c = angle.cosine * b0 + b1;
        const Real lean = angle.sine * angle.sine * height * height / (y0 * y0 + height * height);
        const Real square = c * c - lean;
        Real x = angle.sine < Real(0) ? x0 : x1;
        if (square > Real(0)) {
            x = clamp(height * angle.sine / square_root(square), x0, x1);
        }
        const Real d_squared = x * x + height * height;
        const Real h0 = y0 / square_root(d_squared + y0 * y0);
        const Real h1 = y1 / square_root(d_squared + y1 * y1);
        const Real h = h0 + v * (h1 - h0);
        const Real rest = (Real(1) - h) * (Real(1) + h);
        const Real y = rest > Real(0) ? clamp(h * square_root(d_squared / rest), y0, y1) : h < Real(0) ? y0 : y1;
        return {x, y, height};
    }

private:
    // Solid angle of the rectangle between the foot of the observer's perpendicular and (x, y), with its sign.
    PT_HD Real corner(Real x, Real y) const {
        return arc_tangent(x * y / (height * square_root(x * x + y * y + height * height)));
    }
};

// A box as a point in its own frame sees it, in units of its diagonal. A quad is a box without height.
template <class Real>
struct SeenBox {
    Vec3<Real> observer;  // from the box's centre
    Vec3<Real> half;
    Real diagonal;  // scene units; half of it from the centre to a corner is 1/2
    bool near;
    Real share[3];  // of the seen face across each axis: solid angle (near) or projected area times distance (far)
    Real total;
    bool inside;

    PT_HD SeenBox(const Vec3<Real>& from_centre, const Vec3<Real>& half_extents)
        : diagonal(Real(2) * square_root(dot(half_extents, half_extents))) {
        const Real inverse = Real(1) / diagonal;
        observer = from_centre * inverse;
        half = half_extents * inverse;
        near = dot(observer, observer) < Real(4);
        total = Real(0);
        inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const Real height = absolute(at(observer, axis)) - at(half, axis);
            share[axis] = Real(0);
            if (height > Real(0)) {
                inside = false;
                const Real seen = near ? rectangle(axis).solid_angle
                                       : Real(4) * at(half, after(axis)) * at(half, after(after(axis))) * height;
                share[axis] = seen > Real(0) ? seen : Real(0);
            }
            total += share[axis];
        }
    }

    // 1 / density in the direction of a ray that meets the box after `distance` scene units.
    PT_HD Real inverse_pdf(Real distance) const {
        if (inside) {
            return Real(4) * pi<Real>;
        }
        const Real t = distance / diagonal;
        return near ? total : total / (t * t * t);
    }

    // Not yet unit; `inverse_pdf` is set.
    PT_HD DirectionSample<Real> sample(Real u, Real v, Real w) const {
        if (inside) {
            return {uniform_sphere(u, v), inverse_pdf(Real(1))};
        }
        const Real pick = w * total;
        // Rounding may take the pick to the very end: never a face that is not seen.
        const int last = share[2] > Real(0) ? 2 : share[1] > Real(0) ? 1 : 0;
        const int axis = pick < share[0] ? 0 : min(pick < share[0] + share[1] ? 1 : 2, last);
        const int b = after(axis);
        const int c = after(b);
        Vec3<Real> to_light;
        if (near) {
            const Vec3<Real> point = rectangle(axis).point(u, v);
            put(to_light, axis, at(observer, axis) > Real(0) ? -point.z : point.z);
            put(to_light, b, point.x);
            put(to_light, c, point.y);
        } else {
            const Real face = at(observer, axis) > Real(0) ? at(half, axis) : -at(half, axis);
            put(to_light, axis, face - at(observer, axis));
            put(to_light, b, (Real(2) * u - Real(1)) * at(half, b) - at(observer, b));
            put(to_light, c, (Real(2) * v - Real(1)) * at(half, c) - at(observer, c));
        }
        const Real length = square_root(dot(to_light, to_light));
        return {to_light * (Real(1) / length), inverse_pdf(length * diagonal)};
    }

private:
    PT_HD static int after(int axis) { return axis == 2 ? 0 : axis + 1; }
    PT_HD static Real at(const Vec3<Real>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
    PT_HD static void put(Vec3<Real>& v, int axis, Real value) {
        v.x = axis == 0 ? value : v.x;
        v.y = axis == 1 ? value : v.y;
        v.z = axis == 2 ? value : v.z;
    }
    PT_HD SphericalRectangle<Real> rectangle(int axis) const {
        const int b = after(axis);
        const int c = after(b);
        return {-at(half, b) - at(observer, b), at(half, b) - at(observer, b), -at(half, c) - at(observer, c),
                at(half, c) - at(observer, c), absolute(at(observer, axis)) - at(half, axis)};
    }
};

template <class Real>
PT_HD inline SeenBox<Real> seen_from(const AxisBox<Real>& box, const Vec3<Real>& observer) {
    return {observer - (box.high + box.low) * Real(0.5), (box.high - box.low) * Real(0.5)};
}
template <class Real>
PT_HD inline SeenBox<Real> seen_from(const OrientedBox<Real>& box, const Vec3<Real>& observer) {
    return {box.to_local(observer - box.centre), box.half};
}
template <class Real>
PT_HD inline SeenBox<Real> seen_from(const Quad<Real>& quad, const Vec3<Real>& observer) {
    const Vec3<Real> from_centre = observer - quad.centre;
    return {{dot(from_centre, quad.axis_u), dot(from_centre, quad.normal), dot(from_centre, quad.axis_v)},
            {quad.half_u, Real(0), quad.half_v}};
}

template <class Real>
PT_HD inline Vec3<Real> to_scene(const AxisBox<Real>&, const Vec3<Real>& local) {
    return local;
}
template <class Real>
PT_HD inline Vec3<Real> to_scene(const OrientedBox<Real>& box, const Vec3<Real>& local) {
    return box.to_world(local);
}
template <class Real>
PT_HD inline Vec3<Real> to_scene(const Quad<Real>& quad, const Vec3<Real>& local) {
    return quad.axis_u * local.x + quad.normal * local.y + quad.axis_v * local.z;
}

// For AxisBox, OrientedBox and Quad.
template <class Body, class Real>
PT_HD inline Real inverse_direction_pdf(const Body& body, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real distance) {
    return seen_from(body, observer).inverse_pdf(distance);
}
template <class Body, class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Body& body, const Vec3<Real>& observer, Real u, Real v,
                                                    Real w) {
    DirectionSample<Real> sample = seen_from(body, observer).sample(u, v, w);
    sample.direction = to_scene(body, sample.direction);
    return sample;
}

}  // namespace pt
