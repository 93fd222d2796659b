// Light sampling of boxes other than by solid angle (SeenBox of kernels/solid_angle.h): by points on the faces that the
// observer sees, each face in proportion to its area or to its projected area times distance, which needs no arc
// tangent. Near the box, where the weights of such points have no bound, automatic sampling draws a direction to one
// face by kernels/near_rectangle.h. A quad is a box without height. Points by area: Shirley, Wang and Zimmerman, "Monte
// Carlo Techniques for Direct Lighting Calculations", TOG 15(1), 1996.
#pragma once

#include "kernels/near_rectangle.h"
#include "kernels/solid_angle.h"

namespace pt {

// Frame of a box-shaped light: the observer's position relative to the box's centre, and the box's half extents. A
// shape that has box_frame, box_to_world and box_to_local is sampled as a box.
template <class Real>
struct BoxFrame {
    Vec3<Real> observer;
    Vec3<Real> half;
};

template <class Shape, class Real>
concept IsBoxLike = requires(const Shape& shape, const Vec3<Real>& v) {
    box_frame(shape, v);
    box_to_world(shape, v);
    box_to_local(shape, v);
};

// Faces of a box light that an observer outside the box sees. Lengths are scaled so that the box's half extents add up
// to a number from 1 to 2; the scale is a power of two and rounds nothing.
template <class Real>
struct SeenFaces {
    Vec3<Real> observer, half;
    Vec3<Real> height;  // observer's height over the plane of the box face across each axis; 0: not seen, or no area
    Vec3<Real> area;    // area of the box face across each axis, whether the observer sees it or not
    Real scale;         // scaled units of length in one scene unit

    PT_HD explicit SeenFaces(const BoxFrame<Real>& frame)
        : scale(power_to_one(frame.half.x + frame.half.y + frame.half.z)) {
        observer = frame.observer * scale;
        half = frame.half * scale;
        area = {Real(4) * half.y * half.z, Real(4) * half.z * half.x, Real(4) * half.x * half.y};
        height = {seen(absolute(observer.x) - half.x, area.x), seen(absolute(observer.y) - half.y, area.y),
                  seen(absolute(observer.z) - half.z, area.z)};
    }

    PT_HD bool any() const { return height.x > Real(0) || height.y > Real(0) || height.z > Real(0); }
    // Whether the observer is inside the box light or on it; for a quad, in its plane within its edges.
    PT_HD bool inside() const {
        return absolute(observer.x) <= half.x && absolute(observer.y) <= half.y && absolute(observer.z) <= half.z;
    }
    // Square of the distance from the observer to the box light, in the scaled units of SeenFaces.
    PT_HD Real square_gap() const {
        const Vec3<Real> gap{max(Real(0), absolute(observer.x) - half.x), max(Real(0), absolute(observer.y) - half.y),
                             max(Real(0), absolute(observer.z) - half.z)};
        return dot(gap, gap);
    }
    // Axis of the face by which a ray from the observer that hits the box enters it: of the faces seen the one whose
    // plane the ray crosses last.
    PT_HD int entered(const Vec3<Real>& direction) const {
        int axis = 0;
        Real of_height = height.x;
        Real of_direction = absolute(direction.x);
        if (height.y > Real(0) &&
            (!(of_height > Real(0)) || height.y * of_direction > of_height * absolute(direction.y))) {
            axis = 1;
            of_height = height.y;
            of_direction = absolute(direction.y);
        }
        const bool by_z = height.z > Real(0) &&
                          (!(of_height > Real(0)) || height.z * of_direction > of_height * absolute(direction.z));
        return by_z ? 2 : axis;
    }
    // Axis of the face that `pick`, from 0 to the sum of the faces' shares of samples, selects; never one of share 0.
    PT_HD static int picked(const Vec3<Real>& share, Real pick) {
        if (share.z > Real(0) && pick >= share.x + share.y) {
            return 2;
        }
        return share.y > Real(0) && pick >= share.x ? 1 : 0;
    }
    // The vector from the observer to a point of the box face across `axis`; a and b, from -1 to 1, place the point
    // along the other two axes.
    PT_HD Vec3<Real> to_point(int axis, Real a, Real b) const {
        return {axis == 0 ? onto(observer.x, height.x) : a * half.x - observer.x,
                axis == 1 ? onto(observer.y, height.y) : (axis == 0 ? a : b) * half.y - observer.y,
                axis == 2 ? onto(observer.z, height.z) : b * half.z - observer.z};
    }

private:
    PT_HD static Real seen(Real height, Real area) { return height > Real(0) && area > Real(0) ? height : Real(0); }
    PT_HD static Real onto(Real observer, Real height) { return observer > Real(0) ? -height : height; }
};

// Samples a face of a box light in proportion to its area. With area sampling, 1 / pdf by solid angle is area cos /
// distance^2, where area is that of all faces seen and cos = height of the observer over the face / distance. With
// projected sampling a face is drawn in proportion to area cos distance, so that the pdf does not depend on the face.
template <class Real>
struct FacesByArea {
    const SeenFaces<Real>& faces;
    bool projected;
    Vec3<Real> share;
    Real total;

