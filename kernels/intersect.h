// Closest hit along a ray, and the position and normal of the surface at the hit.
// No epsilon is used: a ray knows the surface that it starts on (Path::origin_surface), and a convex body is hit again
// only from inside, at its other root.
#pragma once

#include "kernels/visit_shape.h"

namespace pt {

template <class Real>
struct Ray {
    Vec3<Real> origin, direction;
    Real time;
    SurfaceId origin_surface;
    std::uint32_t primitive = 0;  // primitive on which the ray starts, of the object of origin_surface
};

template <class Real>
PT_HD inline Ray<Real> ray_of(const Path<Real>& path) {
    return {path.origin, path.direction, path.time, path.origin_surface, path.primitive};
}

// Whether a hit is on the primitive of this number; true for shapes other than meshes, which are one primitive.
template <class Config, class Real>
PT_HD inline bool is_of_primitive(const Hit<Real>& hit, std::uint32_t primitive) {
    return !has<Config>(Feature::mesh) || hit.primitive == primitive;
}

// The primitive of its shape that a hit names: the shape itself or, for a mesh, one of its triangles.
template <class Shape>
PT_HD inline const Shape& primitive_of(const Shape& shape, std::uint32_t) {
    return shape;
}
template <class Real>
PT_HD inline MeshTriangle<Real> primitive_of(const MeshInstance<Real>& mesh, std::uint32_t primitive) {
    return {mesh, primitive};
}

// Position of a ray origin in the frame of a moving object: the object stands still, the ray is moved back. Rounding is
// the same at every call, so that the surface found by a search is hit again when its position is computed.
template <class Config, class Scene>
PT_HD inline Vec3<typename Config::Real> at_rest(const Scene& scene, std::uint32_t object,
                                                 const Vec3<typename Config::Real>& point, typename Config::Real time) {
    if constexpr (has<Config>(Feature::motion)) {
        return point - rounded_product(scene.velocity[object], time);
    } else {
        return point;
    }
}

template <class Config, class Scene>
PT_HD inline Vec3<typename Config::Real> in_motion(const Scene& scene, std::uint32_t object,
                                                   const Vec3<typename Config::Real>& point,
                                                   typename Config::Real time) {
    if constexpr (has<Config>(Feature::motion)) {
        return point + rounded_product(scene.velocity[object], time);
    } else {
        return point;
    }
}

// The spheres of the scene as NearSphere, for a kernel with Feature::near_sphere.
template <class Real, class Spheres>
struct NearSpheres {
    const Spheres& spheres;
    std::uint32_t size;

