// Next-event estimation (kernels/next_event.h) over all lanes of a packet at once: light samples and shadow rays at
// diffuse vertices, and MIS weights of emitters that paths hit. Axis box lights are sampled by lanes_lights.h or
// lanes_light_faces.h, others lane by lane. A path has the same bits as by kernels/shade.h.
#pragma once

#include <iterator>
#include <numeric>

#include "variants/cpu/lanes_intersect.h"
#include "variants/cpu/lanes_light_faces.h"
#include "variants/cpu/lanes_line_of_sight.h"

namespace pt::lanes {

// The surfaces that a packet's rays hit, one a lane, as shading needs them.
template <class Real>
struct Surfaces {
    Vectors<Real> colour, position, normal;  // surface normal on the side that the ray comes from
    Lanes<std::uint32_t> type;
    Flags by_surface_at, by_shade;  // lanes whose hits are left to the scalar surface_at() or shade()
};

inline bool is_type(std::uint32_t type, MaterialType asked) { return type == static_cast<std::uint32_t>(asked); }
// A SurfaceId's word with only object and side (inside or outside), without the face that it may name.
inline std::uint32_t without_face(std::uint32_t side) { return side & ((SurfaceId::most_objects << 1) - 1u); }

// Work space for a packet's next-event estimation. It starts as zeros, so that unused lanes hold numbers, too.
template <class Real>
struct Connections {
    BoxObservers<Real> observers;
    LightDirections<Real> drawn;
    Vectors<Real> emission;
    Lanes<std::uint32_t> light;  // object that is the lane's light
    Flags connects, sends, sees;
    Lanes<Real> weight, cosine;  // weight of the light that is hit or sampled; cosine at the vertex
    Paths<Real> shadow;
    Hits<Real> hits;
};

// Whether a kernel samples points on boxes and quads, to which shadow rays are then traced.
template <class Config>
inline constexpr bool draws_points = face_sampling<Config> != LightSampling::solid_angle&& has_lines_of_sight<Config>;

// The place of an object among the scene's axis boxes, from the object's number.
template <class Real>
inline std::uint32_t box_of(const SceneView<Real>& scene, std::uint32_t object) {
    return object - first_of<ShapeKind::axis_box>(scene);
}

// Adds a lane to the observers of box lights; false if its light is no box or shows it no face.
template <class Config>
inline bool observes_box(BoxObservers<typename Config::Real>& observers, std::uint32_t l,
                         const SceneView<typename Config::Real>& scene, const LightTable<typename Config::Real>& lights,
                         std::uint32_t object, const Vec3<typename Config::Real>& position,
                         typename Config::Real time) {
    const std::uint32_t box = box_of(scene, object);
    return has<Config>(Feature::axis_box) && box < scene.axis_boxes.size &&
           observers.add(l, lights.boxes[box], at_rest<Config>(scene, object, position, time));
}

// Sets `work.weight` to encounter_weight (kernels/next_event.h) in lanes that hit an emitter, and to 1 elsewhere.
template <class Config>
inline void weigh_encounters(Connections<typename Config::Real>& work, const SceneView<typename Config::Real>& scene,
                             const LightTable<typename Config::Real>& lights, const Paths<typename Config::Real>& paths,
                             const Surfaces<typename Config::Real>& surfaces, const Hits<typename Config::Real>& hits,
                             const Flags& goes_on) {
    using Real = typename Config::Real;
    Flags asks;
    const bool by_connection_only = !has<Config>(Feature::multiple_importance) || scene.mis_exponent == 0;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const bool emits = is_type(surfaces.type[l], MaterialType::emitter) & SurfaceId{hits.side[l]}.exists();
        const bool is_connected = emits & (paths.bsdf_pdf[l] != Real(0));
        work.weight[l] = is_connected ? Real(0) : Real(1);
        asks[l] = is_connected ? goes_on[l] : 0u;
    }
    if (by_connection_only) {
        return;
    }
    BoxObservers<Real>& observers = work.observers;
    observers.clear();
    for (const std::uint32_t l : LaneList(asks)) {
        const std::uint32_t object = SurfaceId{hits.side[l]}.object();
        if (draws_points<Config> ||
            !observes_box<Config>(observers, l, scene, lights, object, paths.origin[l], paths.time[l])) {
            work.weight[l] = encounter_weight<Config>(scene, scene, paths.load(l), hits[l]);
        }
    }
    const auto set = [&](std::uint32_t l, Real inverse_pdf) {
        work.weight[l] =
            mis_weight_bsdf(paths.bsdf_pdf[l] * inverse_pdf * static_cast<Real>(scene.lights.size), scene.mis_exponent);
    };
    measure_near(observers.near);
    for (std::uint32_t k = 0; k < observers.near.size; ++k) {
        set(observers.near.lane[k], observers.near.total[k]);
    }
    measure_far(observers.far);
    for (std::uint32_t k = 0; k < observers.far.size; ++k) {
        const std::uint32_t l = observers.far.lane[k];
        set(l, far_inverse_pdf(observers.far.total[k], hits.t[l], observers.far.diagonal[k]));
    }
}