    PT_HD FacesByArea(const SeenFaces<Real>& seen, bool is_projected) : faces(seen), projected(is_projected) {
        const Vec3<Real>& height = seen.height;
        if (projected) {
            share = seen.area * height;
        } else {
            share = {height.x > Real(0) ? seen.area.x : Real(0), height.y > Real(0) ? seen.area.y : Real(0),
                     height.z > Real(0) ? seen.area.z : Real(0)};
        }
        total = share.x + share.y + share.z;
    }
    // 1 / pdf of a point on the light's face across `axis`; `inverse`: 1 / distance to the point. Factors are applied
    // one by one: the cube of `inverse`, or a height times `total` (sum of the faces' shares), may be out of range.
    PT_HD Real inverse_pdf(int axis, Real inverse) const {
        const Real of_direction = projected ? inverse : component_of(faces.height, axis) * inverse;
        return total * inverse * inverse * of_direction;
    }
    PT_HD DirectionSample<Real> sample(Real u, Real v, Real w) const {
        const int axis = faces.picked(share, w * total);
        const Vec3<Real> to_light = faces.to_point(axis, Real(2) * u - Real(1), Real(2) * v - Real(1));
        const Real square = dot(to_light, to_light);
        // A point nearer than 2^-50 of the light's size is the observer itself, but for rounding, and brings no light.
        if (!(square >= Real(0x1p-100))) {
            return {{Real(0), Real(0), Real(1)}, Real(0)};
        }
        const RootAndInverse<Real> length = nearly_root_and_inverse_in_range(square);
        return {to_light * length.inverse, inverse_pdf(axis, length.inverse), 0, length.root};
    }
};

// Samples one of the seen faces of a box light, each with equal probability, and a direction to it by NearRectangle:
// weights are bounded by 6 pi however near the box is.
template <class Real>
struct OneFaceNear {
    const SeenFaces<Real>& faces;
    Real count;

    PT_HD explicit OneFaceNear(const SeenFaces<Real>& seen)
        : faces(seen), count(one_if(seen.height.x) + one_if(seen.height.y) + one_if(seen.height.z)) {}