    PT_HD NearSphere<Real> operator[](std::uint32_t i) const { return {spheres[i]}; }
};

// The form of a shape that the kernel intersects: the shape itself or, for spheres that may be near the eye,
// NearSphere.
template <class Config, class Shape>
PT_HD inline const Shape& as_met(const Shape& shape) {
    return shape;
}
template <class Config, class Real>
PT_HD inline decltype(auto) as_met(const Sphere<Real>& sphere) {
    if constexpr (has<Config>(Feature::near_sphere)) {
        return NearSphere<Real>{sphere};
    } else {
        return (sphere);
    }
}

template <class Config, class Shape>
PT_HD inline decltype(auto) as_met(const Shape& shape, std::uint32_t) {
    return as_met<Config>(shape);
}
template <class Config, class Real>
PT_HD inline MeshTriangle<Real> as_met(const MeshInstance<Real>& mesh, std::uint32_t primitive) {
    return {mesh, primitive};
}

template <class Config, class Scene>
PT_HD inline decltype(auto) spheres_of(const Scene& scene) {
    if constexpr (has<Config>(Feature::near_sphere)) {
        return NearSpheres<typename Config::Real, decltype(scene.spheres)>{scene.spheres, scene.spheres.size};
    } else {
        return (scene.spheres);
    }
}

// The closest hit is the least (t, object): of several objects at one distance the one with the lowest index. A search
// that visits objects by ascending index has the lower one already when an equal one comes, and need not compare
// indices.
enum class VisitOrder { ascending, any };

template <VisitOrder order, class Real>
PT_HD inline bool comes_before(Real t, std::uint32_t object, const Hit<Real>& best) {
    if constexpr (order == VisitOrder::ascending) {
        return t < best.t;
    } else {
        return t < best.t || (t == best.t && best.side.exists() && object < best.side.object());
    }
}

// Updates the closest hit `best` by a convex body crossed over [near, far]: entered from outside, or left from inside.
template <VisitOrder order = VisitOrder::ascending, class Real>
PT_HD inline void keep_nearer(Hit<Real>& best, const Interval<Real>& crossing, std::uint32_t object) {
    if (!crossing.hits) {
        return;
    }
    const bool inside = !(crossing.near > Real(0));
    const Real t = inside ? crossing.far : crossing.near;
    if (t > Real(0) && comes_before<order>(t, object, best)) {
        best.t = t;
        best.side = SurfaceId::of(object, inside);
    }
}

// Updates the closest hit `best` by the far end of the chord through the body that the ray starts on and runs in.
template <VisitOrder order = VisitOrder::ascending, class Real>
PT_HD inline void keep_nearer(Hit<Real>& best, Real chord, const SurfaceId& origin_surface) {
    if (comes_before<order>(chord, origin_surface.object(), best)) {
        best.t = chord;
        best.side = origin_surface;
    }
}

// Updates the closest hit `best` by a flat surface, which has a single intersection. `from_behind`: the ray runs along
// the surface's normal.
template <VisitOrder order = VisitOrder::ascending, class Real>
PT_HD inline void keep_nearer_flat(Hit<Real>& best, const Interval<Real>& crossing, std::uint32_t object,
                                   bool from_behind) {
    if (crossing.hits && crossing.near > Real(0) && comes_before<order>(crossing.near, object, best)) {
        best.t = crossing.near;
        best.side = SurfaceId::of(object, from_behind);
    }
}

// Whether a shape's intersection test gives distance 0 for a ray that misses. A hit never has distance 0, so the flag
// Interval::hits needs no test.
template <class Shape>
inline constexpr bool misses_at_zero = requires {
    Shape::misses_at_zero;
};

template <class Config, class Scene, class Body>
PT_HD inline void closest_body(Hit<typename Config::Real>& best, const Scene& scene, const Body& body,
                               std::uint32_t object, const Ray<typename Config::Real>& ray) {
    const auto origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    const bool starts_here = ray.origin_surface.is_of(object);
    if (!starts_here) {
        auto crossing = interval(body, origin, ray.direction);
        crossing.hits = misses_at_zero<Body> || crossing.hits;
        keep_nearer(best, crossing, object);
    } else if (ray.origin_surface.inside()) {
        keep_nearer(best, chord(body, origin, ray.direction), ray.origin_surface);
    }
}

template <class Config, class Scene, class Bodies>
PT_HD inline void closest_in(Hit<typename Config::Real>& best, const Scene& scene, const Bodies& bodies,
                             std::uint32_t first, const Ray<typename Config::Real>& ray) {
    for (std::uint32_t i = 0; i < bodies.size; ++i) {
        closest_body<Config>(best, scene, bodies[i], first + i, ray);
    }
}

template <class Config, class Scene>
PT_HD inline void closest_axis_box(Hit<typename Config::Real>& best, const Scene& scene,
                                   const Ray<typename Config::Real>& ray, const Vec3<typename Config::Real>& inverse,
                                   bool without_walls) {
    using Real = typename Config::Real;
    const std::uint32_t first = first_of<ShapeKind::axis_box>(scene);
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if constexpr (has<Config>(Feature::enclosure)) {
            if (without_walls && scene.enclosure.is_wall(i)) {
                continue;
            }
        }
        const std::uint32_t object = first + i;
        const Vec3<Real> origin = at_rest<Config>(scene, object, ray.origin, ray.time);
        // The axis box is copied: by reference, nvcc 13.0 loads plane by plane, at an address that varies by lane.
        const AxisBox<Real> box = scene.axis_boxes[i];
        // A ray known to hit no wall starts clearly inside the enclosure, and so its direction has a finite reciprocal.
        const Interval<Real> crossing = without_walls ? finite_slab_interval(box.low, box.high, origin, inverse)
                                                      : slab_interval(box.low, box.high, origin, inverse);
        bool starts_here = ray.origin_surface.is_of(object);
        if constexpr (has<Config>(Feature::enclosure)) {
            starts_here = starts_here && !scene.enclosure.is_lamp(i);  // compile-time hint: no path starts on a lamp
        }
        if (!starts_here) {
            keep_nearer(best, crossing, object);
        } else if (ray.origin_surface.inside()) {
            keep_nearer(best, max(crossing.far, Real(0)), ray.origin_surface);
        }
    }
}

