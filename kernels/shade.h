// The stages of a path: generate, intersect, shade, accumulate. Every integrator on every backend runs these functions
// and no others; what differs between integrators is only when and for which path they are called.
//
// Depth counts ray segments, the camera ray included. Emission met by segments 1..depth counts; a path that is
// exhausted contributes nothing more.
#pragma once

#include "kernels/adjoint.h"
#include "kernels/film.h"
#include "kernels/light.h"
#include "kernels/mix.h"
#include "kernels/next_event.h"
#include "kernels/principled.h"
#include "kernels/rough_conductor.h"
#include "kernels/rough_dielectric.h"
#include "kernels/russian_roulette.h"
#include "kernels/shading_normal.h"
#include "kernels/subsurface.h"

namespace pt {

// Counters of one thread while it runs stages, which are summed by whoever runs it.
template <class Count>
struct PathCountersOf {
    Count paths = 0;
    Count rays = 0;              // queries: path segments (closest hit) and connections to lights
    Count connections = 0;       // of the rays, those to lights
    Count unfinished_walks = 0;  // paths lost in a subsurface body: the walk met its cap, or began inside
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

// The diffuse lobe of the vertex: connected to a light where the variant asks for it, and then sampled. The last vertex
// of a final-bounce path is connected only. Returns whether the path goes on. `traced`: the scene as rays walk through
// it.
template <class Config>
PT_HD inline bool shade_diffuse(const SceneView<typename Config::Real>& scene,
                                const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                                const VertexOf<Config>& vertex, const Vec3<typename Config::Real>& albedo,
                                const RandomWords& words, bool last, auto& counters) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::final_bounce)) {
        if (last) {
            const std::uint32_t connections = connect<Config>(scene, traced, path, vertex, albedo, words);
            counters.rays += connections;
            counters.connections += connections;
            return false;
        }
    }
    bool is_connected = false;
    if constexpr (has<Config>(Feature::next_event)) {
        is_connected = scene.next_event != 0;
        if (is_connected) {
            const std::uint32_t connections =
                connect_next_event<Config>(scene, traced, path, vertex, DiffuseLobe<Real>{albedo});
            counters.rays += connections;
            counters.connections += connections;
        }
    }
    scatter_diffuse<Config>(path, vertex, albedo, words.y, words.z);
    if (is_connected) {
        if constexpr (has<Config>(Feature::multiple_importance)) {
            constexpr Real least = Real(0x1p-60);
            path.bsdf_pdf =
                kept_pdf<Config>(path, max(vertex.dot_normal(path.direction), least) * (Real(1) / pi<Real>));
        } else {
            // Any number but 0, which says that there was no connection, will do unless light that is met is weighed.
            path.bsdf_pdf = Real(1);
        }
    }
    return true;
}

// Connects the vertex to a light where the variant asks for it and the lobe is wide enough; returns whether it is.
template <class Config, class Lobe>
PT_HD inline bool connect_rough(const SceneView<typename Config::Real>& scene,
                                const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                                const VertexOf<Config>& vertex, const Lobe& lobe, auto& counters) {
    bool is_connected = false;
    if constexpr (has<Config>(Feature::next_event)) {
        is_connected = scene.next_event != 0 && lobe.is_connectable();
        if (is_connected) {
            const std::uint32_t connections = connect_next_event<Config>(scene, traced, path, vertex, lobe);
            counters.rays += connections;
            counters.connections += connections;
        }
    }
    return is_connected;
}

// The width of the facets' distribution at a vertex at the end of the path's ray: a roughness may be an image.
template <class Config>
PT_HD inline typename Config::Real facet_width(const SceneView<typename Config::Real>& scene,
                                               const Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                               const Material<typename Config::Real>& material) {
    using Real = typename Config::Real;
    Real alpha = material.alpha;
    if constexpr (has<Config>(Feature::textures)) {
        Hit<Real> hit;
        hit.side = vertex.hit;
        hit.primitive = vertex.primitive;
        put_roughness<Config>(alpha, scene, ray_of(path), hit, vertex.position, geometric_normal<Config>(vertex));
    }
    return alpha;
}

