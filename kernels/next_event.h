// Next-event estimation: at every diffuse or rough vertex but the last one light is chosen uniformly and a direction
// towards it drawn by solid angle (kernels/solid_angle.h). Light that the path then meets from such a vertex does not
// count again, or, with multiple importance sampling, both count by their share of the densities (Veach 1997, ch. 9):
// with the ratio r = density of the scattered direction / density of the light's, a connection weighs 1 / (1 + r^b) and
// an encounter r^b / (1 + r^b); b = 1 is the balance heuristic, 2 the power heuristic. An environment is never
// connected to: rays that leave the scene always count.
#pragma once

#include "kernels/dielectric.h"
#include "kernels/ggx.h"
#include "kernels/intersect.h"

namespace pt {

// As the kernel samples a shape: in textbook form where the shape has one.
template <class Config, class Shape, class Real>
PT_HD inline DirectionSample<Real> sample_direction_in(const Shape& shape, const Vec3<Real>& observer, Real u, Real v,
                                                       Real w) {
    if constexpr (has<Config>(Feature::naive)) {
        return naive::sample_direction(shape, observer, u, v, w);
    } else {
        return sample_direction(shape, observer, u, v, w);
    }
}

template <class Config, class Shape, class Real>
PT_HD inline Real inverse_direction_pdf_in(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction,
                                           Real distance) {
    if constexpr (has<Config>(Feature::naive)) {
        return naive::inverse_direction_pdf(shape, observer, direction, distance);
    } else {
        return inverse_direction_pdf(shape, observer, direction, distance);
    }
}

template <class Config>
PT_HD inline DirectionSample<typename Config::Real> sample_direction_to(
    const SceneView<typename Config::Real>& scene, std::uint32_t object, const Vec3<typename Config::Real>& position,
    typename Config::Real time, typename Config::Real u, typename Config::Real v, typename Config::Real w) {
    using Real = typename Config::Real;
    const Vec3<Real> observer = at_rest<Config>(scene, object, position, time);
    DirectionSample<Real> sample{{Real(0), Real(0), Real(1)}, Real(0)};
    visit_shape<Config>(scene, object,
                        [&](const auto& shape) { sample = sample_direction_in<Config>(shape, observer, u, v, w); });
    return sample;
}

// 1 / density, by solid angle, of sample_direction_to in the direction of a ray that meets the object at `hit`.
template <class Config>
PT_HD inline typename Config::Real inverse_direction_pdf_to(const SceneView<typename Config::Real>& scene,
                                                            const Hit<typename Config::Real>& hit,
                                                            const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    const std::uint32_t object = hit.side.object();
    const Vec3<Real> observer = at_rest<Config>(scene, object, ray.origin, ray.time);
    Real inverse_pdf = Real(0);
    visit_shape<Config>(scene, object, [&](const auto& shape) {
        inverse_pdf =
            inverse_direction_pdf_in<Config>(primitive_of(shape, hit.primitive), observer, ray.direction, hit.t);
    });
    return inverse_pdf;
}

// The share of light that a scattered direction met, and 1 less it: of `ratio` = r. Up to 2^60, whose square is finite
// and whose share is 1: r may be infinite where a light is all but touched.
template <class Real>
PT_HD inline Real mis_weight_bsdf(Real ratio, std::uint32_t exponent) {
    const Real finite = min(Real(0x1p60), ratio);
    const Real power = exponent == 2 ? finite * finite : finite;
    return power / (Real(1) + power);
}
template <class Real>
PT_HD inline Real mis_weight_light(Real ratio, std::uint32_t exponent) {
    return Real(1) / (Real(1) + (exponent == 2 ? ratio * ratio : ratio));
}

// What light counts that the path meets at `hit`, at the end of its ray.
template <class Config>
PT_HD inline typename Config::Real encounter_weight(const SceneView<typename Config::Real>& scene,
                                                    const Path<typename Config::Real>& path,
                                                    const Hit<typename Config::Real>& hit) {
    using Real = typename Config::Real;
    if (path.bsdf_pdf == Real(0)) {
        return Real(1);
    }
    if constexpr (has<Config>(Feature::multiple_importance)) {
        if (scene.mis_exponent != 0) {
            const Real inverse_pdf = inverse_direction_pdf_to<Config>(scene, hit, ray_of(path));
            return mis_weight_bsdf(path.bsdf_pdf * inverse_pdf * static_cast<Real>(scene.lights.size),
                                   scene.mis_exponent);
        }
    }
    return Real(0);
}

// The diffuse lobe, as a lobe is asked for.
template <class Real>
struct DiffuseLobe {
    static constexpr bool transmits = false;
    Vec3<Real> albedo;

    PT_HD LobeValue<Real> towards(const Vec3<Real>&, Real cosine) const {
        return {albedo, cosine * (Real(1) / pi<Real>)};
    }
};

// Adds to path.radiance the light of one direction towards one light, seen by way of a lobe of the vertex.
// Returns the number of rays traced (0 or 1). `traced`: the same scene, as rays walk through it. The light is seen if
// it is the nearest object along the ray: a convex one shows each ray one point from outside, and none of its own.
template <class Config, class Lobe>
PT_HD inline std::uint32_t connect_next_event(const SceneView<typename Config::Real>& scene,
                                              const SceneView<typename Config::Real>& traced,
                                              Path<typename Config::Real>& path,
                                              const Vertex<typename Config::Real>& vertex, const Lobe& lobe) {
    using Real = typename Config::Real;
    const RandomWords words =
        random_words<Config>(scene.seed, {path.pixel, path.sample, path.segment, random_block::light});
    const std::uint64_t scaled = static_cast<std::uint64_t>(words.x) * scene.lights.size;
    const std::uint32_t object = scene.lights[static_cast<std::uint32_t>(scaled >> 32)].object;
    const DirectionSample<Real> sample =
        sample_direction_to<Config>(scene, object, vertex.position, path.time, unit_interval<Real>(words.y),
                                    unit_interval<Real>(words.z), unit_interval<Real>(words.w));
    const Real cosine = dot(sample.direction, vertex.normal());
    const bool passes = Lobe::transmits && cosine < Real(0);
    if (!(sample.inverse_pdf > Real(0)) || !(cosine > Real(0) || passes)) {
        return 0;
    }
    const Ray<Real> ray{vertex.position, sample.direction, path.time,
                        SurfaceId::of(vertex.object, vertex.inside != passes), vertex.primitive};
    const Hit<Real> hit = closest_hit<Config>(traced, ray);
    if (!hit.side.exists() || hit.side.object() != object || !is_of_primitive<Config>(hit, sample.primitive)) {
        return 1;
    }
    const LobeValue<Real> value = lobe.towards(sample.direction, cosine);
    const Real ratio = value.pdf * sample.inverse_pdf * static_cast<Real>(scene.lights.size);
    Real weight = ratio;
    if constexpr (has<Config>(Feature::multiple_importance)) {
        weight *= scene.mis_exponent != 0 ? mis_weight_light(ratio, scene.mis_exponent) : Real(1);
    }
    Vec3<Real> carried = path.throughput * value.weight;
    if constexpr (has<Config>(Feature::absorption)) {
        std::uint32_t medium = path.medium;
        if constexpr (Lobe::transmits) {
            medium = passes ? lobe.medium_beyond : medium;
        }
        if (medium != Path<Real>::no_medium) {
            carried *= transmittance(scene.materials[medium], hit.t);
        }
    }
    path.radiance += carried * scene.materials[scene.object_material[object]].emission * weight;
    return 1;
}

}  // namespace pt