template <class Config>
inline constexpr bool is_long_kernel = (Config::features & light_selections) != 0;

// closest_axis_box with a loop that a device does not unroll, for kernels with an enclosure that stall on instruction
// fetch: those that choose lights. (One function body for both forms changes all kernels under nvcc 13.0.)
template <class Config, bool without_walls, class Scene>
PT_HD inline void closest_axis_box_rolled(Hit<typename Config::Real>& best, const Scene& scene,
                                          const Ray<typename Config::Real>& ray,
                                          const Vec3<typename Config::Real>& inverse) {
    using Real = typename Config::Real;
    const std::uint32_t first = first_of<ShapeKind::axis_box>(scene);
    PT_ROLLED
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (without_walls && scene.enclosure.is_wall(i)) {
            continue;
        }
        const std::uint32_t object = first + i;
        const AxisBox<Real> box = scene.axis_boxes[i];
        const Vec3<Real> origin = at_rest<Config>(scene, object, ray.origin, ray.time);
        const Interval<Real> crossing = without_walls ? finite_slab_interval(box.low, box.high, origin, inverse)
                                                      : slab_interval(box.low, box.high, origin, inverse);
        const bool starts_here = ray.origin_surface.is_of(object) && !scene.enclosure.is_lamp(i);
        if (!starts_here) {
            keep_nearer(best, crossing, object);
        } else if (ray.origin_surface.inside()) {
            keep_nearer(best, max(crossing.far, Real(0)), ray.origin_surface);
        }
    }
}

template <class Config, class Scene>
PT_HD inline void closest_axis_box(Hit<typename Config::Real>& best, const Scene& scene,
                                   const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    const Vec3<Real> inverse = reciprocal(ray.direction);
    if constexpr (has<Config>(Feature::enclosure)) {
        const EnclosureExit<Real> exit =
            leave_enclosure(scene.enclosure, ray.origin, inverse, has_finite_reciprocal(ray.direction));
        // A ray that starts inside a wall, even on its face, is not taken as inside the enclosure.
        bool in_wall = ray.origin_surface.exists() && ray.origin_surface.inside();
        if constexpr (has_insides<Config>()) {
            in_wall =
                in_wall && scene.enclosure.is_wall(ray.origin_surface.object() - first_of<ShapeKind::axis_box>(scene));
        }
        if (exit.known && !in_wall) {
            if constexpr (is_long_kernel<Config>) {
                closest_axis_box_rolled<Config, true>(best, scene, ray, inverse);
            } else {
                closest_axis_box<Config>(best, scene, ray, inverse, true);
            }
            if (exit.side.exists() && exit.t <= best.t) {
                const bool wins = exit.t < best.t || exit.side.precedes(best.side);
                best.side = wins ? exit.side : best.side;
                best.t = exit.t;
            }
            return;
        }
        // All axis boxes are skipped if the ray misses their bounding box: rounding is monotonic, so the ray misses
        // each of them too.
        const Interval<Real> reach =
            slab_interval(scene.enclosure.reach_low, scene.enclosure.reach_high, ray.origin, inverse);
        if (!in_wall && (!reach.hits || reach.far < Real(0))) {
            return;
        }
    }
    if constexpr (has<Config>(Feature::enclosure) && is_long_kernel<Config>) {
        closest_axis_box_rolled<Config, false>(best, scene, ray, inverse);
    } else {
        closest_axis_box<Config>(best, scene, ray, inverse, false);
    }
}

