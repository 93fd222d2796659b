// Next-event estimation at a path's last vertex: sampling of points on lights, and the connection to one of them. A
// light is chosen uniformly, a point on it by area; the estimate is BSDF * cos * cos' / (distance^2 * density) *
// radiance where the point is visible (Veach 1997, eq. 8.9 with one sample). An environment is chosen as one more
// light: a constant one is sampled by the cosine, one with Feature::environment_map as in kernels/environment_map.h.
#pragma once

#include "kernels/absorption.h"
#include "kernels/environment_map.h"

namespace pt {

template <class Config>
PT_HD inline LightSample<typename Config::Real> sample_light(const SceneView<typename Config::Real>& scene,
                                                             std::uint32_t object, typename Config::Real time,
                                                             typename Config::Real u, typename Config::Real v,
                                                             typename Config::Real w) {
    using Real = typename Config::Real;
    LightSample<Real> sample{{Real(0), Real(0), Real(0)}, {Real(0), Real(1), Real(0)}, Real(0)};
    visit_shape<Config>(scene, object, [&](const auto& shape) { sample = sample_point(shape, u, v, w); });
    sample.position = in_motion<Config>(scene, object, sample.position, time);
    return sample;
}

// Connects a diffuse vertex to the environment, which was drawn as a light with probability 1 / choices. Returns the
// number of rays traced.
template <class Config>
PT_HD inline std::uint32_t connect_to_environment(const SceneView<typename Config::Real>& scene,
                                                  const SceneView<typename Config::Real>& traced,
                                                  Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                                  const Vec3<typename Config::Real>& albedo, const RandomWords& words,
                                                  std::uint32_t choices) {
    using Real = typename Config::Real;
    const EnvironmentSample<Real> sample = sample_environment(*scene.environment_map, words.y, words.z, words.w);
    const Real cosine = dot(sample.direction, vertex.normal());
    if (!(cosine > Real(0)) || !is_on_one_side<Config>(vertex, sample.direction, false)) {
        return 0;
    }
    const Ray<Real> ray{vertex.position, sample.direction, path.time, SurfaceId::of(vertex.object, vertex.inside),
                        vertex.primitive};
    if (!closest_hit_of_connection<Config>(traced, ray).side.exists()) {
        const Real inverse_pdf = sample.place.inverse_pdf * static_cast<Real>(choices);
        const Real weight = cosine * inverse_pdf * (Real(1) / pi<Real>);
        path.radiance += path.throughput * albedo * sample.place.radiance * weight;
    }
    return 1;
}

// Adds to path.radiance an estimate of the light at the last vertex from one light sample; the path is not ended.
// Returns the number of rays traced (0 or 1). `albedo` is the diffuse lobe's; `traced` is the same scene, as rays
// traverse it.
//
// Visibility needs no epsilon: the light sample is visible if the closest hit is on the light, on the side on which the
// sample lies; a convex light shows each ray exactly one point of each side.
template <class Config>
PT_HD inline std::uint32_t connect(const SceneView<typename Config::Real>& scene,
                                   const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                                   const VertexOf<Config>& vertex, const Vec3<typename Config::Real>& albedo,
                                   const RandomWords& direction_words) {
    using Real = typename Config::Real;
    std::uint32_t environment_light =
        has<Config>(Feature::environment) && scene.environment != Vec3<Real>(Real(0)) ? 1u : 0u;
    if constexpr (has<Config>(Feature::environment_map)) {
        environment_light |= scene.environment_map != nullptr ? 1u : 0u;
    }
    const std::uint32_t choices = scene.lights.size + environment_light;
    if (choices == 0) {
        return 0;
    }
    const RandomWords words =
        random_words<Config>(scene.seed, {path.pixel, path.sample, path.segment, random_block::light});
    const std::uint32_t choice = static_cast<std::uint32_t>((static_cast<std::uint64_t>(words.x) * choices) >> 32);
    if (choice == scene.lights.size) {
        if constexpr (has<Config>(Feature::environment_map)) {
            if (scene.environment_map != nullptr) {
                return connect_to_environment<Config>(scene, traced, path, vertex, albedo, words, choices);
            }
        }
        scatter_diffuse<Config>(path, vertex, albedo, direction_words.y, direction_words.z);
        if (!is_on_one_side<Config>(vertex, path.direction, false)) {
            return 0;
        }
        if (!closest_hit_of_connection<Config>(traced, ray_of(path)).side.exists()) {
            path.radiance += path.throughput * scene.environment * static_cast<Real>(choices);
        }
        return 1;
    }
    const std::uint32_t object = scene.lights[choice].object;
    const LightSample<Real> light = sample_light<Config>(scene, object, path.time, unit_interval<Real>(words.y),
                                                         unit_interval<Real>(words.z), unit_interval<Real>(words.w));
    const Vec3<Real> to_light = light.position - vertex.position;
    const Real distance_squared = dot(to_light, to_light);
    if (!(distance_squared > Real(0))) {
        return 0;
    }
    const Vec3<Real> direction = to_light * (Real(1) / square_root(distance_squared));
    const Real cosine = dot(direction, vertex.normal());
    const Real light_cosine = dot(direction, light.normal);
    if (!(cosine > Real(0)) || light_cosine == Real(0) || !is_on_one_side<Config>(vertex, direction, false)) {
        return 0;
    }
    const Ray<Real> ray{vertex.position, direction, path.time, SurfaceId::of(vertex.object, vertex.inside),
                        vertex.primitive};
    const Hit<Real> hit = closest_hit_of_connection<Config>(traced, ray);
    if (hit.side.exists() && hit.side.object() == object && hit.side.inside() == (light_cosine > Real(0)) &&
        is_of_primitive<Config>(hit, light.primitive)) {
        // The squared distance to the light sample is divided out in two steps: 1 / distance^2 alone may overflow.
        const Real geometry = (cosine / distance_squared) * (absolute(light_cosine) * light.inverse_density);
        if constexpr (has<Config>(Feature::absorption)) {
            if (path.medium != Path<Real>::no_medium) {
                attenuate(path, scene.materials[path.medium], hit.t);
            }
        }
        path.radiance += path.throughput * albedo * scene.materials[scene.object_material[object]].emission *
                         (geometry * static_cast<Real>(choices) * (Real(1) / pi<Real>));
    }
    return 1;
}

}  // namespace pt
