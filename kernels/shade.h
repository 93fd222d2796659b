// The stages of a path: generate, intersect, shade, accumulate. Every integrator on every backend runs these functions
// and no others; what differs between integrators is only when and for which path they are called.
//
// Depth counts ray segments, the camera ray included. Emission met by segments 1..depth counts; a path that is
// exhausted contributes nothing more.
#pragma once

#include "kernels/adjoint.h"
#include "kernels/film.h"
#include "kernels/light.h"
#include "kernels/materials.h"
#include "kernels/next_event.h"
#include "kernels/russian_roulette.h"
#include "kernels/shading_normal.h"

namespace pt {

// Counters of one thread that runs stages of paths; whoever runs the thread adds them up.
template <class Count>
struct PathCountersOf {
    Count paths = 0;
    Count rays = 0;              // rays traced: path segments (closest hits) and connections to lights
    Count connections = 0;       // connections: rays that connect a vertex to a light
    Count unfinished_walks = 0;  // paths lost in a subsurface body: their walk reached its cap, or began inside
};
using PathCounters = PathCountersOf<std::uint64_t>;

template <class Config>
PT_HD inline Path<typename Config::Real> generate(const SceneView<typename Config::Real>& scene,
                                                  const PixelPlace& place, std::uint32_t sample,
                                                  std::uint32_t camera_sample) {
    return camera_path<Config>(scene.camera, scene.seed, place, sample, camera_sample);
}

template <class Config>
PT_HD inline Path<typename Config::Real> generate(const SceneView<typename Config::Real>& scene, std::uint32_t pixel,
                                                  std::uint32_t sample, std::uint32_t camera_sample) {
    return generate<Config>(scene, PixelPlace::of(pixel, scene.camera.width), sample, camera_sample);
}

template <class Config>
PT_HD inline Path<typename Config::Real> generate(const SceneView<typename Config::Real>& scene, std::uint32_t pixel,
                                                  std::uint32_t sample) {
    return generate<Config>(scene, pixel, sample, sample);
}

template <class Config>
PT_HD inline Hit<typename Config::Real> intersect(const SceneView<typename Config::Real>& scene,
                                                  const Path<typename Config::Real>& path) {
    return closest_hit<Config>(scene, ray_of(path));
}

template <class Real>
PT_HD inline void accumulate(const FilmView& film, const Path<Real>& path) {
    film.add(path.pixel, path.radiance);
}

// Has the vertex's material pick the path's next direction. Returns whether the path goes on. The list of material
// types is expanded as statements: other forms give kernels other registers.
template <class Config, class At>
PT_HD inline bool scatter(const At& at) {
    using Real = typename Config::Real;
    using namespace material_trait;
#define PT_SCATTER_BY_SURFACE(name, Type, traits)                             \
    if constexpr (has<Config>(Feature::name) && ((traits)&by_surface) != 0) { \
        if (at.surface.type == MaterialType::name) {                          \
            return Type<Real>::scatter(at);                                   \
        }                                                                     \
    }
    PT_MATERIALS(PT_SCATTER_BY_SURFACE)
#undef PT_SCATTER_BY_SURFACE
    const Material<Real>& material = at.scene.materials[at.vertex.material];
#define PT_SCATTER(name, Type, traits)                                                         \
    if constexpr (has<Config>(Feature::name) && ((traits) & (by_surface | ends_paths)) == 0) { \
        if (material.type == MaterialType::name) {                                             \
            return material.name.scatter(at, material);                                        \
        }                                                                                      \
    }
    PT_MATERIALS(PT_SCATTER)
#undef PT_SCATTER
    return false;
}

// Takes the path one step further on its subsurface walk. Returns false if the path is lost.
template <class Config>
PT_HD inline bool walk_on(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                          WalkOf<Config>& walk, auto& counters) {
    const WalkStep step =
        walk_step<Config>(scene, path, walk, scene.materials[scene.object_material[walk.object]].subsurface);
    if (step != WalkStep::goes_on) {
        walk.step = Walk::none;
    }
    counters.unfinished_walks += step == WalkStep::lost ? 1u : 0u;
    return step != WalkStep::lost;
}

// Adds the light of an emitter that the path meets, weighted against next-event estimation where both find it.
template <class Config>
PT_HD inline void meet_light(const SceneView<typename Config::Real>& scene,
                             const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                             const Hit<typename Config::Real>& hit, const Vec3<typename Config::Real>& emission) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::next_event)) {
        const Real weight = encounter_weight<Config>(scene, traced, path, hit);
        path.radiance += path.throughput * emission * weight;
    } else {
        path.radiance += path.throughput * emission;
    }
}

