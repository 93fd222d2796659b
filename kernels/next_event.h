// Next-event estimation: every diffuse or rough vertex but the last is connected to one light, chosen uniformly or by
// kernels/light_selection.h, in a direction drawn by solid angle (kernels/solid_angle.h) or as Feature::area_sampling
// and its like say. Light that the path then hits from such a vertex does not count again, or, with multiple importance
// sampling, both count by their share of the densities (Veach 1997, ch. 9): with the ratio r = pdf of the BSDF sample /
// pdf of the light sample, a connection has the weight 1 / (1 + r^b) and a light that is hit r^b / (1 + r^b); b = 1 is
// the balance heuristic, 2 the power heuristic. One-sample MIS (Veach 1997, sec. 9.2.4) chooses either with probability
// 1/2, and counts it twice. A constant environment is never connected to: rays that leave the scene always count. With
// Feature::environment_map it is one more light.
#pragma once

#include "kernels/absorption.h"
#include "kernels/environment_map.h"
#include "kernels/light_direction.h"
#include "kernels/light_selection.h"
#include "kernels/lobe.h"

namespace pt {

// MIS weights of a BSDF sample and of a light sample by the ratio r of their pdfs. For the BSDF sample r, which may be
// infinite close to a light, is capped at 2^60, whose square is finite and whose weight is 1.
template <class Real>
PT_HD inline Real mis_weight_bsdf(Real ratio, std::uint32_t exponent) {
    const Real finite = min(Real(0x1p60), ratio);
    const Real power = exponent == 2 ? finite * finite : finite;
    return nearly_divide(power, Real(1) + power);
}
template <class Real>
PT_HD inline Real mis_weight_light(Real ratio, std::uint32_t exponent) {
    return nearly_divide(Real(1), Real(1) + (exponent == 2 ? ratio * ratio : ratio));
}

// MIS weight of a light that the path hits at `hit`. `traced`: the same scene as rays traverse it.
template <class Config>
PT_HD inline typename Config::Real encounter_weight(const SceneView<typename Config::Real>& scene,
                                                    const SceneView<typename Config::Real>& traced,
                                                    const Path<typename Config::Real>& path,
                                                    const Hit<typename Config::Real>& hit) {
    using Real = typename Config::Real;
    if (path.bsdf_pdf == Real(0)) {
        return Real(1);
    }
    if constexpr (has<Config>(Feature::multiple_importance)) {
        if (scene.mis_exponent != 0) {
            Real techniques = Real(1);
            if constexpr (has<Config>(Feature::one_sample)) {
                if (path.bsdf_pdf < Real(0)) {
                    return Real(0);
                }
                techniques = scene.one_sample != 0 ? Real(2) : Real(1);
            }
            const Real inverse_pdf =
                inverse_direction_pdf_to<Config>(has_one_light<Config>() ? traced : scene, hit, ray_of(path));
            Real inverse_weighing = inverse_light_weighing<Config>(scene, hit.side.object(), path.origin);
            if constexpr (has<Config>(Feature::environment_map)) {
                if (scene.environment_map != nullptr) {
                    inverse_weighing *= scene.environment_map->inverse_object_probability;
                }
            }
            const Real ratio = path.bsdf_pdf * inverse_pdf * inverse_weighing;
            return techniques * mis_weight_bsdf(ratio, scene.mis_exponent);
        }
    }
    return Real(0);
}

// Chooses either the connection or the light that the path hits under one-sample MIS, and records that in the sign of
// path.bsdf_pdf. Returns whether the vertex is to be connected.
template <class Config>
PT_HD inline bool is_to_be_connected(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                                     const RandomWords& words) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::one_sample)) {
        if (scene.one_sample != 0) {
            // One-sample MIS hashes the light's random words in another order than kernels/light_selection.h does, so
            // that its choice is independent of the choice of the light.
            const bool connects = (pcg4d({words.w, words.z, words.y, words.x}).x >> 31) != 0;
            path.bsdf_pdf = connects ? Real(-1) : Real(1);
            return connects;
        }
    }
    return true;
}

// Pdf of the BSDF sample in the form that a path stores after connect_next_event: negative where one-sample MIS chose
// the connection.
template <class Config>
PT_HD inline typename Config::Real kept_pdf(const Path<typename Config::Real>& path, typename Config::Real pdf) {
    if constexpr (has<Config>(Feature::one_sample)) {
        return path.bsdf_pdf < 0 ? -pdf : pdf;
    }
    return pdf;
}

