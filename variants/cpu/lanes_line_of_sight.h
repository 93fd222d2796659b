// Shadow rays to known points on lights, over all lanes of a packet at once: kernels/line_of_sight.h. Spheres and axis
// boxes are tested in vectors of lanes; other kinds, and rays that may cross an enclosure's wall, lane by lane. The
// sums and comparisons are the kernels', so a lane's result is the same.
#pragma once

#include "kernels/line_of_sight.h"
#include "variants/cpu/lanes_intersect.h"

namespace pt::lanes {

// The shadow rays of a packet up to their points on lights: Segment (kernels/line_of_sight.h) by lane.
template <class Real>
struct Sights {
    Lanes<Real> before, about;   // distances just below and just above that of the ray's light point
    Lanes<std::uint32_t> light;  // object that the ray's light point is on
    Flags asks;                  // whether the lane has a ray to a known light point
    Flags blocked, unsure;
    Flags by_lane;  // lanes whose ray may cross a wall: it is tested by itself, whatever the flags above say
};

// Records an object that a lane's shadow ray meets at distance t, as Segment::is_hidden_by does.
template <class Real>
inline void note_crossing(Sights<Real>& sights, std::uint32_t l, bool meets, Real t) {
    sights.unsure[l] |= meets & (t < sights.about[l]) ? 1u : 0u;
    sights.blocked[l] |= meets & (t < sights.before[l]) ? 1u : 0u;
}

// Records a convex body that a lane's shadow ray enters or leaves or, if the ray starts on the body (`is_departed`),
// leaves at the end of the chord.
template <class Real>
inline void note_body(Sights<Real>& sights, std::uint32_t l, const Interval<Real>& crossing, Real chord,
                      std::uint32_t object, bool is_departed, SurfaceId origin_surface) {
    const Real entered = crossing.near > Real(0) ? crossing.near : crossing.far;
    const bool is_other = sights.light[l] != object;
    const bool meets = !is_departed & crossing.hits & (entered > Real(0));
    const bool leaves = is_departed & is_inside(origin_surface);
    note_crossing(sights, l, is_other & (leaves | meets), leaves ? chord : entered);
}

// Marks shadow rays that may cross a wall of the enclosure as `by_lane`; others need no wall test (walls_between).
template <class Config>
inline void leave_out_walls(Sights<typename Config::Real>& sights, const SceneView<typename Config::Real>& scene,
                            const Paths<typename Config::Real>& shadow, const Lanes<typename Config::Real>& distance) {
    using Real = typename Config::Real;
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const AxisAlignedEnclosure<Real> enclosure = scene.enclosure;
    const Vec3<Real> low = enclosure.low, high = enclosure.high;
    const auto is_open = [&](std::uint32_t side) { return ((enclosure.open_sides >> side) & 1u) != 0; };
    // The enclosure split in two boxes: its open sides alone, and its walls alone; a side left out lies at infinity.
    const Vec3<Real> open_low{is_open(0) ? low.x : -infinity, is_open(2) ? low.y : -infinity,
                              is_open(4) ? low.z : -infinity};
    const Vec3<Real> open_high{is_open(1) ? high.x : infinity, is_open(3) ? high.y : infinity,
                               is_open(5) ? high.z : infinity};
    const Vec3<Real> wall_low{is_open(0) ? -infinity : low.x, is_open(2) ? -infinity : low.y,
                              is_open(4) ? -infinity : low.z};
    const Vec3<Real> wall_high{is_open(1) ? infinity : high.x, is_open(3) ? infinity : high.y,
                               is_open(5) ? infinity : high.z};
    const auto beyond = [](const Vec3<Real>& from, const Vec3<Real>& up_to, const Vec3<Real>& p) {
        return max(max(max(from.x - p.x, p.x - up_to.x), max(from.y - p.y, p.y - up_to.y)),
                   max(from.z - p.z, p.z - up_to.z));
    };
    const Real margin = gamma<Real>(64) * (absolute(low.x) + absolute(low.y) + absolute(low.z) + absolute(high.x) +
                                           absolute(high.y) + absolute(high.z));
    const bool has_walls = enclosure.walls != 0;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const SurfaceId origin_surface{shadow.origin_surface[l]};
        const Vec3<Real> origin = shadow.origin[l];
        const Vec3<Real> to = origin + shadow.direction[l] * distance[l];
        const bool is_in_body = origin_surface.exists() & is_inside(origin_surface);
        const bool is_known =
            has_walls & lanes::contains(enclosure, origin) & (beyond(open_low, open_high, to) < -margin) & !is_in_body;
        const bool is_within = is_known & (beyond(wall_low, wall_high, to) < -margin);
        sights.by_lane[l] = is_within ? 0u : sights.asks[l];
    }
}