// A rough conductor. The last vertex of a final-bounce path goes on, as a mirror's does. Returns whether the path goes
// on: it does not where the facet sends it into the surface.
template <class Config>
PT_HD inline bool shade_rough_conductor(const SceneView<typename Config::Real>& scene,
                                        const SceneView<typename Config::Real>& traced,
                                        Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                        const Material<typename Config::Real>& material,
                                        const Vec3<typename Config::Real>& reflectance, const RandomWords& words,
                                        auto& counters) {
    using Real = typename Config::Real;
    constexpr bool has_gain = has<Config>(Feature::multiple_scattering);
    RoughConductor<Real, has_gain> lobe(reflectance, facet_width<Config>(scene, path, vertex, material),
                                        -path.direction, vertex.normal());
    if constexpr (has_gain) {
        if (material.scatters_multiply != 0) {
            lobe.scatter_multiply();
        }
    }
    const bool is_connected = connect_rough<Config>(scene, traced, path, vertex, lobe, counters);
    const LobeSample<Real> sample = lobe.sample(unit_interval<Real>(words.y), unit_interval<Real>(words.z));
    if (!(sample.cosine > Real(0))) {
        return false;
    }
    path.throughput *= sample.value.weight;
    leave_on_same_side(path, vertex, sample.direction);
    if (is_connected) {
        path.bsdf_pdf = kept_pdf<Config>(path, sample.value.pdf);
    }
    return true;
}

// Shades rough glass. The path ends where the facet sends it to the wrong side of the surface.
template <class Config>
PT_HD inline bool shade_rough_dielectric(const SceneView<typename Config::Real>& scene,
                                         const SceneView<typename Config::Real>& traced,
                                         Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                         const Material<typename Config::Real>& material, const RandomWords& words,
                                         auto& counters) {
    using Real = typename Config::Real;
    const RoughDielectric<Config> lobe(material, facet_width<Config>(scene, path, vertex, material), -path.direction,
                                       vertex);
    const bool is_connected = connect_rough<Config>(scene, traced, path, vertex, lobe, counters);
    const LobeSample<Real> sample =
        lobe.sample(unit_interval<Real>(words.x), unit_interval<Real>(words.y), unit_interval<Real>(words.z));
    if (sample.cosine == Real(0)) {
        return false;
    }
    path.throughput *= sample.value.weight;
    if (sample.cosine > Real(0)) {
        leave_on_same_side(path, vertex, sample.direction);
    } else {
        leave_on_other_side(path, vertex, sample.direction);
        if constexpr (has<Config>(Feature::absorption)) {
            path.medium = lobe.medium_beyond;
        }
    }
    if (is_connected) {
        // The density kept is never 0, which says that there was no connection.
        constexpr Real least = Real(0x1p-60);
        path.bsdf_pdf = kept_pdf<Config>(path, max(sample.value.pdf, least));
    }
    return true;
}

// Shades the principled material: metal, plastic and glass in one. The path ends where a facet sends it to the wrong
// side of the surface. What narrow facets send on meets lights as from a mirror, though the diffuse surface beneath
// them was connected.
template <class Config>
PT_HD inline bool shade_principled(const SceneView<typename Config::Real>& scene,
                                   const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                                   const VertexOf<Config>& vertex, const Material<typename Config::Real>& material,
                                   const Vec3<typename Config::Real>& colour, const RandomWords& words,
                                   auto& counters) {
    using Real = typename Config::Real;
    const Principled<Config> lobe(material, colour, facet_width<Config>(scene, path, vertex, material), -path.direction,
                                  vertex);
    const bool is_connected = connect_rough<Config>(scene, traced, path, vertex, lobe, counters);
    const LobeSample<Real> sample =
        lobe.sample(unit_interval<Real>(words.x), unit_interval<Real>(words.y), unit_interval<Real>(words.z));
    if (sample.cosine == Real(0)) {
        return false;
    }
    path.throughput *= sample.value.weight;
    if (sample.cosine > Real(0)) {
        leave_on_same_side(path, vertex, sample.direction);
    } else {
        leave_on_other_side(path, vertex, sample.direction);
        if constexpr (has<Config>(Feature::absorption)) {
            path.medium = lobe.medium_beyond;
        }
    }
    if (is_connected) {
        path.bsdf_pdf = sample.value.pdf > Real(0) ? kept_pdf<Config>(path, sample.value.pdf) : Real(0);
    }
    return true;
}