// Adds the environment's light to a path whose ray leaves the scene.
template <class Config>
PT_HD inline void meet_environment(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path) {
    using Real = typename Config::Real;
    if (scene.environment_map == nullptr) {
        return;
    }
    const EnvironmentMap<Real>& map = *scene.environment_map;
    const EnvironmentPlace<Real> place = environment_towards(map, path.direction);
    Real weight = Real(1);
    if constexpr (has<Config>(Feature::next_event)) {
        if (path.bsdf_pdf != Real(0)) {
            weight = Real(0);
            if constexpr (has<Config>(Feature::multiple_importance)) {
                if (scene.mis_exponent != 0) {
                    weight = mis_weight_bsdf(max(path.bsdf_pdf, Real(0)) * place.inverse_pdf * map.inverse_probability,
                                             scene.mis_exponent);
                    if constexpr (has<Config>(Feature::one_sample)) {
                        weight *= scene.one_sample != 0 ? Real(2) : Real(1);
                    }
                }
            }
        }
    }
    path.radiance += path.throughput * place.radiance * weight;
}

// Hit of a shadow ray on the light that it was drawn to, or nowhere if the light is occluded. `distance`: to the light
// sample, or 0. Light samples by solid angle take the closest hit: over a few objects that costs less than to intersect
// the light by itself.
template <class Config>
PT_HD inline Hit<typename Config::Real> hit_of_light(const SceneView<typename Config::Real>& scene,
                                                     std::uint32_t object, const Ray<typename Config::Real>& ray,
                                                     typename Config::Real distance) {
    using Real = typename Config::Real;
    return in_one_place<Config>([&]() -> Hit<Real> {
        bool knows_point = false;
        if constexpr ((Config::features & light_samplings) != 0) {
            knows_point = distance > Real(0);
        }
        if constexpr (has_lines_of_sight<Config>) {
            if (knows_point) {
                const Sight sight = line_of_sight<Config>(scene, object, ray, distance);
                if (sight != Sight::unsure) {
                    return {distance, sight == Sight::clear ? SurfaceId::of(object, false) : SurfaceId{}};
                }
            }
        }
        Hit<Real> hit = closest_hit_of_connection<Config>(scene, ray);
        if (knows_point) {
            const bool sees = sees_point<Config>(scene, object, ray, distance, hit);
            return {distance, sees ? SurfaceId::of(object, false) : SurfaceId{}};
        }
        if (hit.side.exists() && hit.side.object() != object) {
            hit.side = {};
        }
        return hit;
    });
}

// Next-event estimation with the environment as the light, which is visible if the ray leaves the scene. Returns how
// many rays were traced.
template <class Config, class Lobe>
PT_HD inline std::uint32_t connect_environment(const SceneView<typename Config::Real>& scene,
                                               const SceneView<typename Config::Real>& traced,
                                               Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                               const Lobe& lobe, const RandomWords& words) {
    using Real = typename Config::Real;
    const EnvironmentMap<Real>& map = *scene.environment_map;
    const EnvironmentSample<Real> sample = sample_environment(map, words.y, words.z, words.w);
    const Real cosine = vertex.dot_normal(sample.direction);
    const bool passes = Lobe::transmits && cosine < Real(0);
    if (sample.place.radiance == Vec3<Real>(Real(0)) || !(cosine > Real(0) || passes)) {
        return 0;
    }
    if (!is_on_one_side<Config>(vertex, sample.direction, passes)) {
        return 0;
    }
    if constexpr (Lobe::may_be_opaque) {
        if (passes && !lobe.lets_through()) {
            return 0;
        }
    }
    const Ray<Real> ray{vertex.position, sample.direction, path.time,
                        SurfaceId::of(vertex.object, vertex.inside != passes), vertex.primitive};
    if (closest_hit_of_connection<Config>(traced, ray).side.exists()) {
        return 1;
    }
    const LobeValue<Real> value = lobe.towards(sample.direction, cosine);
    const Real ratio = value.pdf * sample.place.inverse_pdf * map.inverse_probability;
    Real weight = ratio;
    if constexpr (has<Config>(Feature::multiple_importance)) {
        weight *= scene.mis_exponent != 0 ? mis_weight_light(ratio, scene.mis_exponent) : Real(1);
        if constexpr (has<Config>(Feature::one_sample)) {
            weight *= scene.one_sample != 0 ? Real(2) : Real(1);
        }
    }
    path.radiance += path.throughput * value.weight * sample.place.radiance * weight;
    return 1;
}

