// Closest hits of a packet's rays: spheres and axis boxes over all lanes at once, other kinds lane by lane. The sums
// and comparisons are those of kernels/shapes/sphere.h, box.h, axis_aligned_enclosure.h and intersect.h, in their
// order, so a lane's hit has the same bits (tests/unit/lanes_test.cpp); only their branches are selections.
#pragma once

#include "variants/cpu/host_mesh.h"
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

// Keeps the closer of a lane's hit and a convex body that its ray enters or leaves or, if the ray starts on the body
// (`is_departed`), leaves at the end of the chord.
template <class Real>
inline void keep_nearer(Hits<Real>& hits, std::uint32_t l, const Interval<Real>& crossing, Real chord,
                        std::uint32_t object, bool is_departed, SurfaceId origin_surface) {
    const Real best = hits.t[l];
    const bool inside = !(crossing.near > Real(0));
    const Real t = inside ? crossing.far : crossing.near;
    const bool meets = !is_departed & crossing.hits & (t > Real(0)) & (t < best);
    const bool leaves = is_departed & is_inside(origin_surface) & (chord < best);
    hits.t[l] = leaves ? chord : meets ? t : best;
    const std::uint32_t side = object << 1 | (inside ? 1u : 0u);
    hits.side[l] = leaves ? origin_surface.code : meets ? side : hits.side[l];
}

// Intersects shapes for which there is no loop over lanes: calls find(hit, ray) for each lane with the flag `asks`.
template <class Real, class Find>
inline void closest_by_lane(Hits<Real>& hits, const Paths<Real>& paths, const Flags& asks, const Find& find) {
    for (const std::uint32_t l : LaneList(asks)) {
        Hit<Real> hit = hits[l];
        find(hit, paths.ray(l));
        hits.set(l, hit);
    }
}

template <class Config>
inline void closest_sphere(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                           const Paths<typename Config::Real>& paths, const Flags& asks) {
    using Real = typename Config::Real;
    for (std::uint32_t object = 0; object < scene.spheres.size; ++object) {
        const Sphere<Real> sphere = scene.spheres[object];
        if (has<Config>(Feature::near_sphere) && sphere.is_near_eye != 0) {
            closest_by_lane(hits, paths, asks, [&](auto& hit, const auto& ray) {
                closest_body<Config>(hit, scene, NearSphere<Real>{sphere}, object, ray);
            });
            continue;
        }
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const SurfaceId origin_surface{paths.origin_surface[l]};
            const Vec3<Real> origin = at_rest<Config>(scene, object, paths.origin[l], paths.time[l]);
            // A ray that starts on no surface starts on no object: SurfaceId::nowhere has the number of none.
            keep_nearer(hits, l, lanes::interval(sphere, origin, paths.direction[l]),
                        chord(sphere, origin, paths.direction[l]), object, origin_surface.object() == object,
                        origin_surface);
        }
    }
}

// The places where a packet's rays leave the enclosure, one ray a lane.
template <class Real>
struct EnclosureExits {
    Lanes<Real> t;
    Lanes<std::uint32_t> side;
    Flags known;    // lanes with a known exit from the enclosure (EnclosureExit::known), whose ray is in no wall
    Flags nothing;  // lanes whose ray has left the bounding box of all axis boxes behind
    Flags unclear;  // lanes for which neither holds: their rays are intersected one by one
};

// Versions without a branch of three functions of kernels/axis_aligned_enclosure.h. The sums they have in common are
// written twice on purpose: in a function of their own they change the machine code of CUDA kernels.
template <class Real>
inline bool contains(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& p) {
    return (p.x >= enclosure.low.x) & (p.x <= enclosure.high.x) & (p.y >= enclosure.low.y) & (p.y <= enclosure.high.y) &
           (p.z >= enclosure.low.z) & (p.z <= enclosure.high.z);
}