// Shades the end of a path segment. On return the path has its next ray, or is at the beginning of a walk that the
// caller takes to its end by walk_on, or is over (returns false). `traced`: the same scene as rays traverse it.
// `branch`: roulette or splitting before the path scatters; a resuming branch has had the vertex's light already.
template <class Config, class Branch = OneBranch>
PT_HD inline bool shade(const SceneView<typename Config::Real>& scene, const SceneView<typename Config::Real>& traced,
                        Path<typename Config::Real>& path, const Hit<typename Config::Real>& hit, auto& counters,
                        WalkOf<Config>& walk, Branch branch = {}) {
    using Real = typename Config::Real;
    const bool arrives = !branch.resumes();
    if (arrives) {
        path.segment += 1;
    }
    if (!hit.side.exists()) {
        if constexpr (has<Config>(Feature::environment)) {
            path.radiance += path.throughput * scene.environment;
        }
        if constexpr (has<Config>(Feature::environment_map)) {
            meet_environment<Config>(scene, path);
        }
        return false;
    }
    if constexpr (has<Config>(Feature::absorption)) {
        if (arrives && path.medium != Path<Real>::no_medium) {
            attenuate(path, scene.materials[path.medium], hit.t);
        }
    }
    Surface<Real> surface = scene.surfaces[hit.side.object()];
    if (has<Config>(Feature::emitter) && surface.type == MaterialType::emitter) {
        meet_light<Config>(scene, traced, path, hit, surface.colour);
        return false;
    }
    const std::uint32_t material_index = scene.object_material[hit.side.object()];
    if constexpr (has<Config>(Feature::emission)) {
        const Material<Real>& material = scene.materials[material_index];
        if (arrives && material.emits != 0) {
            meet_light<Config>(scene, traced, path, hit, material.emission);
        }
    }
    const std::uint32_t segments = segments_of<Config>(path);
    const bool last = segments >= scene.depth;
    if (last && (!has<Config>(Feature::final_bounce) || segments >= scene.longest_path())) {
        return false;
    }
    const SurfacePoint<Real> point = surface_at<Config, false>(scene, ray_of(path), hit);
    const bool inside = hit.side.inside();
    VertexOf<Config> vertex{
        point.position, inside ? -point.normal : point.normal, hit.side.object(), inside, material_index, hit.side,
        hit.primitive};
    if constexpr (has<Config>(Feature::textures)) {
        put_texture<Config>(surface.colour, scene, ray_of(path), hit, vertex.position, vertex.normal());
    }
    if constexpr (has<Config>(Feature::shading_normals)) {
        if (!bend_normal<Config>(vertex, scene, ray_of(path), hit)) {
            return false;
        }
    }
    path.bsdf_pdf = Real(0);
    const RandomWords words =
        random_words<Config>(scene.seed, {path.pixel, path.sample, path.segment, random_block::scatter});
    // Branch policies that do nothing are not called, since even such a call gives some kernels other registers.
    if constexpr (Branch::template acts_in<Config>) {
        if (!branch.template goes_on<Config>(scene, path, vertex, hit, unit_interval<Real>(words.w))) {
            return false;
        }
    }
    const Scattering<Config, std::remove_reference_t<decltype(counters)>, WalkOf<Config>> at{
        scene, traced, path, vertex, surface, words, last, counters, walk};
    if (!scatter<Config>(at)) {
        return false;
    }
    if (!is_on_one_side<Config>(vertex, path.direction, path.origin_surface.inside() != vertex.inside)) {
        return false;
    }
    if constexpr (has<Config>(Feature::russian_roulette)) {
        if (scene.roulette_start != 0 && segments >= scene.roulette_start) {
            if (!survives_roulette(path, unit_interval<Real>(words.w))) {
                walk.step = Walk::none;
                return false;
            }
        }
    }
    return true;
}

// Shades the hit, and takes a subsurface walk that begins there to its end. Returns whether the path goes on.
template <class Config>
PT_HD inline bool shade(const SceneView<typename Config::Real>& scene, const SceneView<typename Config::Real>& traced,
                        Path<typename Config::Real>& path, const Hit<typename Config::Real>& hit, auto& counters) {
    WalkOf<Config> walk;
    bool alive = shade<Config>(scene, traced, path, hit, counters, walk);
    if constexpr (has<Config>(Feature::subsurface)) {
        while (alive && walk.is_on()) {
            alive = walk_on<Config>(scene, path, walk, counters);
        }
    }
    return alive;
}

}  // namespace pt
