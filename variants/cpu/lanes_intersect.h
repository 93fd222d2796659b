// The nearest object along the rays of a packet: spheres and axis boxes over all lanes at once, other kinds lane by
// lane. The sums and comparisons are those of kernels/sphere.h, box.h, room.h and intersect.h, in their order, so a
// lane's answer has the same bits (tests/unit/lanes_test.cpp); only their branches are selections here.
#pragma once

#include "variants/cpu/lanes.h"

namespace pt::lanes {

template <class Real>
inline Interval<Real> interval(const Sphere<Real>& sphere, const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const Vec3<Real> f = (origin - sphere.centre) * sphere.inverse_radius;
    const Real b = -dot(f, direction);
    const Vec3<Real> closest = f + direction * b;
    const Real discriminant = Real(1) - dot(closest, closest);
    const Real root = square_root_in_range(discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real other = (dot(f, f) - Real(1)) / q;
    return {keep_smaller(q, other) * sphere.radius, keep_larger(q, other) * sphere.radius, discriminant > Real(0)};
}

// Keeps the nearer of the lane's hit and a convex body: entered or left, or, if the ray starts on it (`is_departed`),
// left at the end of the chord.
template <class Real>
inline void keep_nearer(Hits<Real>& hits, std::uint32_t l, const Interval<Real>& crossing, Real chord,
                        std::uint32_t object, bool is_departed, ObjectSide departed) {
    const Real best = hits.t[l];
    const bool inside = !(crossing.near > Real(0));
    const Real t = inside ? crossing.far : crossing.near;
    const bool meets = !is_departed & crossing.hits & (t > Real(0)) & (t < best);
    const bool leaves = is_departed & is_inside(departed) & (chord < best);
    hits.t[l] = leaves ? chord : meets ? t : best;
    const std::uint32_t side = object << 1 | (inside ? 1u : 0u);
    hits.side[l] = leaves ? departed.code : meets ? side : hits.side[l];
}

// What has no loop over lanes: find(hit, ray) for each of them.
template <class Real, class Find>
inline void closest_by_lane(Hits<Real>& hits, const Paths<Real>& paths, const Find& find) {
    for (std::uint32_t l = 0; l < width; ++l) {
        Hit<Real> hit = hits[l];
        find(hit, paths.ray(l));
        hits.set(l, hit);
    }
}

template <class Config>
inline void closest_sphere(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                           const Paths<typename Config::Real>& paths) {
    using Real = typename Config::Real;
    for (std::uint32_t object = 0; object < scene.spheres.size; ++object) {
        const Sphere<Real> sphere = scene.spheres[object];
        if (has<Config>(Feature::near_sphere) && sphere.is_near_eye != 0) {
            closest_by_lane(hits, paths, [&](auto& hit, const auto& ray) {
                closest_body<Config>(hit, scene, NearSphere<Real>{sphere}, object, ray);
            });
            continue;
        }
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const ObjectSide departed{paths.departed[l]};
            const Vec3<Real> origin = at_rest<Config>(scene, object, paths.origin[l], paths.time[l]);
            // `nowhere` holds the number of no object.
            keep_nearer(hits, l, lanes::interval(sphere, origin, paths.direction[l]),
                        chord(sphere, origin, paths.direction[l]), object, departed.object() == object, departed);
        }
    }
}

// Where the rays leave the room.
template <class Real>
struct RoomExits {
    Lanes<Real> t;
    Lanes<std::uint32_t> side;
    Flags known;    // RoomExit::known, of a ray that is in no wall
    Flags nothing;  // the ray is past all axis boxes
    Flags unclear;  // neither
};

template <class Real>
inline bool contains(const Room<Real>& room, const Vec3<Real>& p) {
    return (p.x >= room.low.x) & (p.x <= room.high.x) & (p.y >= room.low.y) & (p.y <= room.high.y) &
           (p.z >= room.low.z) & (p.z <= room.high.z);
}

template <class Real>
inline bool enters_by_open_side(const Room<Real>& room, const Vec3<Real>& origin, const Vec3<Real>& inverse,
                                Real exit) {
    const bool from_high_x = inverse.x < Real(0);
    const bool from_high_y = inverse.y < Real(0);
    const bool from_high_z = inverse.z < Real(0);
    const Real x = ((from_high_x ? room.high.x : room.low.x) - origin.x) * inverse.x;
    const Real y = ((from_high_y ? room.high.y : room.low.y) - origin.y) * inverse.y;
    const Real z = ((from_high_z ? room.high.z : room.low.z) - origin.z) * inverse.z;
    const Real last = keep_larger(keep_larger(x, y), z);
    const Real before = keep_larger(keep_smaller(x, y), keep_smaller(keep_larger(x, y), z));
    const std::uint32_t open = room.open_sides;
    const std::uint32_t open_x = from_high_x ? open >> 1 : open;
    const std::uint32_t open_y = from_high_y ? open >> 3 : open >> 2;
    const std::uint32_t open_z = from_high_z ? open >> 5 : open >> 4;
    return (last > Real(0)) & (before * room_slack<Real> < last) & (last * room_slack<Real> < exit) &
           has_bit(last == x   ? open_x
                   : last == y ? open_y
                               : open_z,
                   0);
}

template <class Real>
inline RoomExit<Real> leave_room(const Room<Real>& room, const Vec3<Real>& origin, const Vec3<Real>& inverse) {
    const bool to_low_x = inverse.x < Real(0);
    const bool to_low_y = inverse.y < Real(0);
    const bool to_low_z = inverse.z < Real(0);
    const Real x = ((to_low_x ? room.low.x : room.high.x) - origin.x) * inverse.x;
    const Real y = ((to_low_y ? room.low.y : room.high.y) - origin.y) * inverse.y;
    const Real z = ((to_low_z ? room.low.z : room.high.z) - origin.z) * inverse.z;
    const Real t = keep_smaller(keep_smaller(x, y), z);
    const Real next = keep_smaller(keep_larger(x, y), keep_larger(keep_smaller(x, y), z));
    const bool plain = (room.walls != 0) &
                       (absolute(inverse.x * inverse.y * inverse.z) < std::numeric_limits<Real>::infinity()) &
                       (t > Real(0)) & (t * room_slack<Real> < next);
    const std::uint32_t side_x = to_low_x ? room.low_side[0].code : room.high_side[0].code;
    const std::uint32_t side_y = to_low_y ? room.low_side[1].code : room.high_side[1].code;
    const std::uint32_t side_z = to_low_z ? room.low_side[2].code : room.high_side[2].code;
    const bool passes = lanes::contains(room, origin) | lanes::enters_by_open_side(room, origin, inverse, t);
    const bool known = plain & passes;
    return {known, t, ObjectSide{t == x ? side_x : t == y ? side_y : side_z}};
}

template <class Config>
inline void leave_room(RoomExits<typename Config::Real>& exits, const SceneView<typename Config::Real>& scene,
                       const Paths<typename Config::Real>& paths, const Vectors<typename Config::Real>& inverses) {
    using Real = typename Config::Real;
    const Room<Real> room = scene.room;
    const std::uint32_t first = scene.first_axis_box();
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> origin = paths.origin[l];
        const RoomExit<Real> exit = lanes::leave_room(room, origin, inverses[l]);
        const ObjectSide departed{paths.departed[l]};
        bool in_wall = departed.exists() & is_inside(departed);
        if constexpr (has<Config>(Feature::dielectric) || has<Config>(Feature::subsurface)) {
            const std::uint32_t box = departed.object() - first;
            in_wall = in_wall & (box < 32) & has_bit(room.walls >> (box & 31u), 0);
        }
        const Interval<Real> reach = slab_interval(room.reach_low, room.reach_high, origin, inverses[l]);
        const bool past = !reach.hits | (reach.far < Real(0));
        const bool known = exit.known & !in_wall;
        const bool nothing = !known & !in_wall & past;
        exits.t[l] = exit.t;
        exits.side[l] = exit.side.code;
        exits.known[l] = known ? 1u : 0u;
        exits.nothing[l] = nothing ? 1u : 0u;
        exits.unclear[l] = known | nothing ? 0u : 1u;
    }
}