template <class Real>
inline bool enters_by_open_side(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& origin,
                                const Vec3<Real>& inverse, Real exit) {
    const bool from_high_x = inverse.x < Real(0);
    const bool from_high_y = inverse.y < Real(0);
    const bool from_high_z = inverse.z < Real(0);
    const Real x = ((from_high_x ? enclosure.high.x : enclosure.low.x) - origin.x) * inverse.x;
    const Real y = ((from_high_y ? enclosure.high.y : enclosure.low.y) - origin.y) * inverse.y;
    const Real z = ((from_high_z ? enclosure.high.z : enclosure.low.z) - origin.z) * inverse.z;
    const Real last = keep_larger(keep_larger(x, y), z);
    const Real before = keep_larger(keep_smaller(x, y), keep_smaller(keep_larger(x, y), z));
    const std::uint32_t open = enclosure.open_sides;
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
inline EnclosureExit<Real> leave_enclosure(const AxisAlignedEnclosure<Real>& enclosure, const Vec3<Real>& origin,
                                           const Vec3<Real>& inverse) {
    const bool to_low_x = inverse.x < Real(0);
    const bool to_low_y = inverse.y < Real(0);
    const bool to_low_z = inverse.z < Real(0);
    const Real x = ((to_low_x ? enclosure.low.x : enclosure.high.x) - origin.x) * inverse.x;
    const Real y = ((to_low_y ? enclosure.low.y : enclosure.high.y) - origin.y) * inverse.y;
    const Real z = ((to_low_z ? enclosure.low.z : enclosure.high.z) - origin.z) * inverse.z;
    const Real t = keep_smaller(keep_smaller(x, y), z);
    const Real next = keep_smaller(keep_larger(x, y), keep_larger(keep_smaller(x, y), z));
    const bool plain = (enclosure.walls != 0) &
                       (absolute(inverse.x * inverse.y * inverse.z) < std::numeric_limits<Real>::infinity()) &
                       (t > Real(0)) & (t * room_slack<Real> < next);
    const std::uint32_t side_x = to_low_x ? enclosure.low_side[0].code : enclosure.high_side[0].code;
    const std::uint32_t side_y = to_low_y ? enclosure.low_side[1].code : enclosure.high_side[1].code;
    const std::uint32_t side_z = to_low_z ? enclosure.low_side[2].code : enclosure.high_side[2].code;
    const bool passes = lanes::contains(enclosure, origin) | lanes::enters_by_open_side(enclosure, origin, inverse, t);
    const bool known = plain & passes;
    return {known, t, SurfaceId{t == x ? side_x : t == y ? side_y : side_z}};
}

template <class Config>
inline void leave_enclosure(EnclosureExits<typename Config::Real>& exits, const SceneView<typename Config::Real>& scene,
                            const Paths<typename Config::Real>& paths, const Vectors<typename Config::Real>& inverses) {
    using Real = typename Config::Real;
    const AxisAlignedEnclosure<Real> enclosure = scene.enclosure;
    const std::uint32_t first = first_of<ShapeKind::axis_box>(scene);
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> origin = paths.origin[l];
        const EnclosureExit<Real> exit = lanes::leave_enclosure(enclosure, origin, inverses[l]);
        const SurfaceId origin_surface{paths.origin_surface[l]};
        bool in_wall = origin_surface.exists() & is_inside(origin_surface);
        if constexpr (has_insides<Config>()) {
            const std::uint32_t box = origin_surface.object() - first;
            in_wall = in_wall & (box < 32) & has_bit(enclosure.walls >> (box & 31u), 0);
        }
        const Interval<Real> reach = slab_interval(enclosure.reach_low, enclosure.reach_high, origin, inverses[l]);
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

// Intersects the axis boxes by slab tests; with an enclosure, all boxes but its walls.
template <class Config>
inline void closest_by_slabs(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                             const Paths<typename Config::Real>& paths,
                             const Vectors<typename Config::Real>& inverses) {
    using Real = typename Config::Real;
    constexpr bool has_enclosure = has<Config>(Feature::enclosure);
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (has_enclosure && scene.enclosure.is_wall(i)) {
            continue;
        }
        const std::uint32_t object = first_of<ShapeKind::axis_box>(scene) + i;
        const std::uint32_t left = has_enclosure && scene.enclosure.is_lamp(i) ? SurfaceId::nowhere : object;
        const AxisBox<Real> box = scene.axis_boxes[i];
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const SurfaceId origin_surface{paths.origin_surface[l]};
            const Vec3<Real> origin = at_rest<Config>(scene, object, paths.origin[l], paths.time[l]);
            const Interval<Real> crossing = slab_interval(box.low, box.high, origin, inverses[l]);
            keep_nearer(hits, l, crossing, max(crossing.far, Real(0)), object, origin_surface.object() == left,
                        origin_surface);
        }
    }
}

template <class Config>
inline void closest_axis_box(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                             const Paths<typename Config::Real>& paths, const Flags& asks) {
    using Real = typename Config::Real;
    Vectors<Real> inverses;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> direction = paths.direction[l];
        inverses.set(l, {Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z});
    }
    if constexpr (!has<Config>(Feature::enclosure)) {
        closest_by_slabs<Config>(hits, scene, paths, inverses);
        return;
    }
    const Hits<Real> before = hits;
    EnclosureExits<Real> exits;
    leave_enclosure<Config>(exits, scene, paths, inverses);
    closest_by_slabs<Config>(hits, scene, paths, inverses);
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Real t = hits.t[l];
        const SurfaceId side{hits.side[l]};
        const SurfaceId exit_side{exits.side[l]};
        const bool takes = exit_side.exists() & (exits.t[l] <= t);
        const bool wins = takes & ((exits.t[l] < t) | (exit_side.object() < side.object()));
        const bool nothing = exits.nothing[l] != 0;
        hits.t[l] = nothing ? before.t[l] : takes ? exits.t[l] : t;
        hits.side[l] = nothing ? before.side[l] : wins ? exit_side.code : side.code;
    }
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        exits.unclear[l] &= asks[l];
    }
    for (const std::uint32_t l : LaneList(exits.unclear)) {
        Hit<Real> hit = before[l];
        pt::closest_axis_box<Config>(hit, scene, paths.ray(l));
        hits.set(l, hit);
    }
}

