// Occlusion test of next-event estimation: whether a known point on a light is visible from a vertex. The shadow ray
// ends at the first object found before the point, whichever is nearest and whichever side is hit; it skips the light
// itself, and an enclosure's walls where the point lies clearly inside. Hits within rounding of the point's distance (a
// light that touches another object) are left to closest_hit (sees_point), so that connections see what paths hit. In a
// mesh the first leaf with a triangle before the point ends the traversal.
#pragma once

#include "kernels/intersect.h"

namespace pt {

// Result of the occlusion test between a vertex and a point on a light; unsure: rounding decides, and the closest hit
// must be asked.
enum class Sight { clear, blocked, unsure };

// Relative error allowed for the distance to a light sample. The distance to a plane is a difference of coordinates
// over a component of the direction: a rounding of the coordinates counts times coordinates / height above the plane.
// 16 roundings are allowed for at a height of 1/256 of the coordinates, one at 1/4096. Nearer to the plane a light that
// touches another object may be seen where paths do not hit it; it sends little at such angles.
template <class Real>
PT_HD constexpr Real point_rounding() {
    return gamma<Real>(16 * 256);
}

// A shadow ray up to a point on an object. Hits at distances from `before` to `about` may be the point itself.
template <class Real>
struct Segment {
    const Ray<Real>& ray;
    std::uint32_t object;
    Real before, about;
    bool unsure = false;

    PT_HD Segment(const Ray<Real>& towards, std::uint32_t of_object, Real distance)
        : ray(towards),
          object(of_object),
          before(distance * (Real(1) - point_rounding<Real>())),
          about(distance * (Real(1) + point_rounding<Real>())) {}

    // Records that a shadow ray meets an object at distance t, and returns whether this occludes the segment's end.
    PT_HD bool is_hidden_by(Real t) {
        unsure = unsure || t < about;
        return t < before;
    }
    // Records that a shadow ray crosses a convex body or flat surface over [near, far], and returns whether that
    // occludes the segment's end.
    PT_HD bool is_hidden_by(const Interval<Real>& crossing, bool flat) {
        const Real t = crossing.near > Real(0) || flat ? crossing.near : crossing.far;
        return crossing.hits && t > Real(0) && is_hidden_by(t);
    }
};

// Whether a kernel has occlusion tests, which need the robust intersection forms of the shapes. Other kernels ask for
// the closest hit.
template <class Config>
inline constexpr bool has_lines_of_sight =
    !has<Config>(Feature::naive) && !has<Config>(Feature::matrix) && !has<Config>(Feature::double_intersection);

template <class Config, class Scene, class Shape>
PT_HD inline bool is_hidden_by(Segment<typename Config::Real>& segment, const Scene& scene, const Shape& shape,
                               std::uint32_t object) {
    const auto& ray = segment.ray;
    const auto origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    if (!ray.origin_surface.is_of(object)) {
        auto crossing = interval(shape, origin, ray.direction);
        crossing.hits = misses_at_zero<Shape> || crossing.hits;
        return segment.is_hidden_by(crossing, Shape::is_flat);
    }
    if constexpr (Shape::is_flat) {
        return false;
    } else {
        return ray.origin_surface.inside() && segment.is_hidden_by(chord(shape, origin, ray.direction));
    }
}
template <class Config, class Scene>
PT_HD inline bool is_hidden_by_axis_box(Segment<typename Config::Real>& segment, const Scene& scene, std::uint32_t i,
                                        const Vec3<typename Config::Real>& inverse) {
    using Real = typename Config::Real;
    const std::uint32_t object = first_of<ShapeKind::axis_box>(scene) + i;
    const Ray<Real>& ray = segment.ray;
    const AxisBox<Real> box = scene.axis_boxes[i];
    const Interval<Real> crossing =
        slab_interval(box.low, box.high, at_rest<Config>(scene, object, ray.origin, ray.time), inverse);
    if (!ray.origin_surface.is_of(object)) {
        return segment.is_hidden_by(crossing, false);
    }
    return ray.origin_surface.inside() && segment.is_hidden_by(max(crossing.far, Real(0)));
}

// Whether the shadow segment, which no wall of the enclosure hides, is hidden by another axis box.
template <class Config, class Scene>
PT_HD inline bool is_hidden_by_boxes_within(Segment<typename Config::Real>& segment, const Scene& scene) {
    const std::uint32_t first = first_of<ShapeKind::axis_box>(scene);
    const auto is_tested = [&](std::uint32_t i) { return !scene.enclosure.is_wall(i) && first + i != segment.object; };
    if (scene.axis_boxes.size <= bits_in(scene.enclosure.walls) + 1) {
        // The only other axis box is mostly the light, so the reciprocal ray direction is formed only where it is not.
        for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
            if (is_tested(i) && is_hidden_by_axis_box<Config>(segment, scene, i, reciprocal(segment.ray.direction))) {
                return true;
            }
        }
        return false;
    }
    const auto inverse = reciprocal(segment.ray.direction);
    PT_ROLLED
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (is_tested(i) && is_hidden_by_axis_box<Config>(segment, scene, i, inverse)) {
            return true;
        }
    }
    return false;
}