// Looks up which objects the lights chosen by lanes are, and the emission of these objects.
template <bool one_light, class Real>
inline void look_up_lights(Connections<Real>& work, const LightTable<Real>& lights) {
    const std::uint32_t* const object = lights.object.data();
    const Real *const red = lights.emission[0].data(), *const green = lights.emission[1].data(),
                      *const blue = lights.emission[2].data();
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const std::uint32_t i = work.drawn.light[l];
        work.light[l] = of_light<one_light>(object, i);
        work.emission.set(l,
                          {of_light<one_light>(red, i), of_light<one_light>(green, i), of_light<one_light>(blue, i)});
    }
}

// Chooses a light for every lane whose vertex is connected to a light.
template <class Config>
inline void choose_lights(Connections<typename Config::Real>& work, const SceneView<typename Config::Real>& scene,
                          const LightTable<typename Config::Real>& lights, const Paths<typename Config::Real>& paths) {
    using Real = typename Config::Real;
    const RandomSeed seed = scene.seed;
    const std::uint32_t count = scene.lights.size;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const RandomWords words =
            random_words<Config>(seed, {paths.pixel[l], paths.sample[l], paths.segment[l], random_block::light});
        work.drawn.light[l] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(words.x) * count >> 32);
        work.drawn.u[l] = unit_interval<Real>(words.y);
        work.drawn.v[l] = unit_interval<Real>(words.z);
        work.drawn.w[l] = unit_interval<Real>(words.w);
        if constexpr (has<Config>(Feature::mesh)) {
            work.drawn.primitive[l] = 0;
        }
    }
    lights.object.size() == 1 ? look_up_lights<true>(work, lights) : look_up_lights<false>(work, lights);
}

// Samples directions to the chosen lights in the lanes whose vertex is connected to a light.
template <class Config>
inline void draw_directions(Connections<typename Config::Real>& work, const SceneView<typename Config::Real>& scene,
                            const LightTable<typename Config::Real>& lights, const Paths<typename Config::Real>& paths,
                            const Vectors<typename Config::Real>& positions) {
    using Real = typename Config::Real;
    LightDirections<Real>& drawn = work.drawn;
    if constexpr (has<Config>(Feature::motion)) {
        drawn.is_other = work.connects;
    } else if constexpr (draws_points<Config>) {
        constexpr LightSampling sampling = face_sampling<Config>;
        const Real near_limit = near_light_of<Real>(scene);
        lights.object.size() == 1 ? sample_faces<sampling, true>(drawn, lights, positions, work.connects, near_limit)
                                  : sample_faces<sampling, false>(drawn, lights, positions, work.connects, near_limit);
    } else {
        look_at_lights(drawn, lights, positions, work.connects);
        sample_boxes(work.observers, drawn, lights);
    }
    for (const std::uint32_t l : LaneList(drawn.is_other)) {
        const DirectionSample<Real> sample = sample_direction_to<Config>(
            scene, work.light[l], positions[l], paths.time[l], drawn.u[l], drawn.v[l], drawn.w[l]);
        drawn.direction.set(l, sample.direction);
        drawn.inverse_pdf[l] = sample.inverse_pdf;
        drawn.distance[l] = sample.distance;
        if constexpr (has<Config>(Feature::mesh)) {
            drawn.primitive[l] = sample.primitive;
        }
    }
}