// Axis boxes by their slabs; with a room all but its walls.
template <class Config>
inline void closest_by_slabs(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                             const Paths<typename Config::Real>& paths,
                             const Vectors<typename Config::Real>& inverses) {
    using Real = typename Config::Real;
    constexpr bool has_room = has<Config>(Feature::room);
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (has_room && scene.room.is_wall(i)) {
            continue;
        }
        const std::uint32_t object = scene.first_axis_box() + i;
        const std::uint32_t left = has_room && scene.room.is_lamp(i) ? ObjectSide::nowhere : object;
        const AxisBox<Real> box = scene.axis_boxes[i];
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const ObjectSide departed{paths.departed[l]};
            const Vec3<Real> origin = at_rest<Config>(scene, object, paths.origin[l], paths.time[l]);
            const Interval<Real> crossing = slab_interval(box.low, box.high, origin, inverses[l]);
            keep_nearer(hits, l, crossing, max(crossing.far, Real(0)), object, departed.object() == left, departed);
        }
    }
}

template <class Config>
inline void closest_axis_box(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                             const Paths<typename Config::Real>& paths) {
    using Real = typename Config::Real;
    Vectors<Real> inverses;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> direction = paths.direction[l];
        inverses.set(l, {Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z});
    }
    if constexpr (!has<Config>(Feature::room)) {
        closest_by_slabs<Config>(hits, scene, paths, inverses);
        return;
    }
    const Hits<Real> before = hits;
    RoomExits<Real> exits;
    leave_room<Config>(exits, scene, paths, inverses);
    closest_by_slabs<Config>(hits, scene, paths, inverses);
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Real t = hits.t[l];
        const ObjectSide side{hits.side[l]};
        const ObjectSide exit_side{exits.side[l]};
        const bool takes = exit_side.exists() & (exits.t[l] <= t);
        const bool wins = takes & ((exits.t[l] < t) | (exit_side.object() < side.object()));
        const bool nothing = exits.nothing[l] != 0;
        hits.t[l] = nothing ? before.t[l] : takes ? exits.t[l] : t;
        hits.side[l] = nothing ? before.side[l] : wins ? exit_side.code : side.code;
    }
    for (const std::uint32_t l : LaneList(exits.unclear)) {
        Hit<Real> hit = before[l];
        pt::closest_axis_box<Config>(hit, scene, paths.ray(l));
        hits.set(l, hit);
    }
}

