// Axis-aligned boxes: ray intersection, and sampling of boxes that emit.
#pragma once

#include "kernels/box.h"
#include "kernels/light_sampling.h"
#include "kernels/naive.h"

namespace pt {

template <class Real>
struct AxisBox {
    Vec3<Real> low, high;

    static constexpr const char* file_name = "box";
    static constexpr bool is_flat = false;
    static constexpr UnitShape unit_shape = UnitShape::box;
    static bool is_kind_of(const Placement& object) { return object.is_quarter_turned; }
    static AxisBox placed(const Placement& object) {
        Vec3<double> half(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            // Each column of the placement has one entry of 1 or -1, so absolute values give the box's half sides.
            const Vec3<double>& column = object.column[axis];
            half +=
                Vec3<double>(absolute(column.x), absolute(column.y), absolute(column.z)) * (0.5 * object.scale[axis]);
        }
        return {rounded_to<Real>(object.centre - half), rounded_to<Real>(object.centre + half)};
    }
    static bool contains(const Vec3<double>& p) { return is_in_unit_box(p); }
};

template <class Real>
PT_HD inline Interval<Real> interval(const AxisBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return slab_interval(box.low, box.high, origin, reciprocal(direction));
}

template <class Real>
PT_HD inline Real distance_out_of(const AxisBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction,
                                  bool) {
    return max(Real(0), interval(box, origin, direction).far);
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const AxisBox<Real>& box, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool inside) {
    return face_point(box.low, box.high, origin, reciprocal(direction), inside, origin + direction * t);
}

template <class Real>
PT_HD inline LightSample<Real> sample_point(const AxisBox<Real>& box, Real u, Real v, Real w) {
    LightSample<Real> sample = sample_box((box.high - box.low) * Real(0.5), u, v, w);
    sample.position = sample.position + (box.high + box.low) * Real(0.5);
    return sample;
}

template <class Real>
PT_HD inline SeenBox<Real> seen_from(const AxisBox<Real>& box, const Vec3<Real>& observer) {
    return {observer - (box.high + box.low) * Real(0.5), (box.high - box.low) * Real(0.5)};
}

template <class Real>
PT_HD inline BoxFrame<Real> box_frame(const AxisBox<Real>& box, const Vec3<Real>& observer) {
    return {observer - (box.high + box.low) * Real(0.5), (box.high - box.low) * Real(0.5)};
}
template <class Real>
PT_HD inline Vec3<Real> box_to_world(const AxisBox<Real>&, const Vec3<Real>& v) {
    return v;
}
template <class Real>
PT_HD inline Vec3<Real> box_to_local(const AxisBox<Real>&, const Vec3<Real>& v) {
    return v;
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const AxisBox<Real>& box, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real distance) {
    return seen_from(box, observer).inverse_pdf(distance);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const AxisBox<Real>& box, const Vec3<Real>& observer, Real u,
                                                    Real v, Real w) {
    return seen_from(box, observer).sample(u, v, w);
}

template <class Real>
PT_HD inline Real area_of(const AxisBox<Real>& box) {
    return area_of_box((box.high - box.low) * Real(0.5));
}

template <class Real>
PT_HD inline Real size_of(const AxisBox<Real>& box) {
    return Real(0.5) * max(box.high.x - box.low.x, max(box.high.y - box.low.y, box.high.z - box.low.z));
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const AxisBox<Real>& box) {
    return {box.low, box.high};
}

PT_HD inline AxisBox<double> widened(const AxisBox<float>& box) { return {widened(box.low), widened(box.high)}; }

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const AxisBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return slabs(box.low, box.high, origin, direction);
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const AxisBox<Real>& box, const Vec3<Real>& p) {
    return nearest_face((box.high - box.low) * Real(0.5), p - (box.high + box.low) * Real(0.5));
}

}  // namespace naive

}  // namespace pt
