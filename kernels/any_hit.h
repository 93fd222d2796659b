// Shadow rays: whether anything lies before a hit that is known. Where closest_hit looks for the least (t, object) of
// all, this ends at the first object whose own is less than the limit's. The answer is the closest hit's, bit for bit.
// Next-event estimation asks closest_hit all the same: over lists of a few objects the light's own hit, found first,
// costs more than ending early saves (in the shipped scenes 10 to 25 % of a CPU's time, and up to a quarter more
// instructions in kernels of CUDA's). It is for scenes whose objects are not all visited.
#pragma once

#include "kernels/intersect.h"

namespace pt {

// Kernels that meet objects by the robust forms of the shapes; others answer by the closest hit.
template <class Config>
inline constexpr bool meets_shapes =
    !has<Config>(Feature::naive) && !has<Config>(Feature::matrix) && !has<Config>(Feature::double_intersection);

// The ray's hit with one object, as if there were no other; nowhere: it passes by.
template <class Config, class Scene>
PT_HD inline Hit<typename Config::Real> hit_with(const Scene& scene, std::uint32_t object,
                                                 const Ray<typename Config::Real>& ray) {
    Hit<typename Config::Real> hit;
    hit.t = std::numeric_limits<typename Config::Real>::infinity();
    meet_object<Config, VisitOrder::any>(hit, scene, object, ray);
    return hit;
}

template <class Config, ShapeKind kind, class Scene, class Shapes>
PT_HD inline bool any_of(const Hit<typename Config::Real>& limit, const Scene& scene, const Shapes& shapes,
                         const Ray<typename Config::Real>& ray) {
    for (std::uint32_t i = 0; i < shapes.size; ++i) {
        const std::uint32_t object = first_of<kind>(scene) + i;
        const auto origin = at_rest<Config>(scene, object, ray.origin, ray.time);
        Hit<typename Config::Real> found = limit;
        meet_shape<VisitOrder::any>(found, as_met<Config>(shapes[i]), object, origin, ray);
        if (found.t != limit.t || found.side.code != limit.side.code || found.primitive != limit.primitive) {
            return true;
        }
    }
    return false;
}

// Whether the ray meets an object whose (t, number) is less than the limit's; of a limit that is nowhere, any object
// nearer than its t.
template <class Config, class Scene>
PT_HD inline bool any_hit(const Scene& scene, const Ray<typename Config::Real>& ray,
                          const Hit<typename Config::Real>& limit) {
    static_assert(meets_shapes<Config>);
#define PT_ANY(name, array, Type)                                              \
    if constexpr (has<Config>(Feature::name)) {                                \
        if (any_of<Config, ShapeKind::name>(limit, scene, scene.array, ray)) { \
            return true;                                                       \
        }                                                                      \
    }
    PT_SHAPES(PT_ANY)
#undef PT_ANY
    return false;
}

// The ray's hit with an object that is seen along it: the closest hit, if it is the object's; else nowhere.
template <class Config, class Scene>
PT_HD inline Hit<typename Config::Real> unoccluded_hit(const Scene& scene, std::uint32_t object,
                                                       const Ray<typename Config::Real>& ray) {
    if constexpr (meets_shapes<Config>) {
        Hit<typename Config::Real> hit = hit_with<Config>(scene, object, ray);
        if (hit.side.exists() && any_hit<Config>(scene, ray, hit)) {
            hit.side = {};
        }
        return hit;
    } else {
        Hit<typename Config::Real> hit = closest_hit<Config>(scene, ray);
        if (hit.side.exists() && hit.side.object() != object) {
            hit.side = {};
        }
        return hit;
    }
}

}  // namespace pt
