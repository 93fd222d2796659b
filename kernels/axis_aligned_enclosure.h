// An enclosure is an empty axis-aligned region, such as a room, whose sides are open or inner faces of axis boxes
// (walls). A ray from inside it, or one that enters by an open side, can hit only the wall whose plane it crosses on
// its way out: one plane per axis is tested, not two per wall. Distances are the products that slab_interval forms, and
// doubtful cases (a tie, a grazing ray, an origin outside) are left to slab tests, so hits are the same bit for bit.
// find_enclosure (harness/scene) says what makes an enclosure.
#pragma once

#include "kernels/box.h"

namespace pt {

template <class Real>
struct AxisAlignedEnclosure {
    Vec3<Real> low{Real(0), Real(0), Real(0)};  // lowest corner of the enclosure, scene units from the eye
    Vec3<Real> high{Real(0), Real(0), Real(0)};
    Vec3<Real> reach_low{Real(0), Real(0), Real(0)};  // bounding box of all axis boxes; infinite if one moves
    Vec3<Real> reach_high{Real(0), Real(0), Real(0)};
    // Face of the wall behind the low (high) side of each axis; `nowhere` if that side is open.
    SurfaceId low_side[3], high_side[3];
    std::uint32_t walls = 0;       // bit i: axis box i is a wall of the enclosure; 0: there is no enclosure
    std::uint32_t lamps = 0;       // bit i: axis box i has an emitter material, so no path starts on it
    std::uint32_t open_sides = 0;  // bit 2 * axis (+ 1): the low (high) side across the axis is open