template <class Config>
inline void closest_hit(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                        const Paths<typename Config::Real>& paths) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        hits.t[l] = std::numeric_limits<Real>::infinity();
        hits.side[l] = ObjectSide::nowhere;
    }
    if constexpr (has<Config>(Feature::matrix)) {
        closest_by_lane(hits, paths, [&](auto& hit, const auto& ray) { closest_transformed<Config>(hit, scene, ray); });
        return;
    }
    if constexpr (has<Config>(Feature::sphere)) {
        closest_sphere<Config>(hits, scene, paths);
    }
    if (has<Config>(Feature::ellipsoid) && scene.ellipsoids.size != 0) {
        closest_by_lane(hits, paths, [&](auto& hit, const auto& ray) {
            closest_in<Config>(hit, scene, scene.ellipsoids, scene.first_ellipsoid(), ray);
        });
    }
    if (has<Config>(Feature::axis_box) && scene.axis_boxes.size != 0) {
        closest_axis_box<Config>(hits, scene, paths);
    }
    if (has<Config>(Feature::oriented_box) && scene.oriented_boxes.size != 0) {
        closest_by_lane(hits, paths, [&](auto& hit, const auto& ray) {
            closest_in<Config>(hit, scene, scene.oriented_boxes, scene.first_oriented_box(), ray);
        });
    }
    if (has<Config>(Feature::quad) && scene.quads.size != 0) {
        closest_by_lane(hits, paths, [&](auto& hit, const auto& ray) { closest_quad<Config>(hit, scene, ray); });
    }
}

}  // namespace pt::lanes
