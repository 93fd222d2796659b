// Oriented boxes: rays are taken into the box's own frame, where it is axis-aligned.
#pragma once

#include "kernels/box.h"
#include "kernels/light_sampling.h"
#include "kernels/naive.h"

namespace pt {

template <class Real>
struct OrientedBox {
    Vec3<Real> centre;
    Vec3<Real> axis[3];  // orthonormal axes of the oriented box
    Vec3<Real> half;     // half extents of the oriented box along its axes

    PT_HD Vec3<Real> to_local(const Vec3<Real>& v) const { return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)}; }
    PT_HD Vec3<Real> to_world(const Vec3<Real>& v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }

    static constexpr const char* file_name = "box";
    static constexpr bool is_flat = false;
    static constexpr UnitShape unit_shape = UnitShape::box;
    static bool is_kind_of(const Placement&) { return true; }
    static OrientedBox placed(const Placement& object) {
        return {rounded_to<Real>(object.centre),
                {rounded_to<Real>(object.column[0]), rounded_to<Real>(object.column[1]),
                 rounded_to<Real>(object.column[2])},
                rounded_to<Real>(object.scale * 0.5)};
    }
    static bool contains(const Vec3<double>& p) { return is_in_unit_box(p); }
};

template <class Real>
PT_HD inline Interval<Real> interval(const OrientedBox<Real>& box, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    return slab_interval(-box.half, box.half, box.to_local(origin - box.centre), reciprocal(box.to_local(direction)));
}

// The distance through the box for a ray that starts on a face and runs inside: that face's own plane lies at t = 0 on
// the near side.
template <class Real>
PT_HD inline Real chord(const OrientedBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    return max(interval(box, origin, direction).far, Real(0));
}

template <class Real>
PT_HD inline Real distance_out_of(const OrientedBox<Real>& box, const Vec3<Real>& origin, const Vec3<Real>& direction,
                                  bool) {
    return chord(box, origin, direction);
}

template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const OrientedBox<Real>& box, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real t, bool inside) {
    const Vec3<Real> o = box.to_local(origin - box.centre);
    const Vec3<Real> d = box.to_local(direction);
    const SurfacePoint<Real> local = face_point(-box.half, box.half, o, reciprocal(d), inside, o + d * t);
    return {box.centre + box.to_world(local.position), box.to_world(local.normal)};
}

template <class Real>
PT_HD inline LightSample<Real> sample_point(const OrientedBox<Real>& box, Real u, Real v, Real w) {
    LightSample<Real> sample = sample_box(box.half, u, v, w);
    sample.position = box.centre + box.to_world(sample.position);
    sample.normal = box.to_world(sample.normal);
    return sample;
}

template <class Real>
PT_HD inline SeenBox<Real> seen_from(const OrientedBox<Real>& box, const Vec3<Real>& observer) {
    return {box.to_local(observer - box.centre), box.half};
}

template <class Real>
PT_HD inline BoxFrame<Real> box_frame(const OrientedBox<Real>& box, const Vec3<Real>& observer) {
    return {box.to_local(observer - box.centre), box.half};
}
template <class Real>
PT_HD inline Vec3<Real> box_to_world(const OrientedBox<Real>& box, const Vec3<Real>& v) {
    return box.to_world(v);
}
template <class Real>
PT_HD inline Vec3<Real> box_to_local(const OrientedBox<Real>& box, const Vec3<Real>& v) {
    return box.to_local(v);
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const OrientedBox<Real>& box, const Vec3<Real>& observer, const Vec3<Real>&,
                                        Real distance) {
    return seen_from(box, observer).inverse_pdf(distance);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const OrientedBox<Real>& box, const Vec3<Real>& observer, Real u,
                                                    Real v, Real w) {
    DirectionSample<Real> sample = seen_from(box, observer).sample(u, v, w);
    sample.direction = box.to_world(sample.direction);
    return sample;
}

template <class Real>
PT_HD inline Real area_of(const OrientedBox<Real>& box) {
    return area_of_box(box.half);
}

template <class Real>
PT_HD inline Real size_of(const OrientedBox<Real>& box) {
    return max(box.half.x, max(box.half.y, box.half.z));
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const OrientedBox<Real>& box) {
    Vec3<Real> half(Real(0));
    for (int i = 0; i < 3; ++i) {
        half += Vec3<Real>(absolute(box.axis[i].x), absolute(box.axis[i].y), absolute(box.axis[i].z)) * box.half[i];
    }
    return {box.centre - half, box.centre + half};
}

PT_HD inline OrientedBox<double> widened(const OrientedBox<float>& box) {
    return {widened(box.centre), {widened(box.axis[0]), widened(box.axis[1]), widened(box.axis[2])}, widened(box.half)};
}

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const OrientedBox<Real>& box, const Vec3<Real>& origin,
                                     const Vec3<Real>& direction) {
    return slabs(-box.half, box.half, box.to_local(origin - box.centre), box.to_local(direction));
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const OrientedBox<Real>& box, const Vec3<Real>& p) {
    return box.to_world(nearest_face(box.half, box.to_local(p - box.centre)));
}

}  // namespace naive

}  // namespace pt