// The colour to shade with: the surface's where it may show an image, else the material's.
template <class Config>
PT_HD inline const Vec3<typename Config::Real>& colour_of(const Surface<typename Config::Real>& surface,
                                                          const Vec3<typename Config::Real>& of_material) {
    if constexpr (has<Config>(Feature::textures)) {
        return surface.colour;
    } else {
        return of_material;
    }
}

// Picks the lobe and the next direction by the material's type. Returns whether the path goes on.
template <class Config>
PT_HD inline bool scatter(const SceneView<typename Config::Real>& scene, const SceneView<typename Config::Real>& traced,
                          Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                          const Surface<typename Config::Real>& surface, const RandomWords& words, bool last,
                          auto& counters, WalkOf<Config>& walk) {
    using Real = typename Config::Real;
    const Real lobe = unit_interval<Real>(words.x);
    if (has<Config>(Feature::diffuse) && surface.type == MaterialType::diffuse) {
        return shade_diffuse<Config>(scene, traced, path, vertex, surface.colour, words, last, counters);
    }
    if (has<Config>(Feature::mirror) && surface.type == MaterialType::mirror) {
        scatter_mirror(path, vertex, surface.colour);
        return true;
    }
    const Material<Real>& material = scene.materials[vertex.material];
    if (has<Config>(Feature::mix) && material.type == MaterialType::mix) {
        if (chooses_mirror(lobe, material.mirror_probability)) {
            scatter_mirror(path, vertex, material.reflectance);
            return true;
        }
        // An image's colour is the surface's. (By a function that picks one, kernels without images take more
        // registers.)
        if constexpr (has<Config>(Feature::textures)) {
            return shade_diffuse<Config>(scene, traced, path, vertex, surface.colour, words, last, counters);
        } else {
            return shade_diffuse<Config>(scene, traced, path, vertex, material.albedo, words, last, counters);
        }
    }
    if (has<Config>(Feature::dielectric) && material.type == MaterialType::dielectric) {
        scatter_dielectric<Config>(path, vertex, material, lobe);
        return true;
    }
    if constexpr (has<Config>(Feature::rough_conductor)) {
        if (material.type == MaterialType::rough_conductor) {
            return shade_rough_conductor<Config>(scene, traced, path, vertex, material,
                                                 colour_of<Config>(surface, material.reflectance), words, counters);
        }
    }
    if constexpr (has<Config>(Feature::rough_dielectric)) {
        if (material.type == MaterialType::rough_dielectric) {
            return shade_rough_dielectric<Config>(scene, traced, path, vertex, material, words, counters);
        }
    }
    if constexpr (has<Config>(Feature::principled)) {
        if (material.type == MaterialType::principled) {
            return shade_principled<Config>(scene, traced, path, vertex, material,
                                            colour_of<Config>(surface, material.albedo), words, counters);
        }
    }
    if constexpr (has<Config>(Feature::subsurface)) {
        if (material.type == MaterialType::subsurface) {
            const bool begun = scatter_subsurface<Config>(scene, path, vertex, material, lobe, words.y, walk);
            counters.unfinished_walks += begun ? 0u : 1u;
            return begun;
        }
    }
    return false;
}

// Takes the path one step further on its subsurface walk. False: the path is lost.
template <class Config>
PT_HD inline bool walk_on(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                          WalkOf<Config>& walk, auto& counters) {
    const WalkStep step = walk_step<Config>(scene, path, walk, scene.materials[scene.object_material[walk.object]]);
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

// What happens where the segment ends. On return the path has its next ray, or is at the beginning of a walk that the
// caller takes to its end by walk_on, or is over (returns false). `traced`: the same scene, as rays walk through it.
// `branch`: what befalls the path at the vertex before it scatters; a branch that begins there has met the light there.
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
    // The branch is not called where it does nothing, since even such a call gives some kernels other registers.
    if constexpr (Branch::template acts_in<Config>) {
        if (!branch.template goes_on<Config>(scene, path, vertex, hit, unit_interval<Real>(words.w))) {
            return false;
        }
    }
    if (!scatter<Config>(scene, traced, path, vertex, surface, words, last, counters, walk)) {
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