// Traces a packet's shadow rays. Lanes that send none trace their path's last ray, which is as good as any. On return
// `work.sees` marks the lanes whose light nothing hides.
template <class Config>
inline void trace_shadows(Connections<typename Config::Real>& work, const SceneView<typename Config::Real>& scene,
                          const Paths<typename Config::Real>& paths, const Surfaces<typename Config::Real>& surfaces,
                          const Hits<typename Config::Real>& hits) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> towards = work.drawn.direction[l];
        const Real cosine = dot(towards, surfaces.normal[l]);
        const bool sends = (work.connects[l] != 0) & (work.drawn.inverse_pdf[l] > Real(0)) & (cosine > Real(0));
        work.cosine[l] = cosine;
        work.sends[l] = sends ? 1u : 0u;
        work.shadow.origin.set(l, paths.origin[l]);
        work.shadow.origin.set_if(sends, l, surfaces.position[l]);
        work.shadow.direction.set(l, paths.direction[l]);
        work.shadow.direction.set_if(sends, l, towards);
        work.shadow.time[l] = paths.time[l];
        work.shadow.origin_surface[l] = sends ? without_face(hits.side[l]) : paths.origin_surface[l];
        if constexpr (has<Config>(Feature::mesh)) {
            work.shadow.primitive[l] = hits.primitive[l];
        }
    }
    if constexpr (draws_points<Config>) {
        work.sees = work.sends;
        look_along<Config>(work.sees, scene, work.light, work.drawn.primitive, work.shadow, work.drawn.distance);
    } else {
        lanes::closest_hit<Config>(work.hits, scene, work.shadow, work.sends);
#pragma GCC ivdep
        for (std::uint32_t l = 0; l < width; ++l) {
            const SurfaceId side{work.hits.side[l]};
            bool is_light = side.exists() & (side.object() == work.light[l]);
            if constexpr (has<Config>(Feature::mesh)) {
                is_light = is_light & (work.hits.primitive[l] == work.drawn.primitive[l]);
            }
            work.sees[l] = is_light ? work.sends[l] : 0u;
        }
    }
}

// Multiplies `work.weight`, the ratio of BSDF pdf to light pdf, by the MIS weight of the light sample.
template <std::uint32_t exponent, class Real>
inline void weigh_connections(Connections<Real>& work) {
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        work.weight[l] *= mis_weight_light(work.weight[l], exponent);
    }
}

// Next-event estimation, as connect_next_event (kernels/next_event.h), at the diffuse vertices of the lanes whose flag
// `work.connects` is set.
template <class Config>
inline void connect(Connections<typename Config::Real>& work, const SceneView<typename Config::Real>& scene,
                    const LightTable<typename Config::Real>& lights, Paths<typename Config::Real>& paths,
                    const Surfaces<typename Config::Real>& surfaces, const Hits<typename Config::Real>& hits,
                    PathCounters& counters) {
    using Real = typename Config::Real;
    choose_lights<Config>(work, scene, lights, paths);
    draw_directions<Config>(work, scene, lights, paths, surfaces.position);
    trace_shadows<Config>(work, scene, paths, surfaces, hits);
    const Real light_count = static_cast<Real>(scene.lights.size);
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Real pdf = work.cosine[l] * (Real(1) / pi<Real>);
        work.weight[l] = pdf * work.drawn.inverse_pdf[l] * light_count;
    }
    if (has<Config>(Feature::multiple_importance) && scene.mis_exponent != 0) {
        scene.mis_exponent == 2 ? weigh_connections<2>(work) : weigh_connections<1>(work);
    }
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> carried = paths.throughput[l] * surfaces.colour[l];
        paths.radiance.set_if(work.sees[l] != 0, l, paths.radiance[l] + carried * work.emission[l] * work.weight[l]);
    }
    const std::uint32_t sent = std::accumulate(std::begin(work.sends.of), std::end(work.sends.of), 0u);
    counters.rays += sent;
    counters.connections += sent;
}

}  // namespace pt::lanes