// Updates the closest hit `best` by some flat surfaces. A ray that starts on one of them does not hit it again.
template <class Config, class Scene, class Flats>
PT_HD inline void closest_flat(Hit<typename Config::Real>& best, const Scene& scene, const Flats& flats,
                               std::uint32_t first, const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    for (std::uint32_t i = 0; i < flats.size; ++i) {
        const std::uint32_t object = first + i;
        const auto& flat = flats[i];
        const Interval<Real> crossing =
            interval(flat, at_rest<Config>(scene, object, ray.origin, ray.time), ray.direction);
        if (!ray.origin_surface.is_of(object)) {
            keep_nearer_flat(best, crossing, object, dot(ray.direction, flat.normal) > Real(0));
        }
    }
}

// A ray in the space of one mesh, with what its triangles' tests need.
template <class Real>
struct MeshRay {
    Vec3<Real> origin, direction;
    ShearedDirection<Real> sheared;
    Vec3<Real> along;  // coordinates of the ray origin along the axes kx, ky and kz of `sheared`
    std::uint32_t object;
    std::uint32_t passed_over;  // triangle that the ray starts on and cannot hit, or `nothing`

    static constexpr std::uint32_t nothing = ~0u;

    PT_HD static MeshRay of(const MeshInstance<Real>& mesh, std::uint32_t object, const Vec3<Real>& origin,
                            const Ray<Real>& ray) {
        const Vec3<Real> from = mesh.point_in(origin), direction = mesh.direction_in(ray.direction);
        const auto sheared = ShearedDirection<Real>::of(direction);
        return {
            from,    direction,
            sheared, {component_of(from, sheared.kx), component_of(from, sheared.ky), component_of(from, sheared.kz)},
            object,  ray.origin_surface.is_of(object) ? ray.primitive : nothing};
    }
};

// Updates the closest hit `best` by the hit of a triangle, by ascending (t, object, primitive).
template <class Real>
PT_HD inline void keep_nearer(Hit<Real>& best, const TriangleHit<Real>& hit, std::uint32_t primitive,
                              const MeshRay<Real>& ray) {
    if (!hit.hits || primitive == ray.passed_over) {
        return;
    }
    const bool same = best.side.is_of(ray.object) && primitive < best.primitive;
    if (hit.t < best.t || (hit.t == best.t && best.side.exists() && (ray.object < best.side.object() || same))) {
        best.t = hit.t;
        best.side = SurfaceId::of(ray.object, hit.from_behind);
        best.primitive = primitive;
    }
}

// Coordinates of the corners of a leaf's triangle along one axis, relative to the ray origin.
template <class Real>
PT_HD inline Vec3<Real> corners_along(const LeafTriangle::Row& row, const Real& origin) {
    return Vec3<Real>(Real(row.a) - origin, Real(row.b) - origin, Real(row.c) - origin);
}

// Updates the closest hit `best` by a leaf's triangle. Its rows of coordinates lie in memory, to be chosen by address.
template <class Real>
PT_HD inline void meet_triangle(Hit<Real>& best, const LeafTriangle& leaf, const MeshRay<Real>& ray) {
    // Each row of the leaf's triangle is loaded whole, in one memory access.
    const LeafTriangle::Row z = leaf.row[ray.sheared.kz], x = leaf.row[ray.sheared.kx], y = leaf.row[ray.sheared.ky];
    const TriangleHit<Real> hit = intersect_along(corners_along(x, ray.along.x), corners_along(y, ray.along.y),
                                                  corners_along(z, ray.along.z), ray.sheared.shear);
    keep_nearer(best, hit, z.primitive, ray);
}

// Termination rule of a closest-hit search through meshes: no hit ends the search.
struct WithClosest {
    template <class Real>
    PT_HD static constexpr bool end_if_met(Hit<Real>&) {
        return false;
    }
    template <class Real>
    PT_HD static constexpr Real distance() {
        return Real(0);
    }
};
// Termination rule of a search through meshes for any hit nearer than a limit. The first such hit sets best.t to -1: no
// box and no triangle is nearer, so every tree's traversal ends by itself.
template <class Number>
struct NearerThan {
    Number limit;

