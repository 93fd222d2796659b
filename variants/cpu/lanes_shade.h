// Shading of a packet's hits: kernels/shade.h over all lanes at once, for diffuse and mirror surfaces. Lanes that hit
// other materials go through shade itself, and hits off the sides of the enclosure are placed by surface_at, lane by
// lane. The formulas are the kernels', in their order, so a path has the same bits.
#pragma once

#include "variants/cpu/lanes_connect.h"

namespace pt::lanes {

// Whether a kernel samples lights in one way, not in one that is chosen at run time.
template <class Config>
inline constexpr bool has_one_light_sampling = ((Config::features & light_samplings) &
                                                ((Config::features & light_samplings) - 1u)) == 0;

// Whether a kernel's shading is done in SIMD lanes: not if the kernel has one of the features listed here. Objects and
// materials without a loop over lanes send a single lane through shade().
template <class Config>
inline constexpr bool shades_in_lanes = has_one_light_sampling<Config> &&
                                        (Config::features &
                                         (Feature::emission | Feature::absorption | Feature::environment |
                                          Feature::environment_map | Feature::final_bounce | light_selections |
                                          Feature::one_sample | Feature::russian_roulette | Feature::adjoint_roulette |
                                          Feature::matrix | Feature::textures | Feature::shading_normals | samplers)) ==
                                            0;

// Looks up the surface data of a packet's hits. Addresses depend on the lane, so there are no vectors; a lane that hit
// nothing reads object 0.
template <class Real>
inline void look_up(Surfaces<Real>& surfaces, const SceneView<Real>& scene, const Hits<Real>& hits) {
    for (std::uint32_t l = 0; l < width; ++l) {
        const SurfaceId side{hits.side[l]};
        const Surface<Real>& surface = scene.surfaces[side.exists() ? side.object() : 0];
        surfaces.colour.set(l, surface.colour);
        surfaces.type[l] = static_cast<std::uint32_t>(surface.type);
    }
}

// Counts a path segment, adds the light of emitters that were hit, and says which paths go on. `weight`: MIS weight of
// that light, in a kernel with next-event estimation.
template <class Config>
inline void meet(Paths<typename Config::Real>& paths, Flags& goes_on, const Surfaces<typename Config::Real>& surfaces,
                 const Hits<typename Config::Real>& hits, const Lanes<typename Config::Real>& weight,
                 std::uint32_t depth) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const bool hits_one = SurfaceId{hits.side[l]}.exists();
        const bool emits = has<Config>(Feature::emitter) & is_type(surfaces.type[l], MaterialType::emitter);
        Vec3<Real> met = paths.throughput[l] * surfaces.colour[l];
        if constexpr (has<Config>(Feature::next_event)) {
            met = met * weight[l];
        }
        const Vec3<Real> light = paths.radiance[l] + met;
        const std::uint32_t segment = paths.segment[l] + 1;
        paths.radiance.set_if(hits_one & emits, l, light);
        paths.segment[l] = segment;
        goes_on[l] = hits_one & !emits & (segment < depth) ? goes_on[l] : 0u;
    }
}

// Computes the positions of hits on the sides of the enclosure, and flags the lanes whose hits lie elsewhere.
template <class Config>
inline void place_on_enclosure(Surfaces<typename Config::Real>& surfaces, const SceneView<typename Config::Real>& scene,
                               const Paths<typename Config::Real>& paths, const Hits<typename Config::Real>& hits,
                               const Flags& going_on) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        surfaces.normal.set(l, face_normal<Real>(SurfaceId{hits.side[l]}));
    }
    const AxisAlignedEnclosure<Real> enclosure = scene.enclosure;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const Vec3<Real> n = surfaces.normal[l];
        const Vec3<Real> p = paths.origin[l] + paths.direction[l] * hits.t[l];
        const Vec3<Real> low{n.x > Real(0) ? enclosure.low.x : p.x, n.y > Real(0) ? enclosure.low.y : p.y,
                             n.z > Real(0) ? enclosure.low.z : p.z};
        const Vec3<Real> position{n.x < Real(0) ? enclosure.high.x : low.x, n.y < Real(0) ? enclosure.high.y : low.y,
                                  n.z < Real(0) ? enclosure.high.z : low.z};
        const bool is_placed =
            has<Config>(Feature::enclosure) & has_face(SurfaceId{hits.side[l]}) & lanes::contains(enclosure, position);
        const bool is_here =
            is_type(surfaces.type[l], MaterialType::diffuse) | is_type(surfaces.type[l], MaterialType::mirror);
        surfaces.position.set(l, position);
        surfaces.by_shade[l] = is_here ? 0u : going_on[l];
        surfaces.by_surface_at[l] = is_here & !is_placed ? going_on[l] : 0u;
    }
}

