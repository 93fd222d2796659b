// Subsurface scattering by a random walk through a homogeneous body, from where the path enters to where it leaves.
// Free paths are drawn from one colour channel, chosen in proportion to the path's throughput (as Cycles does), and
// weighted by the mean of the three densities in the same proportion (one-sample balance heuristic). Coloured
// coefficients bring no bias, and the sum of the three throughputs never grows; under a uniform choice their variance
// grows with every step. A grey medium has the weight sigma_s / sigma_t exactly. Phase function: Henyey and Greenstein
// 1941. Boundary: index-matched, or Fresnel with internal reflection. The walk sees its own body only: objects inside
// the body are not hit. Where the variant asks for it, walks are guided to the surface (kernels/guided_walk.h).
#pragma once

#include "kernels/boundary.h"
#include "kernels/guided_walk.h"
#include "kernels/nearest_surface.h"
#include "kernels/scattering.h"

namespace pt {

template <class Scene, class Real>
PT_HD inline Real naive_distance_to_exit(const Scene& scene, std::uint32_t object, const Vec3<Real>& origin,
                                         const Vec3<Real>& direction) {
    Real distance = Real(0);
    visit_shape<EveryShape<Real>>(scene, object,
                                  [&](const auto& shape) { distance = naive::interval(shape, origin, direction).far; });
    return distance;
}

// Distance along a ray to a body's surface, from a point inside or, if `on_surface`, from the surface inwards.
template <class Config, class Scene>
PT_HD inline typename Config::Real distance_to_exit(const Scene& scene, std::uint32_t object,
                                                    const Vec3<typename Config::Real>& origin,
                                                    const Vec3<typename Config::Real>& direction, bool on_surface) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::double_intersection)) {
        return static_cast<Real>(distance_to_exit<InDouble<Config>>(WideScene(scene), object, Vec3<double>(origin),
                                                                    Vec3<double>(direction), on_surface));
    } else if constexpr (has<Config>(Feature::naive)) {
        return max(Real(0), naive_distance_to_exit(scene, object, origin, direction));
    }
    Real distance = Real(0);
    visit_shape<Config>(scene, object, [&](const auto& shape) {
        distance = distance_out_of(as_met<Config>(shape), origin, direction, on_surface);
    });
    return distance;
}

template <class Real>
PT_HD inline Real channel(const Vec3<Real>& v, std::uint32_t i) {
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

// Weight of a subsurface flight of length t: transmittance over the mean density. `scattered`: the flight ended in a
// collision (density sigma_t e^-sigma_t t), else it reached the surface (probability e^-sigma_t t).
template <class Real>
PT_HD inline Vec3<Real> flight_weight(const ScatteringMedium<Real>& medium, const Vec3<Real>& throughput, Real t,
                                      bool scattered) {
    if (medium.grey != 0) {
        return scattered ? medium.scattering_albedo : Vec3<Real>{Real(1), Real(1), Real(1)};
    }
    // Transmittances are relative to the most transparent channel, so that they do not all underflow at once.
    const Real least = min(medium.sigma_t.x, min(medium.sigma_t.y, medium.sigma_t.z));
    const Vec3<Real> transmittance{exponential((least - medium.sigma_t.x) * t),
                                   exponential((least - medium.sigma_t.y) * t),
                                   exponential((least - medium.sigma_t.z) * t)};
    const Real carried = dot(throughput, scattered ? transmittance * medium.sigma_t : transmittance);
    // The flight's weight stays finite where hardly anything is transmitted: no opaque channel may become 0 * infinity.
    const Real inverse_mean = carried > Real(0) ? min(std::numeric_limits<Real>::max(),
                                                      (throughput.x + throughput.y + throughput.z) / carried)
                                                : Real(0);
    return (scattered ? transmittance * medium.sigma_s : transmittance) * inverse_mean;
}

// A subsurface random walk; path.origin and path.direction are the walk's, in the frame of the body at rest.
struct Walk {
    static constexpr std::uint32_t none = 0xffffffffu;
    std::uint32_t step = none;  // steps taken by the subsurface walk; `none`: the path is on no walk
    std::uint32_t object = 0;   // object that the subsurface walk is inside of
    bool on_surface = true;

    PT_HD bool is_on() const { return step != none; }
};

// A subsurface walk in progress in kernels that guide walks by Dwivedi sampling (kernels/guided_walk.h).
template <class Real>
struct GuidedWalk : Walk {
    Vec3<Real> normal;            // outward normal of the body's surface that is nearest as far as is known
    StepChoice choice;            // colour channel, guided or not, by whose density the walk's next step is drawn
    bool drew_direction = false;  // the walk's direction was drawn by the density of `choice`

    PT_HD void meet_surface(const Vec3<Real>& outward, const StepChoice& next) {
        normal = outward;
        choice = next;
        drew_direction = false;
    }
};

// State of a subsurface walk in a kernel; with a guide only in kernels that have guided walks.
template <class Config>
using WalkOf = std::conditional_t<has<Config>(Feature::guided_walk), GuidedWalk<typename Config::Real>, Walk>;

// Whether random walks in this medium are guided: never if the variant asks for none, though a kernel could guide them.
template <class Real>
PT_HD inline bool is_guided(const ScatteringMedium<Real>& medium) {
    return medium.guided_share > Real(0);
}

// The extinction coefficient sigma_t of the colour channel that the next flight is drawn by.
template <class Config>
PT_HD inline typename Config::Real sigma_of_flight(const Path<typename Config::Real>& path, const WalkOf<Config>& walk,
                                                   const ScatteringMedium<typename Config::Real>& medium,
                                                   const RandomWords& words) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::guided_walk)) {
        if (is_guided(medium)) {
            const std::uint32_t colour = walk.choice.colour;
            const Real decay = walk.choice.is_guided ? channel(medium.guide_decay, colour) : Real(0);
            return channel(medium.sigma_t, colour) * (Real(1) - decay * dot(path.direction, walk.normal));
        }
    }
    return channel(medium.sigma_t, choose_channel(path.throughput, unit_interval<Real>(words.y)));
}