    // 1 / density, by solid angle, of a direction by which a ray enters the box light by the face across `axis`.
    PT_HD Real inverse_pdf(int axis, const Vec3<Real>& direction) const {
        const Axes axes = axes_of(axis);
        return count *
               rectangle(axes).inverse_pdf(component_of(direction, axes.shorter), component_of(direction, axis));
    }
    PT_HD DirectionSample<Real> sample(Real u, Real v, Real w) const {
        const Vec3<Real> share{one_if(faces.height.x), one_if(faces.height.y), one_if(faces.height.z)};
        const Axes axes = axes_of(faces.picked(share, w * count));
        const auto [point, inverse_pdf] = rectangle(axes).sample(u, v);
        const Real back = component_of(faces.observer, axes.across) > Real(0) ? -point.z : point.z;
        const Vec3<Real> to_light{coordinate(axes, 0, point, back), coordinate(axes, 1, point, back),
                                  coordinate(axes, 2, point, back)};
        // The vector to the light is scaled first: the end of a light as thin as a thread may be so near that its
        // squared distance is 0.
        const Real scale = power_to_one(max(max(absolute(to_light.x), absolute(to_light.y)), absolute(to_light.z)));
        const Vec3<Real> scaled = to_light * scale;
        const RootAndInverse<Real> length = nearly_root_and_inverse_in_range(dot(scaled, scaled));
        return {scaled * length.inverse, count * inverse_pdf, 0, length.root * reciprocal_of_power_of_two(scale)};
    }

private:
    // The axes of a box face: the axis across it, and those along its shorter and its longer sides.
    struct Axes {
        int across, shorter, longer;
    };
    PT_HD static Real one_if(Real height) { return height > Real(0) ? Real(1) : Real(0); }
    PT_HD Axes axes_of(int across) const {
        const int first = across == 0 ? 1 : 0;
        const int second = across == 2 ? 1 : 2;
        const bool in_order = component_of(faces.half, first) <= component_of(faces.half, second);
        return {across, in_order ? first : second, in_order ? second : first};
    }
    PT_HD static Real coordinate(const Axes& axes, int axis, const Vec3<Real>& point, Real back) {
        const Real within = axis == axes.shorter ? point.x : point.y;
        return axis == axes.across ? back : within;
    }
    PT_HD NearRectangle<Real> rectangle(const Axes& axes) const {
        return {component_of(faces.half, axes.shorter), component_of(faces.half, axes.longer),
                component_of(faces.observer, axes.shorter), component_of(faces.observer, axes.longer),
                component_of(faces.height, axes.across)};
    }
};

// Whether a box light under automatic sampling counts as near: less than `limit` of its half diagonals away.
template <class Real>
PT_HD inline bool is_near(const SeenFaces<Real>& faces, Real limit) {
    return faces.square_gap() < limit * limit * dot(faces.half, faces.half);
}

// Draws a direction towards a box that emits, in the box's own frame. `near_limit`: the distance in half diagonals
// below which the box counts as near.
template <class Real>
PT_HD inline DirectionSample<Real> sample_box_light(const BoxFrame<Real>& frame, LightSampling sampling,
                                                    Real near_limit, Real u, Real v, Real w) {
    const SeenFaces<Real> faces(frame);
    if (!faces.any()) {
        return faces.inside() ? DirectionSample<Real>{uniform_sphere(u, v), Real(4) * pi<Real>}
                              : DirectionSample<Real>{{Real(0), Real(0), Real(1)}, Real(0)};
    }
    DirectionSample<Real> sample;
    if (sampling == LightSampling::automatic && is_near(faces, near_limit)) {
        sample = OneFaceNear<Real>(faces).sample(u, v, w);
    } else {
        sample = FacesByArea<Real>(faces, sampling != LightSampling::area).sample(u, v, w);
    }
    sample.distance *= reciprocal_of_power_of_two(faces.scale);
    return sample;
}

// 1 / density of sample_box_light in the direction, in the box's frame, of a ray that meets the box after `distance`.
template <class Real>
PT_HD inline Real inverse_box_light_pdf(const BoxFrame<Real>& frame, const Vec3<Real>& direction, Real distance,
                                        LightSampling sampling, Real near_limit) {
    const SeenFaces<Real> faces(frame);
    if (!faces.any()) {
        return faces.inside() ? Real(4) * pi<Real> : Real(0);
    }
    if (sampling == LightSampling::automatic && is_near(faces, near_limit)) {
        return OneFaceNear<Real>(faces).inverse_pdf(faces.entered(direction), direction);
    }
    const int axis = sampling == LightSampling::area ? faces.entered(direction) : 0;
    const Real away = distance * faces.scale;
    return away >= Real(0x1p-50)
               ? FacesByArea<Real>(faces, sampling != LightSampling::area).inverse_pdf(axis, reciprocal_in_range(away))
               : Real(0);
}

// Draws a direction towards a box or quad that emits, in scene coordinates, as sample_box_light does in the box's own
// frame.
template <class Real, class Shape>
PT_HD inline DirectionSample<Real> sample_box_light(const Shape& shape, const Vec3<Real>& observer,
                                                    LightSampling sampling, Real near_limit, Real u, Real v, Real w) {
    DirectionSample<Real> sample = sample_box_light(box_frame(shape, observer), sampling, near_limit, u, v, w);
    sample.direction = box_to_world(shape, sample.direction);
    return sample;
}
template <class Real, class Shape>
PT_HD inline Real inverse_box_light_pdf(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                        Real distance, LightSampling sampling, Real near_limit) {
    return inverse_box_light_pdf(box_frame(shape, observer), box_to_local(shape, direction), distance, sampling,
                                 near_limit);
}

}  // namespace pt