    PT_HD bool end_if_met(Hit<Number>& best) const {
        const bool ends = best.t < limit;
        best.t = ends ? Number(-1) : best.t;
        return ends;
    }
    template <class Real>
    PT_HD Real distance() const {
        return limit;
    }
};

// Updates the closest hit `best` by traversing a mesh's own tree; `end` is the rule by which the search may stop early.
template <class Accelerator, class Real, class Counter, class End>
PT_HD inline void closest_in_mesh(Hit<Real>& best, const MeshInstance<Real>& mesh, std::uint32_t object,
                                  const Vec3<Real>& origin, const Ray<Real>& ray, Counter& counter, const End& end) {
    const MeshRay<Real> in_mesh = MeshRay<Real>::of(mesh, object, origin, ray);
    Accelerator::traverse(
        mesh.geometry.tree, in_mesh.origin, in_mesh.direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t slot = first; slot < first + count; ++slot) {
                meet_triangle(best, mesh.geometry.leaves[slot], in_mesh);
                if (end.end_if_met(best)) {
                    return;
                }
            }
        },
        counter);
}

// Updates the closest hit `best` by the triangles of one mesh. Where the accelerator is chosen at run time
// (RunTimeAccelerator), the scene's function MeshSearch::meet_mesh does so.
template <class Config, class Scene, class End>
PT_HD inline void closest_mesh(Hit<typename Config::Real>& best, const Scene& scene,
                               const MeshInstance<typename Config::Real>& mesh, std::uint32_t object,
                               const Ray<typename Config::Real>& ray, const End& end) {
    const auto origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    if constexpr (Config::Accelerator::is_chosen_at_run_time) {
        scene.mesh_search->meet_mesh(best, mesh, object, origin, ray, end.template distance<typename Config::Real>());
    } else {
        NoTraversalCounter counter;
        closest_in_mesh<typename Config::Accelerator>(best, mesh, object, origin, ray, counter, end);
    }
}

// Searches all objects that show meshes by the top-level tree over these objects (TLAS).
template <class Config, class Scene, class Meshes, class End>
PT_HD inline void closest_by_object_tree(Hit<typename Config::Real>& best, const Scene& scene, const Meshes& meshes,
                                         const Ray<typename Config::Real>& ray, const End& end) {
    traverse(scene.mesh_search->objects, ray.origin, ray.direction, best.t, [&](std::uint32_t i) {
        closest_mesh<Config>(best, scene, meshes[i], first_of<ShapeKind::mesh>(scene) + i, ray, end);
    });
}

// Searches all mesh instances by one tree over their triangles. Each triangle is intersected in its instance's own
// space, as in a traversal of the instance's own tree.
template <class Config, class Scene, class Meshes, class End>
PT_HD inline void closest_by_flat_tree(Hit<typename Config::Real>& best, const Scene& scene, const Meshes& meshes,
                                       const Ray<typename Config::Real>& ray, const End& end) {
    using Real = typename Config::Real;
    const FlatTree& flat = scene.mesh_search->flat;
    MeshRay<Real> in_mesh{};
    std::uint32_t seen_by = meshes.size;  // mesh instance into whose space `in_mesh` is taken; at first none
    NoTraversalCounter counter;
    Config::Accelerator::traverse(
        flat.tree, ray.origin, ray.direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t i = first; i < first + count; ++i) {
                const FlatSlot slot = flat.slots[i];
                const MeshInstance<Real>& mesh = meshes[slot.mesh];
                if (slot.mesh != seen_by) {
                    seen_by = slot.mesh;
                    const std::uint32_t object = first_of<ShapeKind::mesh>(scene) + slot.mesh;
                    in_mesh =
                        MeshRay<Real>::of(mesh, object, at_rest<Config>(scene, object, ray.origin, ray.time), ray);
                }
                const Triangle<float>& t = mesh.geometry.triangles[slot.primitive];
                const Triangle<Real> triangle{Vec3<Real>(t.a), Vec3<Real>(t.b), Vec3<Real>(t.c)};
                keep_nearer(best, intersect(triangle, in_mesh.origin, in_mesh.sheared), slot.primitive, in_mesh);
                if (end.end_if_met(best)) {
                    return;
                }
            }
        },
        counter);
}