// Weight of a step of a subsurface walk: of its flight and, in a guided walk, of its direction too.
template <class Config>
PT_HD inline Vec3<typename Config::Real> step_weight(const Path<typename Config::Real>& path,
                                                     const WalkOf<Config>& walk,
                                                     const ScatteringMedium<typename Config::Real>& medium,
                                                     typename Config::Real t, bool scattered) {
    using Real = typename Config::Real;
    if constexpr (has<Config>(Feature::guided_walk)) {
        if (is_guided(medium)) {
            const Real cosine = dot(path.direction, walk.normal);
            return guided_step_weight<Real>(medium, path.throughput, {cosine, walk.drew_direction, scattered}, t);
        }
    }
    return flight_weight(medium, path.throughput, t, scattered);
}

// Unit direction at a cosine to an axis, with a random azimuth about the axis.
template <class Real>
PT_HD inline Vec3<Real> turn_about(const Vec3<Real>& axis, Real cosine, std::uint32_t random) {
    const Real sine = square_root(max(Real(0), (Real(1) - cosine) * (Real(1) + cosine)));
    const SinCos<Real> azimuth = sin_cos_turn(unit_interval<Real>(random));
    return renormalize(Frame<Real>(axis).to_world({sine * azimuth.cosine, sine * azimuth.sine, cosine}));
}

// Scatters a subsurface walk at a collision. A guided walk also chooses the density of its next step.
template <class Config>
PT_HD inline void scatter_in_medium(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                                    WalkOf<Config>& walk, const ScatteringMedium<typename Config::Real>& medium,
                                    const RandomWords& words) {
    using Real = typename Config::Real;
    const Real u = unit_interval<Real>(words.z);
    if constexpr (has<Config>(Feature::guided_walk)) {
        if (is_guided(medium)) {
            visit_shape<Config>(scene, walk.object, [&](const auto& shape) {
                walk.normal = outward_near(shape, path.origin, walk.normal);
            });
            walk.choice = choose_step(medium, path.throughput, unit_interval<Real>(words.y));
            walk.drew_direction = medium.g == Real(0);
            if (walk.choice.is_guided && walk.drew_direction) {
                const std::uint32_t colour = walk.choice.colour;
                const Real cosine =
                    guided_cosine(channel(medium.guide_decay, colour), channel(medium.guide_albedo, colour), u);
                path.direction = turn_about(walk.normal, cosine, words.w);
                return;
            }
        }
    }
    path.direction = turn_about(path.direction, henyey_greenstein_cosine(medium.g, u), words.w);
}

template <class Real>
struct SubsurfaceMaterial {
    Boundary<Real> entering, leaving;
    std::uint32_t has_boundary;     // 1 if the body's index of refraction is not 1
    std::uint32_t max_scatterings;  // cap on the scatterings of one subsurface walk
    ScatteringMedium<Real> medium;

    // Reflects the path at the boundary of a subsurface body, or lets it in to begin a walk. A path whose walk cannot
    // begin is lost, and counted.
    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>&) const {
        const bool has_begun = begin_walk(at);
        at.counters.unfinished_walks += has_begun ? 0u : 1u;
        return has_begun;
    }