template <class Config>
inline void note_spheres(Sights<typename Config::Real>& sights, const SceneView<typename Config::Real>& scene,
                         const Paths<typename Config::Real>& shadow) {
    using Real = typename Config::Real;
    for (std::uint32_t object = 0; object < scene.spheres.size; ++object) {
        const Sphere<Real> sphere = scene.spheres[object];
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const SurfaceId origin_surface{shadow.origin_surface[l]};
            const Vec3<Real> origin = at_rest<Config>(scene, object, shadow.origin[l], shadow.time[l]);
            note_body(sights, l, lanes::interval(sphere, origin, shadow.direction[l]),
                      chord(sphere, origin, shadow.direction[l]), object, origin_surface.object() == object,
                      origin_surface);
        }
    }
}

template <class Config>
inline void note_axis_boxes(Sights<typename Config::Real>& sights, const SceneView<typename Config::Real>& scene,
                            const Paths<typename Config::Real>& shadow) {
    using Real = typename Config::Real;
    const std::uint32_t only_light = scene.lights.size == 1 ? scene.lights[0].object : SurfaceId::nowhere;
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        const std::uint32_t object = first_of<ShapeKind::axis_box>(scene) + i;
        if ((has<Config>(Feature::enclosure) && scene.enclosure.is_wall(i)) || object == only_light) {
            continue;
        }
        const AxisBox<Real> box = scene.axis_boxes[i];
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const SurfaceId origin_surface{shadow.origin_surface[l]};
            const Vec3<Real> direction = shadow.direction[l];
            const Vec3<Real> origin = at_rest<Config>(scene, object, shadow.origin[l], shadow.time[l]);
            const Interval<Real> crossing = slab_interval(
                box.low, box.high, origin, {Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z});
            note_body(sights, l, crossing, max(crossing.far, Real(0)), object, origin_surface.object() == object,
                      origin_surface);
        }
    }
}

// Tests shadow rays against all objects with meshes, in lanes with the flag `asks`.
template <class Config>
inline void note_meshes(Sights<typename Config::Real>& sights, const SceneView<typename Config::Real>& scene,
                        const Paths<typename Config::Real>& shadow, Flags asks) {
    using Real = typename Config::Real;
    Hits<Real> found;
    for (std::uint32_t i = 0; i < scene.meshes.size; ++i) {
        for (std::uint32_t l = 0; l < width; ++l) {
            found.set(l, Hit<Real>{sights.about[l], SurfaceId{}, 0});
        }
        closest_mesh<Config>(found, scene, i, shadow, asks, sights.before);
        for (std::uint32_t l = 0; l < width; ++l) {
            note_crossing(sights, l, SurfaceId{found.side[l]}.exists(), found.t[l]);
            asks[l] = asks[l] & ~sights.blocked[l];
        }
    }
}