// Searches all mesh instances in the way that the kernel is compiled for: by a tree over the instances, by a tree over
// their triangles, or one instance after the other.
template <class Config, class Scene, class Meshes, class End>
PT_HD inline void closest_of_meshes(Hit<typename Config::Real>& best, const Scene& scene, const Meshes& meshes,
                                    const Ray<typename Config::Real>& ray, const End& end) {
    if constexpr (has<Config>(Feature::object_tree)) {
        closest_by_object_tree<Config>(best, scene, meshes, ray, end);
    } else if constexpr (has<Config>(Feature::flat_tree)) {
        closest_by_flat_tree<Config>(best, scene, meshes, ray, end);
    } else {
        if constexpr (Config::Accelerator::is_chosen_at_run_time) {
            if (scene.mesh_search->meet_meshes != nullptr) {
                scene.mesh_search->meet_meshes(best, scene, ray, end.template distance<typename Config::Real>());
                return;
            }
        }
        for (std::uint32_t i = 0; i < meshes.size; ++i) {
            closest_mesh<Config>(best, scene, meshes[i], first_of<ShapeKind::mesh>(scene) + i, ray, end);
            if (end.end_if_met(best)) {
                return;
            }
        }
    }
}

// Updates the closest hit `best` by all objects of one kind of shape. Special kinds are meshes, which have many
// primitives; axis boxes, which share the reciprocal of the ray's direction and make enclosures; and spheres in kernels
// that may have them near the eye.
template <class Config, ShapeKind kind, class Scene, class Shapes>
PT_HD inline void closest_of(Hit<typename Config::Real>& best, const Scene& scene, const Shapes& shapes,
                             const Ray<typename Config::Real>& ray) {
    if constexpr (kind == ShapeKind::axis_box) {
        closest_axis_box<Config>(best, scene, ray);
    } else if constexpr (kind == ShapeKind::mesh) {
        closest_of_meshes<Config>(best, scene, shapes, ray, WithClosest{});
    } else if constexpr (kind == ShapeKind::sphere) {
        closest_in<Config>(best, scene, spheres_of<Config>(scene), first_of<kind>(scene), ray);
    } else if constexpr (ShapeOf<kind, typename Config::Real>::is_flat) {
        closest_flat<Config>(best, scene, shapes, first_of<kind>(scene), ray);
    } else {
        closest_in<Config>(best, scene, shapes, first_of<kind>(scene), ray);
    }
}

// Intersects a ray with one object of any shape, for objects visited in any order, as in the leaf of an acceleration
// structure over objects. After all objects `best` is the hit of closest_hit, bit for bit.
template <VisitOrder order, class Real, class Shape>
PT_HD inline void meet_shape(Hit<Real>& best, const Shape& shape, std::uint32_t object, const Vec3<Real>& origin,
                             const Ray<Real>& ray) {
    const bool starts_here = ray.origin_surface.is_of(object);
    if constexpr (Shape::is_flat) {
        if (!starts_here) {
            keep_nearer_flat<order>(best, interval(shape, origin, ray.direction), object,
                                    dot(ray.direction, shape.normal) > Real(0));
        }
    } else if (!starts_here) {
        keep_nearer<order>(best, interval(shape, origin, ray.direction), object);
    } else if (ray.origin_surface.inside()) {
        keep_nearer<order>(best, chord(shape, origin, ray.direction), ray.origin_surface);
    }
}
template <VisitOrder order, class Real>
PT_HD inline void meet_shape(Hit<Real>& best, const MeshInstance<Real>& mesh, std::uint32_t object,
                             const Vec3<Real>& origin, const Ray<Real>& ray) {
    NoTraversalCounter counter;
    closest_in_mesh<BruteForce>(best, mesh, object, origin, ray, counter, WithClosest{});
}
template <class Config, VisitOrder order, class Scene>
PT_HD inline void meet_object(Hit<typename Config::Real>& best, const Scene& scene, std::uint32_t object,
                              const Ray<typename Config::Real>& ray) {
    const auto origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    visit_shape<Config>(
        scene, object, [&](const auto& shape) { meet_shape<order>(best, as_met<Config>(shape), object, origin, ray); });
}