// Whether the host's accelerator can search a mesh for all lanes at once, and meshes are searched one after the other.
template <class Config>
inline bool meets_in_lanes(const SceneView<typename Config::Real>& scene,
                           const MeshInstance<typename Config::Real>& mesh) {
    const auto* const prepared = static_cast<const HostMesh*>(mesh.geometry.native);
    return Config::Accelerator::is_chosen_at_run_time && scene.mesh_search->meet_meshes == nullptr &&
           prepared != nullptr && prepared->meet_in_lanes != nullptr;
}

// Keeps in `hits` the closest triangle of one mesh, in lanes with the flag `asks`. `enough`: see MeetMeshInLanes.
template <class Config>
inline void closest_mesh(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                         std::uint32_t number, const Paths<typename Config::Real>& paths, const Flags& asks,
                         const Lanes<typename Config::Real>& enough) {
    using Real = typename Config::Real;
    const std::uint32_t object = first_of<ShapeKind::mesh>(scene) + number;
    const MeshInstance<Real>& mesh = scene.meshes[number];
    const auto meet = static_cast<const HostMesh*>(mesh.geometry.native)->meet_in_lanes;
    if constexpr (has<Config>(Feature::motion)) {
        Vectors<Real> origin;
        for (std::uint32_t l = 0; l < width; ++l) {
            origin.set(l, at_rest<Config>(scene, object, paths.origin[l], paths.time[l]));
        }
        meet(hits, asks, mesh, object, origin, paths, enough);
    } else {
        meet(hits, asks, mesh, object, paths.origin, paths, enough);
    }
}

template <class Config>
inline void closest_of_meshes(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                              const Paths<typename Config::Real>& paths, const Flags& asks) {
    using Real = typename Config::Real;
    if constexpr (std::is_same_v<Real, float>) {
        if (scene.meshes.size != 0 && meets_in_lanes<Config>(scene, scene.meshes[0])) {
            const Lanes<Real> nothing{};
            for (std::uint32_t i = 0; i < scene.meshes.size; ++i) {
                closest_mesh<Config>(hits, scene, i, paths, asks, nothing);
            }
            return;
        }
    }
    closest_by_lane(hits, paths, asks, [&](auto& hit, const auto& ray) {
        pt::closest_of_meshes<Config>(hit, scene, scene.meshes, ray, WithClosest{});
    });
}

// Intersects a packet's rays with all objects of one kind. Spheres and axis boxes have loops that g++ vectorises.
template <class Config, ShapeKind kind, class Shapes>
inline void closest_of(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                       const Shapes& shapes, const Paths<typename Config::Real>& paths, const Flags& asks) {
    if constexpr (kind == ShapeKind::sphere) {
        closest_sphere<Config>(hits, scene, paths, asks);
    } else if (shapes.size == 0) {
        return;
    } else if constexpr (kind == ShapeKind::axis_box) {
        closest_axis_box<Config>(hits, scene, paths, asks);
    } else if constexpr (kind == ShapeKind::mesh) {
        closest_of_meshes<Config>(hits, scene, paths, asks);
    } else {
        closest_by_lane(hits, paths, asks,
                        [&](auto& hit, const auto& ray) { pt::closest_of<Config, kind>(hit, scene, shapes, ray); });
    }
}

// Finds the closest hits of a packet's rays in lanes with the flag `asks`; the hits of other lanes are undefined.
template <class Config>
inline void closest_hit(Hits<typename Config::Real>& hits, const SceneView<typename Config::Real>& scene,
                        const Paths<typename Config::Real>& paths, const Flags& asks) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        hits.t[l] = std::numeric_limits<Real>::infinity();
        hits.side[l] = SurfaceId::nowhere;
        if constexpr (has<Config>(Feature::mesh)) {
            hits.primitive[l] = 0;
        }
    }
    if constexpr (has<Config>(Feature::matrix)) {
        closest_by_lane(hits, paths, asks,
                        [&](auto& hit, const auto& ray) { closest_transformed<Config>(hit, scene, ray); });
        return;
    }
#define PT_CLOSEST(name, array, Type)                                               \
    if constexpr (has<Config>(Feature::name)) {                                     \
        closest_of<Config, ShapeKind::name>(hits, scene, scene.array, paths, asks); \
    }
    PT_SHAPES(PT_CLOSEST)
#undef PT_CLOSEST
}

}  // namespace pt::lanes