private:
    template <class At>
    PT_HD bool begin_walk(const At& at) const {
        using Config = typename At::Config;
        Path<Real>& path = at.path;
        const VertexOf<Config>& vertex = at.vertex;
        // Walks start at the surface, from outside. A path that hits it from inside came through another body that
        // reaches in: what it missed is not known, so it is lost and counted (the loader refuses an eye inside a body).
        if (vertex.inside) {
            return false;
        }
        if constexpr (has<Config>(Feature::subsurface_boundary)) {
            if (has_boundary != 0) {
                const Real cosine = cosine_of_incidence(path.direction, vertex.normal());
                const Refraction<Real> refraction = fresnel<Config>(entering, cosine);
                if (at.random_lobe() < refraction.reflectance) {
                    leave_on_same_side(path, vertex, reflect(path.direction, vertex.normal()));
                    return true;
                }
                path.direction = refract(entering, path.direction, vertex.normal(), cosine, refraction.q);
            }
        }
        path.origin = at_rest<Config>(at.scene, vertex.object, vertex.position, path.time);
        static_cast<Walk&>(at.walk) = {.step = 0, .object = vertex.object, .on_surface = true};
        if constexpr (has<Config>(Feature::guided_walk)) {
            at.walk.meet_surface(vertex.normal(),
                                 choose_step(medium, path.throughput, unit_interval<Real>(at.words.y)));
        }
        return true;
    }
};

enum class WalkStep { goes_on, left, lost };

// Takes one flight of a subsurface walk, to a collision or to the surface. Result `left`: the path is on the surface,
// heading out; `lost`: the cap on scatterings and internal reflections was reached first.
template <class Config>
PT_HD inline WalkStep walk_step(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                                WalkOf<Config>& walk, const SubsurfaceMaterial<typename Config::Real>& body) {
    using Real = typename Config::Real;
    const ScatteringMedium<Real>& medium = body.medium;
    if (walk.step > body.max_scatterings) {
        return WalkStep::lost;
    }
    const Vec3<Real> direction = path.direction;
    const RandomWords words =
        random_words<Config>(scene.seed, {path.pixel, path.sample, path.segment, random_block::walk + walk.step});
    walk.step += 1;
    const Real to_exit = distance_to_exit<Config>(scene, walk.object, path.origin, direction, walk.on_surface);
    // An infinite or NaN distance to the surface means that the body is too thin or too far away for its coordinates.
    if (!(to_exit <= std::numeric_limits<Real>::max())) {
        return WalkStep::lost;
    }
    const Real sigma = sigma_of_flight<Config>(path, walk, medium, words);
    const Real flight = sigma > Real(0) ? -logarithm(positive_unit_interval<Real>(words.x)) / sigma
                                        : std::numeric_limits<Real>::infinity();
    const bool scattered = flight < to_exit;
    path.throughput *= step_weight<Config>(path, walk, medium, scattered ? flight : to_exit, scattered);
    if (scattered) {
        path.origin = path.origin + direction * flight;
        walk.on_surface = false;
        scatter_in_medium<Config>(scene, path, walk, medium, words);
        return WalkStep::goes_on;
    }
    const Ray<Real> ray{in_motion<Config>(scene, walk.object, path.origin, path.time), direction, path.time,
                        SurfaceId{}};
    const SurfacePoint<Real> exit = surface_at<Config>(scene, ray, {to_exit, SurfaceId::of(walk.object, true)});
    if constexpr (has<Config>(Feature::subsurface_boundary)) {
        if (body.has_boundary != 0) {
            const Vec3<Real> inward = -exit.normal;
            const Real cosine = cosine_of_incidence(direction, inward);
            const Refraction<Real> refraction = fresnel<Config>(body.leaving, cosine);
            if (unit_interval<Real>(words.z) < refraction.reflectance) {
                path.origin = at_rest<Config>(scene, walk.object, exit.position, path.time);
                path.direction = reflect(direction, inward);
                walk.on_surface = true;
                if constexpr (has<Config>(Feature::guided_walk)) {
                    walk.meet_surface(exit.normal, choose_step(medium, path.throughput, unit_interval<Real>(words.y)));
                }
                return WalkStep::goes_on;
            }
            path.direction = refract(body.leaving, direction, inward, cosine, refraction.q);
        }
    }
    path.origin = exit.position;
    path.origin_surface = SurfaceId::of(walk.object, false);
    path.primitive = 0;
    return WalkStep::left;
}

}  // namespace pt