// Intersects every object in turn through its 4x4 matrix, except shapes that are no image of a unit shape.
template <class Config, class Scene>
PT_HD inline void closest_transformed(Hit<typename Config::Real>& best, const Scene& scene,
                                      const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    for (std::uint32_t object = 0; object < scene.transforms.size; ++object) {
        const Transform<Real>& transform = scene.transforms[object];
        if constexpr ((Config::features & shapes_without_matrix) != 0) {
            if (transform.shape == UnitShape::none) {
                meet_object<Config, VisitOrder::ascending>(best, scene, object, ray);
                continue;
            }
        }
        const Vec3<Real> origin = at_rest<Config>(scene, object, ray.origin, ray.time);
        const bool starts_here = ray.origin_surface.is_of(object);
        if (starts_here && (transform.shape == UnitShape::quad || !ray.origin_surface.inside())) {
            continue;
        }
        if (starts_here) {
            keep_nearer(best, chord(transform, origin, ray.direction), ray.origin_surface);
            continue;
        }
        const Interval<Real> crossing = interval(transform, origin, ray.direction);
        if (transform.shape != UnitShape::quad) {
            keep_nearer(best, crossing, object);
        } else {
            keep_nearer_flat(best, crossing, object, dot(ray.direction, transform.row[1]) > Real(0));
        }
    }
}

template <class Real>
PT_HD inline Ray<double> widened(const Ray<Real>& ray) {
    return {Vec3<double>(ray.origin), Vec3<double>(ray.direction), ray.time, ray.origin_surface, ray.primitive};
}

// Closest hit among some bodies in the textbook's way: every intersection at a distance above the epsilon counts.
template <class Config, class Scene, class Bodies>
PT_HD inline void closest_naive(Hit<typename Config::Real>& best, const Scene& scene, const Bodies& bodies,
                                std::uint32_t first, const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    for (std::uint32_t i = 0; i < bodies.size; ++i) {
        const std::uint32_t object = first + i;
        const Interval<Real> crossing =
            naive::interval(bodies[i], at_rest<Config>(scene, object, ray.origin, ray.time), ray.direction);
        const bool inside = !(crossing.near > naive::epsilon<Real>);
        const Real t = inside ? crossing.far : crossing.near;
        if (crossing.hits && t > naive::epsilon<Real> && comes_before<VisitOrder::ascending>(t, object, best)) {
            best.t = t;
            best.side = SurfaceId::of(object, inside);
        }
    }
}

template <class Config, ShapeKind kind, class Scene, class Shapes>
PT_HD inline void closest_naive_of(Hit<typename Config::Real>& best, const Scene& scene, const Shapes& shapes,
                                   const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    if constexpr (kind == ShapeKind::mesh) {
        closest_of<Config, kind>(best, scene, shapes, ray);
    } else {
        const Real before = best.t;
        closest_naive<Config>(best, scene, shapes, first_of<kind>(scene), ray);
        if constexpr (ShapeOf<kind, Real>::is_flat) {
            if (best.t < before) {
                const std::uint32_t object = best.side.object();
                best.side =
                    SurfaceId::of(object, dot(ray.direction, shapes[object - first_of<kind>(scene)].normal) > Real(0));
            }
        }
    }
}

template <class Config, class Scene>
PT_HD inline Hit<typename Config::Real> closest_hit(const Scene& scene, const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::double_intersection)) {
        const Hit<double> hit = closest_hit<InDouble<Config>>(WideScene(scene), widened(ray));
        return {static_cast<Real>(hit.t), hit.side, hit.primitive};
    }
    Hit<Real> best;
    best.t = std::numeric_limits<Real>::infinity();
