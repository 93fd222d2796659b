// Directions towards a convex light, drawn by solid angle as seen from a point: a cone for spheres, the cone in its own
// frame for ellipsoids, spherical rectangles for the near faces of boxes and for quads. The weight of a sample is then
// bounded however near the light is, where sampling by area has weights that grow as 1 / distance^2 (a lamp that
// touches a ceiling gives that infinite variance). Far boxes and quads are sampled by projected area: their solid
// angle, a difference of angles, would lose its digits. Cone: Shirley, Wang and Zimmerman, "Monte Carlo Techniques for
// Direct Lighting Calculations", TOG 15(1), 1996. Rectangle: Ureña, Fajardo and King, "An Area-Preserving
// Parametrization for Spherical Rectangles", EGSR 2013, with its four angles as arc tangents and the division by a sine
// taken out.
#pragma once

#include "kernels/sampling.h"
#include "kernels/shape.h"

namespace pt {

// The cone of directions in which an observer sees a sphere: solid angle 2 pi (1 - cos); all directions from inside.
template <class Real>
struct Cone {
    Real one_minus_cosine;  // 1 - cos of the cone's half angle; 2: the whole sphere of directions

    // A `radius_over_distance` above 1 means that the observer is inside the sphere, which then fills all directions.
    PT_HD explicit Cone(Real radius_over_distance) : one_minus_cosine(Real(2)) {
        if (radius_over_distance < Real(1)) {
            const Real cosine = square_root((Real(1) - radius_over_distance) * (Real(1) + radius_over_distance));
            one_minus_cosine = radius_over_distance * radius_over_distance / (Real(1) + cosine);
        }
    }
    PT_HD Real inverse_pdf() const { return Real(2) * pi<Real> * one_minus_cosine; }
    // Draws a direction in a cone around +z, uniformly by solid angle.
    PT_HD Vec3<Real> direction(Real u, Real v) const {
        const Real below = u * one_minus_cosine;
        const Real sine = square_root(max(Real(0), below * (Real(2) - below)));
        const SinCos<Real> azimuth = sin_cos_turn(v);
        return {sine * azimuth.cosine, sine * azimuth.sine, Real(1) - below};
    }
};

template <class Real>
PT_HD inline Vec3<Real> along(const Vec3<Real>& axis, const Vec3<Real>& local) {
    const Real square = dot(axis, axis);
    // From a sphere's very centre there is no direction towards the centre, and any axis of the cone will do.
    return square > Real(0) ? Frame<Real>(axis * (Real(1) / square_root(square))).to_world(local) : local;
}

// A rectangle in the plane z = `height` above the observer, with its sides along x and y.
template <class Real>
struct SphericalRectangle {
    Real x0, x1, y0, y1, height;
    Real skew;         // angle from which shares of the rectangle's solid angle are counted
    Real solid_angle;  // solid angle of the rectangle; 0, negative or NaN: not visible

    PT_HD SphericalRectangle(Real low_x, Real high_x, Real low_y, Real high_y, Real z)
        : x0(low_x), x1(high_x), y0(low_y), y1(high_y), height(z) {
        skew = corner(x0, y0) - corner(x0, y1);
        solid_angle = corner(x1, y1) - corner(x1, y0) + skew;
    }
    // Point of the rectangle for which u of the solid angle lies on the side of x0, and v of the rest on that of y0.
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

// 1 / pdf of a light sample on a far box: `total` (sum of the faces' shares) / (distance / the box's diagonal)^3.
template <class Real>
PT_HD inline Real far_inverse_pdf(Real total, Real distance, Real diagonal) {
    const Real t = distance / diagonal;
    return total / (t * t * t);
}

// A box light in its own frame as an observer sees it, in units of its diagonal. A quad is a box without height.
template <class Real>
struct SeenBox {
    Vec3<Real> observer;  // observer's position relative to the centre of the box light
    Vec3<Real> half;
    Real diagonal;  // length of the box light's diagonal, scene units
    bool near;
    Real share[3];  // share of samples for each axis's face: solid angle (near) or projected area times distance (far)
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
            const Real height = absolute(component_of(observer, axis)) - component_of(half, axis);
            share[axis] = Real(0);
            if (height > Real(0)) {
                inside = false;
                const Real seen =
                    near ? rectangle(axis).solid_angle
                         : Real(4) * component_of(half, after(axis)) * component_of(half, after(after(axis))) * height;
                share[axis] = seen > Real(0) ? seen : Real(0);
            }
            total += share[axis];
        }
    }