template <class Config, class Scene>
PT_HD inline bool is_hidden_by_axis_boxes(Segment<typename Config::Real>& segment, const Scene& scene,
                                          bool without_walls) {
    if constexpr (has<Config>(Feature::enclosure)) {
        if (without_walls) {
            return is_hidden_by_boxes_within<Config>(segment, scene);
        }
    }
    const std::uint32_t first = first_of<ShapeKind::axis_box>(scene);
    const auto inverse = reciprocal(segment.ray.direction);
    // The loop over axis boxes is not unrolled: in an enclosure few rays get to it, and rolled it has a sixth of the
    // instructions.
    PT_ROLLED
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (first + i != segment.object && is_hidden_by_axis_box<Config>(segment, scene, i, inverse)) {
            return true;
        }
    }
    return false;
}

// Whether some object of one kind hides the point at the shadow segment's end.
template <class Config, ShapeKind kind, class Scene, class Shapes>
PT_HD inline bool is_hidden_by_kind(Segment<typename Config::Real>& segment, const Scene& scene, const Shapes& shapes,
                                    bool without_walls) {
    using Real = typename Config::Real;
    if constexpr (kind == ShapeKind::axis_box) {
        return is_hidden_by_axis_boxes<Config>(segment, scene, without_walls);
    } else if constexpr (kind == ShapeKind::mesh) {
        Hit<Real> found;
        found.t = segment.about;
        closest_of_meshes<Config>(found, scene, shapes, segment.ray, NearerThan<Real>{segment.before});
        return found.side.exists() && segment.is_hidden_by(found.t);
    } else {
        PT_ROLLED
        for (std::uint32_t i = 0; i < shapes.size; ++i) {
            const std::uint32_t object = first_of<kind>(scene) + i;
            if (object != segment.object && is_hidden_by<Config>(segment, scene, as_met<Config>(shapes[i]), object)) {
                return true;
            }
        }
        return false;
    }
}

// Occlusion test between the ray origin and a point on an object (no mesh) at `distance`, which is above 0. The ray
// leaves the surface that it starts on.
template <class Config, class Scene>
PT_HD inline Sight line_of_sight(const Scene& scene, std::uint32_t object, const Ray<typename Config::Real>& ray,
                                 typename Config::Real distance) {
    static_assert(has_lines_of_sight<Config>);
    bool without_walls = false;
    if constexpr (has<Config>(Feature::enclosure)) {
        bool in_wall = ray.origin_surface.exists() && ray.origin_surface.inside();
        if constexpr (has_insides<Config>()) {
            in_wall =
                in_wall && scene.enclosure.is_wall(ray.origin_surface.object() - first_of<ShapeKind::axis_box>(scene));
        }
        const WallsBetween walls =
            in_wall ? WallsBetween::unknown
                    : walls_between(scene.enclosure, ray.origin, ray.origin + ray.direction * distance);
        if (walls == WallsBetween::one) {
            return Sight::blocked;
        }
        without_walls = walls == WallsBetween::none;
    }
    Segment<typename Config::Real> segment(ray, object, distance);
#define PT_HIDES(name, array, Type)                                                                   \
    if constexpr (has<Config>(Feature::name)) {                                                       \
        if (is_hidden_by_kind<Config, ShapeKind::name>(segment, scene, scene.array, without_walls)) { \
            return Sight::blocked;                                                                    \
        }                                                                                             \
    }
    PT_SHAPES(PT_HIDES)
#undef PT_HIDES
    return segment.unsure ? Sight::unsure : Sight::clear;
}

// Whether a shadow ray drawn to a point on an object (no mesh) misses the object by rounding: no intersection up to
// just beyond the point.
template <class Config, class Scene>
PT_HD inline bool passes_by(const Scene& scene, std::uint32_t object, const Ray<typename Config::Real>& ray,
                            typename Config::Real about) {
    using Real = typename Config::Real;
    const Vec3<Real> origin = at_rest<Config>(scene, object, ray.origin, ray.time);
    bool passes = false;
    visit_shape<Config>(scene, object, [&]<class Shape>(const Shape& shape) {
        if constexpr (requires { interval(as_met<Config>(shape), origin, ray.direction); }) {
            const auto crossing = interval(as_met<Config>(shape), origin, ray.direction);
            passes = !(crossing.hits && crossing.near < about);
        }
    });
    return passes;
}

// Whether a shadow ray reaches the light sample that it was drawn to, by its closest hit: the light itself is hit, or
// the closest hit lies beyond the sample and the ray misses the light. A ray that misses runs to the light's very edge,
// and line_of_sight, which does not test the light, calls it clear. All kernels have this rule for the edge, with or
// without an enclosure, with occlusion tests or closest hits.
template <class Config, class Scene>
PT_HD inline bool sees_point(const Scene& scene, std::uint32_t object, const Ray<typename Config::Real>& ray,
                             typename Config::Real distance, const Hit<typename Config::Real>& closest) {
    using Real = typename Config::Real;
    if (closest.side.exists() && closest.side.object() == object) {
        return true;
    }
    const bool is_beyond = !closest.side.exists() || closest.t > distance;
    return is_beyond && passes_by<Config>(scene, object, ray, Segment<Real>(ray, object, distance).about);
}

}  // namespace pt
