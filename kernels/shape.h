// Interface of a shape. A shape's header defines a class template on the number type with
// |  static constexpr const char* file_name     what scene files call it; several kinds may share a name
// |  static constexpr bool is_flat              a surface without an inside, hit on both sides; then it has a unit
// `normal`
// |  static constexpr UnitShape unit_shape      unit shape that a matrix kernel uses in its place, or none
// |  static bool is_kind_of(placement)          whether this kind fits; the first such kind of a name is the object's
// |  static Shape placed(placement)             the shape where a scene's file places it
// |  static bool contains(point)                whether the point is inside the shape of scale 1 about 0
// |and these functions, found by the type of their first argument:
// |  interval(shape, origin, direction)         where a line enters and leaves it; both the same for a flat shape
// |  surface_point(shape, origin, direction, t, inside)
// |  sample_point(shape, u, v, w)               a point on it, by area
// |  size_of(shape), bounds_of(shape)           the largest half extent; the bounding box
// |  widened(shape of float)                    the same shape in double
// |  naive::normal_at(shape, point)             outward normal at a point near its surface
// |Sampling by solid angle (kernels/solid_angle.h) needs area_of(shape) where sample_point is uniform, or its own form.
// |Functions declared further down have a default, which a shape's own function hides.
#pragma once

#include "kernels/in_range.h"
#include "kernels/path.h"

#include <limits>

namespace pt {

// The ray parameters at which a line enters and leaves a convex body; hits == false: it misses the body.
template <class Real>
struct Interval {
    Real near, far;
    bool hits;
};

// A convex body: a shape that any line crosses over at most one interval.
template <class Shape, class Real>
concept IsConvexBody = !Shape::is_flat && requires(const Shape& shape, const Vec3<Real>& v) {
    interval(shape, v, v).near;
};

// A hit point pulled back onto the surface, with the outward unit normal there.
template <class Real>
struct SurfacePoint {
    Vec3<Real> position, normal;
};

template <class Real>
struct LightSample {
    Vec3<Real> position;
    Vec3<Real> normal;            // outward unit normal at the hit point or sampled point
    Real inverse_density;         // 1 / density, by area, of the sampled point, in square scene units
    std::uint32_t primitive = 0;  // primitive of the shape that the point lies on
};

// A direction towards a light. `inverse_pdf` is 1 / density by solid angle; 0: there is nothing to sample.
template <class Real>
struct DirectionSample {
    Vec3<Real> direction;  // unit direction towards the light
    Real inverse_pdf;
    std::uint32_t primitive = 0;  // primitive of the light that the direction was drawn to
    Real distance = Real(0);      // distance to the sampled point of the light; 0: not known
};

template <class Real>
struct Bounds {
    Vec3<Real> low, high;
};

// Unit shapes: box [-1/2, 1/2]^3, sphere of diameter 1, square of side 1 in the plane y = 0 (kernels/transform.h).
enum class UnitShape : std::uint32_t { box, sphere, quad, none };

// An object as its scene's file places it: the shape of scale 1 about 0, scaled, rotated, and moved.
struct Placement {
    Vec3<double> centre;     // the object's position relative to the camera's eye
    Vec3<double> column[3];  // columns of the object's rotation, before which a flat shape faces +y
    Vec3<double> scale;
    bool is_quarter_turned;  // the object's rotation is by multiples of 90 degrees only
};

template <class Real>
PT_HD inline Vec3<Real> rounded_to(const Vec3<double>& v) {
    return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

PT_HD inline Vec3<double> widened(const Vec3<float>& v) { return Vec3<double>(v); }

// The distance through a body for a ray that starts on it and runs inside: the surface that it starts on lies at t = 0,
// on the near side.
template <class Shape, class Real>
PT_HD inline Real chord(const Shape& shape, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return max(interval(shape, origin, direction).far, Real(0));
}

// The distance to the surface of a body from a point inside it or on its surface. Nothing is inside a flat shape: the
// loader refuses a body of one.
template <class Shape, class Real>
PT_HD inline Real distance_out_of(const Shape& shape, const Vec3<Real>& origin, const Vec3<Real>& direction,
                                  bool on_surface) {
    if constexpr (Shape::is_flat) {
        return Real(0);
    } else {
        return on_surface ? chord(shape, origin, direction) : max(Real(0), interval(shape, origin, direction).far);
    }
}

}  // namespace pt