    // Whether axis box i, an index into SceneView::axis_boxes, is a wall of the enclosure.
    PT_HD bool is_wall(std::uint32_t i) const { return i < 32 && ((walls >> i) & 1u) != 0; }
    PT_HD bool is_lamp(std::uint32_t i) const { return i < 32 && ((lamps >> i) & 1u) != 0; }
    PT_HD bool contains(const Vec3<Real>& p) const {
        return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
    }
};

// Where a ray leaves the enclosure. Without a known exit the slab tests of all axis boxes decide.
template <class Real>
struct EnclosureExit {
    bool known;
    Real t;
    SurfaceId side;  // face of the wall that the ray leaves at; nowhere: an open side
};

// Factor within which two ray distances tie, to be left to the slab test, which accepts near <= far (1 + 2 gamma(3)).
template <class Real>
inline constexpr Real room_slack = Real(1) + Real(4) * gamma<Real>(3);

// Whether a ray from outside enters the enclosure by an open side, at a distance below `exit`. The ray crosses three
// side planes inwards and enters by the last of them; two that tie within room_slack count as no entry.
template <class Real>
PT_HD inline bool enters_by_open_side(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& origin,
                                      const Vec3<Real>& inverse, Real exit) {
    const bool from_high_x = inverse.x < Real(0);
    const bool from_high_y = inverse.y < Real(0);
    const bool from_high_z = inverse.z < Real(0);
    const Real x = ((from_high_x ? enclosure.high.x : enclosure.low.x) - origin.x) * inverse.x;
    const Real y = ((from_high_y ? enclosure.high.y : enclosure.low.y) - origin.y) * inverse.y;
    const Real z = ((from_high_z ? enclosure.high.z : enclosure.low.z) - origin.z) * inverse.z;
    const auto enters = [&](std::uint32_t axis, bool from_high, Real t, Real other, Real another) {
        return ((enclosure.open_sides >> (2 * axis)) & (from_high ? 2u : 1u)) != 0 && t > Real(0) &&
               keep_larger(other, another) * room_slack<Real> < t && t * room_slack<Real> < exit;
    };
    return enters(0, from_high_x, x, y, z) || enters(1, from_high_y, y, x, z) || enters(2, from_high_z, z, x, y);
}

// Finds where a ray leaves an enclosure. `inverse`: reciprocal of the ray's direction; `is_finite`: whether it is
// finite (has_finite_reciprocal).
template <class Real>
PT_HD inline EnclosureExit<Real> leave_enclosure(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& origin,
                                                 const Vec3<Real>& inverse, bool is_finite) {
    const bool to_low_x = inverse.x < Real(0);
    const bool to_low_y = inverse.y < Real(0);
    const bool to_low_z = inverse.z < Real(0);
    const Real x = ((to_low_x ? enclosure.low.x : enclosure.high.x) - origin.x) * inverse.x;
    const Real y = ((to_low_y ? enclosure.low.y : enclosure.high.y) - origin.y) * inverse.y;
    const Real z = ((to_low_z ? enclosure.low.z : enclosure.high.z) - origin.z) * inverse.z;
    const Real t = keep_smaller(keep_smaller(x, y), z);
    const Real next = keep_smaller(keep_larger(x, y), keep_larger(keep_smaller(x, y), z));
    const bool plain = enclosure.walls != 0 && is_finite && t > Real(0) && t * room_slack<Real> < next;
    const bool by_x = t == x;
    const bool by_y = t == y;
    const SurfaceId side_x = to_low_x ? enclosure.low_side[0] : enclosure.high_side[0];
    const SurfaceId side_y = to_low_y ? enclosure.low_side[1] : enclosure.high_side[1];
    const SurfaceId side_z = to_low_z ? enclosure.low_side[2] : enclosure.high_side[2];
    return {plain && (enclosure.contains(origin) || enters_by_open_side(enclosure, origin, inverse, t)), t,
            by_x   ? side_x
            : by_y ? side_y
                   : side_z};
}

// Which of an enclosure's walls lie between two points, the first of them inside. The enclosure is convex: no wall lies
// between two points inside it, and exactly one does if the second point is outside, beyond walls but beyond no open
// side. Where the answer is `unknown`, the slab test of every wall decides.
enum class WallsBetween { none, one, unknown };

template <class Real>
PT_HD inline WallsBetween walls_between(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& from,
                                        const Vec3<Real>& to) {
    const Vec3<Real>& low = enclosure.low;
    const Vec3<Real>& high = enclosure.high;
    // Distances by which the point `to` lies beyond each of the enclosure's six sides, and `from` within them.
    const Real beyond[6] = {low.x - to.x, to.x - high.x, low.y - to.y, to.y - high.y, low.z - to.z, to.z - high.z};
    const Real within[6] = {from.x - low.x,  high.x - from.x, from.y - low.y,
                            high.y - from.y, from.z - low.z,  high.z - from.z};
    Real walls = -std::numeric_limits<Real>::infinity();
    Real open = walls, to_wall = -walls;
    for (std::uint32_t side = 0; side < 6; ++side) {
        if (((enclosure.open_sides >> side) & 1u) != 0) {
            open = max(open, beyond[side]);
        } else {
            walls = max(walls, beyond[side]);
            to_wall = min(to_wall, within[side]);
        }
    }
    // `margin`, for distances to a side, exceeds the rounding errors of a point on the ray and of the slab test.
    const Real margin = gamma<Real>(64) * (absolute(low.x) + absolute(low.y) + absolute(low.z) + absolute(high.x) +
                                           absolute(high.y) + absolute(high.z));
    if (enclosure.walls == 0 || !enclosure.contains(from) || !(open < -margin)) {
        return WallsBetween::unknown;
    }
    // A ray that starts exactly in the plane of a wall, as in a corner, does not hit that wall, as in keep_nearer.
    return walls < -margin                       ? WallsBetween::none
           : walls > margin && to_wall > Real(0) ? WallsBetween::one
                                                 : WallsBetween::unknown;
}

template <class Real>
PT_HD inline Vec3<Real> face_normal(const SurfaceId& face) {
    const Real sign = face.face_looks_up() ? Real(1) : Real(-1);
    const std::uint32_t axis = face.face_axis();
    return {axis == 0 ? sign : Real(0), axis == 1 ? sign : Real(0), axis == 2 ? sign : Real(0)};
}

// Moves the hit point p of a ray exactly onto the enclosure's side at the face `side`. Returns false if p lies outside
// the enclosure, where the wall's own edges decide.
template <class Real>
PT_HD inline bool point_on_side(const AxisAlignedEnclosure<Real>& enclosure, const SurfaceId& side, const Vec3<Real>& p,
                                Vec3<Real>& position) {
    const std::uint32_t axis = side.face_axis();
    const bool is_low = side.face_looks_up();
    position = {axis == 0 ? (is_low ? enclosure.low.x : enclosure.high.x) : p.x,
                axis == 1 ? (is_low ? enclosure.low.y : enclosure.high.y) : p.y,
                axis == 2 ? (is_low ? enclosure.low.z : enclosure.high.z) : p.z};
    return enclosure.contains(position);
}

}  // namespace pt