// The list of shapes expands to statements, since a visitor of kinds changes the register count of some kernels.
#define PT_CLOSEST(name, array, Type)                                                 \
    if constexpr (has<Config>(Feature::name)) {                                       \
        if constexpr (has<Config>(Feature::naive)) {                                  \
            closest_naive_of<Config, ShapeKind::name>(best, scene, scene.array, ray); \
        } else {                                                                      \
            closest_of<Config, ShapeKind::name>(best, scene, scene.array, ray);       \
        }                                                                             \
    }
    if constexpr (has<Config>(Feature::matrix)) {
        closest_transformed<Config>(best, scene, ray);
    } else {
        PT_SHAPES(PT_CLOSEST)
    }
#undef PT_CLOSEST
    return best;
}

// closest_hit for rays that connect a vertex to a light. Many lobes call it, so large kernels keep a single copy of its
// code.
template <class Config>
PT_HD inline Hit<typename Config::Real> closest_hit_of_connection(const SceneView<typename Config::Real>& scene,
                                                                  const Ray<typename Config::Real>& ray) {
    return in_one_place<Config>([&] { return closest_hit<Config>(scene, ray); });
}

// Surface point of a hit in a naive kernel, which leaves the position where rounding along the ray puts it.
template <class Config, class Scene>
PT_HD inline SurfacePoint<typename Config::Real> naive_surface_at(const Scene& scene,
                                                                  const Ray<typename Config::Real>& ray,
                                                                  const Hit<typename Config::Real>& hit) {
    using Real = typename Config::Real;
    const std::uint32_t object = hit.side.object();
    const Vec3<Real> p = at_rest<Config>(scene, object, ray.origin, ray.time) + ray.direction * hit.t;
    const Vec3<Real> position = in_motion<Config>(scene, object, p, ray.time);
    SurfacePoint<Real> point{position, {Real(0), Real(1), Real(0)}};
    visit_shape<EveryShape<Real>>(scene, object, [&](const auto& shape) {
        point.normal = naive::normal_at(primitive_of(shape, hit.primitive), p);
    });
    return point;
}

// Position of a hit, pulled back onto the surface, and the object's outward unit normal. Without `normal_of_face` the
// normal is not set where the hit names a box face, from which the normal follows.
template <class Config, bool normal_of_face = true, class Scene>
PT_HD inline SurfacePoint<typename Config::Real> surface_at(const Scene& scene, const Ray<typename Config::Real>& ray,
                                                            const Hit<typename Config::Real>& hit) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::double_intersection)) {
        // Points of flat shapes are kept off the edges by the rounding of Real, so they are not computed in double.
        if (!is_flat(scene, hit.side.object())) {
            const SurfacePoint<double> point = surface_at<InDouble<Config>>(
                WideScene(scene), widened(ray), Hit<double>{hit.t, hit.side, hit.primitive});
            return {Vec3<Real>(point.position), Vec3<Real>(point.normal)};
        }
    } else if constexpr (has<Config>(Feature::naive)) {
        return naive_surface_at<Config>(scene, ray, hit);
    }
    SurfacePoint<Real> point{{Real(0), Real(0), Real(0)}, {Real(0), Real(1), Real(0)}};
    if constexpr (has<Config>(Feature::enclosure)) {
        if (hit.side.has_face() &&
            point_on_side(scene.enclosure, hit.side, ray.origin + ray.direction * hit.t, point.position)) {
            if constexpr (normal_of_face) {
                point.normal = face_normal<Real>(hit.side);
            }
            return point;
        }
    }
    const std::uint32_t object = hit.side.object();
    const Vec3<Real> origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    bool by_matrix = has<Config>(Feature::matrix);
    if constexpr (has<Config>(Feature::matrix)) {
        if constexpr ((Config::features & shapes_without_matrix) != 0) {
            by_matrix = scene.transforms[object].shape != UnitShape::none;
        }
        if (by_matrix) {
            point = surface_point(scene.transforms[object], origin, ray.direction, hit.t, hit.side.inside());
        }
    }
    if (!by_matrix) {
        visit_shape<Config>(scene, object, [&](const auto& shape) {
            point =
                surface_point(as_met<Config>(shape, hit.primitive), origin, ray.direction, hit.t, hit.side.inside());
        });
    }
    point.position = in_motion<Config>(scene, object, point.position, ray.time);
    return point;
}

}  // namespace pt