// Tests shadow rays against all objects of one kind, in the lanes that are not blocked yet.
template <class Config, ShapeKind kind, class Shapes>
inline void note_kind(Sights<typename Config::Real>& sights, const SceneView<typename Config::Real>& scene,
                      const Shapes& shapes, const Paths<typename Config::Real>& shadow,
                      const Lanes<typename Config::Real>& distance) {
    using Real = typename Config::Real;
    if constexpr (kind == ShapeKind::sphere && !has<Config>(Feature::near_sphere)) {
        note_spheres<Config>(sights, scene, shadow);
    } else if constexpr (kind == ShapeKind::axis_box) {
        note_axis_boxes<Config>(sights, scene, shadow);
    } else if (shapes.size != 0) {
        Flags asks;
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            asks[l] = sights.asks[l] & ~(sights.blocked[l] | sights.by_lane[l]);
        }
        if constexpr (kind == ShapeKind::mesh) {
            if (meets_in_lanes<Config>(scene, shapes[0])) {
                note_meshes<Config>(sights, scene, shadow, asks);
                return;
            }
        }
        for (const std::uint32_t l : LaneList(asks)) {
            const Ray<Real> ray = shadow.ray(l);
            Segment<Real> segment(ray, sights.light[l], distance[l]);
            const bool hides = is_hidden_by_kind<Config, kind>(segment, scene, shapes, true);
            sights.blocked[l] |= hides ? 1u : 0u;
            sights.unsure[l] |= segment.unsure ? 1u : 0u;
        }
    }
}

// hit_of_light (kernels/next_event.h) for the lanes flagged in `sends`; on return those flagged see their light points.
// `distance`: to these points; 0: the point is not known, and the light is seen if it, or its triangle in `primitives`,
// is the closest hit.
template <class Config>
inline void look_along(Flags& sends, const SceneView<typename Config::Real>& scene, const Lanes<std::uint32_t>& lights,
                       const Lanes<std::uint32_t>& primitives, const Paths<typename Config::Real>& shadow,
                       const Lanes<typename Config::Real>& distance) {
    using Real = typename Config::Real;
    Sights<Real> sights;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const bool is_known = distance[l] > Real(0);
        sights.before[l] = distance[l] * (Real(1) - point_rounding<Real>());
        sights.about[l] = distance[l] * (Real(1) + point_rounding<Real>());
        sights.light[l] = lights[l];
        sights.asks[l] = is_known ? sends[l] : 0u;
        sights.blocked[l] = 0;
        sights.unsure[l] = is_known ? 0u : 1u;
        sights.by_lane[l] = 0;
    }
    if constexpr (has<Config>(Feature::enclosure)) {
        leave_out_walls<Config>(sights, scene, shadow, distance);
    }
#define PT_NOTE(name, array, Type)                                                        \
    if constexpr (has<Config>(Feature::name)) {                                           \
        note_kind<Config, ShapeKind::name>(sights, scene, scene.array, shadow, distance); \
    }
    PT_SHAPES(PT_NOTE)
#undef PT_NOTE
    for (const std::uint32_t l : LaneList(sights.by_lane)) {
        const Sight sight = line_of_sight<Config>(scene, lights[l], shadow.ray(l), distance[l]);
        sights.blocked[l] = sight == Sight::blocked ? 1u : 0u;
        sights.unsure[l] = sight == Sight::unsure ? 1u : 0u;
    }
    Flags asks_closest;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        sends[l] = sends[l] & ~sights.blocked[l];
        asks_closest[l] = sends[l] & sights.unsure[l];
    }
    for (const std::uint32_t l : LaneList(asks_closest)) {
        const Hit<Real> hit = pt::closest_hit<Config>(scene, shadow.ray(l));
        const bool is_met =
            hit.side.exists() && hit.side.object() == lights[l] && is_of_primitive<Config>(hit, primitives[l]);
        const bool sees =
            is_met || (distance[l] > Real(0) && sees_point<Config>(scene, lights[l], shadow.ray(l), distance[l], hit));
        sends[l] = sees ? 1u : 0u;
    }
}

}  // namespace pt::lanes