    // 1 / pdf, by solid angle, of the direction of a ray that hits the box light after `distance` scene units.
    PT_HD Real inverse_pdf(Real distance) const {
        if (inside) {
            return Real(4) * pi<Real>;
        }
        return near ? total : far_inverse_pdf(total, distance, diagonal);
    }

    // Samples a unit direction towards the box light by solid angle (near) or projected area (far).
    PT_HD DirectionSample<Real> sample(Real u, Real v, Real w) const {
        if (inside) {
            return {uniform_sphere(u, v), inverse_pdf(Real(1))};
        }
        const Real pick = w * total;
        // Rounding may take `pick` to the sum of all faces' shares; the last face with a share is then chosen.
        const int last = share[2] > Real(0) ? 2 : share[1] > Real(0) ? 1 : 0;
        const int axis = pick < share[0] ? 0 : min(pick < share[0] + share[1] ? 1 : 2, last);
        const int b = after(axis);
        const int c = after(b);
        Vec3<Real> to_light;
        if (near) {
            const Vec3<Real> point = rectangle(axis).point(u, v);
            put(to_light, axis, component_of(observer, axis) > Real(0) ? -point.z : point.z);
            put(to_light, b, point.x);
            put(to_light, c, point.y);
        } else {
            const Real face =
                component_of(observer, axis) > Real(0) ? component_of(half, axis) : -component_of(half, axis);
            put(to_light, axis, face - component_of(observer, axis));
            put(to_light, b, (Real(2) * u - Real(1)) * component_of(half, b) - component_of(observer, b));
            put(to_light, c, (Real(2) * v - Real(1)) * component_of(half, c) - component_of(observer, c));
        }
        const Real length = square_root(dot(to_light, to_light));
        return {to_light * (Real(1) / length), inverse_pdf(length * diagonal)};
    }

private:
    PT_HD static int after(int axis) { return axis == 2 ? 0 : axis + 1; }
    PT_HD static void put(Vec3<Real>& v, int axis, Real value) {
        v.x = axis == 0 ? value : v.x;
        v.y = axis == 1 ? value : v.y;
        v.z = axis == 2 ? value : v.z;
    }
    PT_HD SphericalRectangle<Real> rectangle(int axis) const {
        const int b = after(axis);
        const int c = after(b);
        return {-component_of(half, b) - component_of(observer, b), component_of(half, b) - component_of(observer, b),
                -component_of(half, c) - component_of(observer, c), component_of(half, c) - component_of(observer, c),
                absolute(component_of(observer, axis)) - component_of(half, axis)};
    }
};

// Default sampling of a shape that emits: uniformly by area. Each point in which a ray hits the shape, up to two of a
// convex body, adds its pdf, distance^2 / (cosine * area). This is right from everywhere, but the weights of samples
// are not bounded where the observer is near.
template <class Shape, class Real>
PT_HD inline Real area_density(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction, Real t,
                               bool inside) {
    const Real cosine = absolute(dot(surface_point(shape, observer, direction, t, inside).normal, direction));
    const Real away = t / square_root(area_of(shape));
    return away * away / cosine;
}
template <class Shape, class Real>
PT_HD inline Real inverse_pdf_by_area(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                      Real distance) {
    if constexpr (Shape::is_flat) {
        return Real(1) / area_density(shape, observer, direction, distance, false);
    } else {
        const Interval<Real> crossing = interval(shape, observer, direction);
        if (!crossing.hits || !(crossing.far > Real(0))) {
            return Real(0);
        }
        const Real beyond = area_density(shape, observer, direction, crossing.far, true);
        const Real before =
            crossing.near > Real(0) ? area_density(shape, observer, direction, crossing.near, false) : Real(0);
        return Real(1) / (before + beyond);
    }
}
template <class Shape, class Real>
PT_HD inline Real inverse_direction_pdf(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                        Real distance) {
    return inverse_pdf_by_area(shape, observer, direction, distance);
}
template <class Shape, class Real>
PT_HD inline DirectionSample<Real> sample_direction(const Shape& shape, const Vec3<Real>& observer, Real u, Real v,
                                                    Real w) {
    const Vec3<Real> to_point = sample_point(shape, u, v, w).position - observer;
    const Real distance = square_root(dot(to_point, to_point));
    if (!(distance > Real(0))) {
        return {{Real(0), Real(0), Real(1)}, Real(0)};
    }
    const Vec3<Real> direction = to_point * (Real(1) / distance);
    return {direction, inverse_direction_pdf(shape, observer, direction, distance)};
}

}  // namespace pt