template <class Config>
inline void place_others(Surfaces<typename Config::Real>& surfaces, const SceneView<typename Config::Real>& scene,
                         const Paths<typename Config::Real>& paths, const Hits<typename Config::Real>& hits) {
    const LaneList others(surfaces.by_surface_at);
    if constexpr (has<Config>(Feature::mesh)) {
        // Triangles that lanes have hit lie far apart in memory, so all are prefetched before the first is used.
        for (const std::uint32_t l : others) {
            const std::uint32_t mesh = SurfaceId{hits.side[l]}.object() - first_of<ShapeKind::mesh>(scene);
            if (mesh < scene.meshes.size) {
                __builtin_prefetch(scene.meshes[mesh].geometry.triangles + hits.primitive[l]);
            }
        }
    }
    for (const std::uint32_t l : others) {
        const auto point = surface_at<Config>(scene, paths.ray(l), hits[l]);
        surfaces.position.set(l, point.position);
        surfaces.normal.set(l, SurfaceId{hits.side[l]}.inside() ? -point.normal : point.normal);
    }
}

// Samples the BSDF at diffuse and mirror vertices. `is_connected`: whether diffuse vertices were connected to lights.
template <class Config>
inline void scatter(Paths<typename Config::Real>& paths, const Surfaces<typename Config::Real>& surfaces,
                    const RandomSeed& seed, const Hits<typename Config::Real>& hits, bool is_connected) {
    using Real = typename Config::Real;
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const RandomWords words =
            random_words<Config>(seed, {paths.pixel[l], paths.sample[l], paths.segment[l], random_block::scatter});
        const Vec3<Real> normal = surfaces.normal[l];
        const Vec3<Real> local = cosine_hemisphere(unit_interval<Real>(words.y), unit_interval<Real>(words.z));
        const Vec3<Real> spread = Frame<Real>(normal).to_world(local);
        const Vec3<Real> mirrored = reflect(paths.direction[l], normal);
        const bool is_diffuse = is_type(surfaces.type[l], MaterialType::diffuse);
        const bool is_here = surfaces.by_shade[l] == 0;
        if constexpr (has<Config>(Feature::next_event)) {
            // The BSDF pdf that a path stores is never 0, which stands for a vertex without a connection.
            constexpr Real least = Real(0x1p-60);
            const Real pdf = max(dot(spread, normal), least) * (Real(1) / pi<Real>);
            paths.bsdf_pdf[l] = is_here ? (is_diffuse & is_connected ? pdf : Real(0)) : paths.bsdf_pdf[l];
        }
        paths.throughput.set_if(is_here, l, paths.throughput[l] * surfaces.colour[l]);
        paths.origin.set_if(is_here, l, surfaces.position[l]);
        paths.direction.set_if(is_here, l,
                               {is_diffuse ? spread.x : mirrored.x, is_diffuse ? spread.y : mirrored.y,
                                is_diffuse ? spread.z : mirrored.z});
        const std::uint32_t side_alone = (SurfaceId::most_objects << 1) - 1u;  // mask of a SurfaceId without its face
        paths.origin_surface[l] = is_here ? hits.side[l] & side_alone : paths.origin_surface[l];
        if constexpr (has<Config>(Feature::mesh)) {
            paths.primitive[l] = is_here ? hits.primitive[l] : paths.primitive[l];
        }
    }
}

// Shades the hits of a packet: on return each path whose flag `goes_on` was set has its next ray, or is over and its
// flag cleared. The scene has at least one object. `work` and `lights`, the scene's, are for kernels with connections.
template <class Config>
inline void shade(Paths<typename Config::Real>& paths, Flags& goes_on, const SceneView<typename Config::Real>& scene,
                  const Hits<typename Config::Real>& hits, Connections<typename Config::Real>& work,
                  const LightTable<typename Config::Real>& lights, PathCounters& counters) {
    using Real = typename Config::Real;
    const bool is_connected = has<Config>(Feature::next_event) && scene.next_event != 0;
    Surfaces<Real> surfaces;
    look_up(surfaces, scene, hits);
    if constexpr (has<Config>(Feature::next_event)) {
        weigh_encounters<Config>(work, scene, lights, paths, surfaces, hits, goes_on);
    }
    meet<Config>(paths, goes_on, surfaces, hits, work.weight, scene.depth);
    place_on_enclosure<Config>(surfaces, scene, paths, hits, goes_on);
    place_others<Config>(surfaces, scene, paths, hits);
    for (const std::uint32_t l : LaneList(surfaces.by_shade)) {
        Path<Real> path = paths.load(l);
        path.segment -= 1;  // taken back, since shade() counts the segment a second time
        goes_on[l] = pt::shade<Config>(scene, scene, path, hits[l], counters) ? 1u : 0u;
        paths.store(l, path);
    }
    if constexpr (has<Config>(Feature::next_event)) {
        if (is_connected) {
            for (std::uint32_t l = 0; l < width; ++l) {
                const bool is_here = is_type(surfaces.type[l], MaterialType::diffuse) & (surfaces.by_shade[l] == 0);
                work.connects[l] = is_here ? goes_on[l] : 0u;
            }
            connect<Config>(work, scene, lights, paths, surfaces, hits, counters);
        }
    }
    scatter<Config>(paths, surfaces, scene.seed, hits, is_connected);
}

}  // namespace pt::lanes