// A light that was drawn for next-event estimation, and a direction towards a point on it.
template <class Real>
struct LightDraw {
    LightPick<Real> pick;
    std::uint32_t object;
    DirectionSample<Real> sample;
};

// Draws a light, and a point on it. `two_sided`: lights behind the vertex count too. `traced`: the same scene as rays
// traverse it.
template <class Config>
PT_HD inline LightDraw<typename Config::Real> draw_light(const SceneView<typename Config::Real>& scene,
                                                         const SceneView<typename Config::Real>& traced,
                                                         const VertexOf<Config>& vertex, typename Config::Real time,
                                                         bool two_sided, const RandomWords& words) {
    using Real = typename Config::Real;
    return in_one_place<Config>([&]() -> LightDraw<Real> {
        LightPick<Real> pick = pick_light<Config>(scene, vertex, two_sided, words);
        if constexpr (has<Config>(Feature::environment_map)) {
            if (scene.environment_map != nullptr) {
                pick.inverse_probability *= scene.environment_map->inverse_object_probability;
                pick.inverse_weighing *= scene.environment_map->inverse_object_probability;
            }
        }
        const std::uint32_t object = scene.lights[pick.light].object;
        const SceneView<Real>& read = has_one_light<Config>() ? traced : scene;
        DirectionSample<Real> sample =
            sample_direction_to<Config>(read, object, vertex.position, time, unit_interval<Real>(words.y),
                                        unit_interval<Real>(words.z), unit_interval<Real>(words.w));
        if constexpr (has<Config>(Feature::emission)) {
            // If the vertex lies on the light itself, only closest_hit tells which side the ray hits, so the distance
            // is set to 0 (unknown).
            sample.distance = vertex.object == object ? Real(0) : sample.distance;
        }
        return {pick, object, sample};
    });
}

// Connects a lobe of the vertex to one light, and adds the light of one sample to path.radiance. Returns the number of
// rays traced (0 or 1). `traced`: the same scene as rays traverse it. The light is visible if it is the closest hit: a
// convex light shows each ray one point from outside, and none to rays that start on it.
template <class Config, class Lobe>
PT_HD inline std::uint32_t connect_next_event(const SceneView<typename Config::Real>& scene,
                                              const SceneView<typename Config::Real>& traced,
                                              Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                              const Lobe& lobe) {
    using Real = typename Config::Real;
    RandomWords words = random_words<Config>(scene.seed, {path.pixel, path.sample, path.segment, random_block::light});
    if (!is_to_be_connected<Config>(scene, path, words)) {
        return 0;
    }
    if constexpr (has<Config>(Feature::environment_map)) {
        if (scene.environment_map != nullptr && draws_environment(*scene.environment_map, words.x)) {
            return connect_environment<Config>(scene, traced, path, vertex, lobe, words);
        }
    }
    const auto [pick, object, sample] = draw_light<Config>(scene, traced, vertex, path.time, Lobe::transmits, words);
    const Real cosine = vertex.dot_normal(sample.direction);
    const bool passes = Lobe::transmits && cosine < Real(0);
    if (!(sample.inverse_pdf > Real(0)) || !(cosine > Real(0) || passes)) {
        return 0;
    }
    if (!is_on_one_side<Config>(vertex, sample.direction, passes)) {
        return 0;
    }
    if constexpr (Lobe::may_be_opaque) {
        if (passes && !lobe.lets_through()) {
            return 0;
        }
    }
    const Ray<Real> ray{vertex.position, sample.direction, path.time,
                        SurfaceId::of(vertex.object, vertex.inside != passes), vertex.primitive};
    const Hit<Real> hit = hit_of_light<Config>(traced, object, ray, sample.distance);
    if (!hit.side.exists() || !is_of_primitive<Config>(hit, sample.primitive)) {
        return 1;
    }
    const LobeValue<Real> value = lobe.towards(sample.direction, cosine);
    const Real ratio = value.pdf * sample.inverse_pdf * pick.inverse_probability;
    Real weight = ratio;
    if constexpr (has<Config>(Feature::multiple_importance)) {
        Real weighed = ratio;
        if constexpr (has<Config>(Feature::tree_selection)) {
            weighed = value.pdf * sample.inverse_pdf * pick.inverse_weighing;
        }
        weight *= scene.mis_exponent != 0 ? mis_weight_light(weighed, scene.mis_exponent) : Real(1);
        if constexpr (has<Config>(Feature::one_sample)) {
            weight *= scene.one_sample != 0 ? Real(2) : Real(1);
        }
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
