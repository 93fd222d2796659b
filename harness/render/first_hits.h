// First hits (AOVs) of a film's camera rays, averaged over each pixel: albedo, normal, distance and coverage. They are
// computed by a separate pass on the CPU, which is not timed and does not affect kernels or films.
#pragma once

#include <vector>

#include "harness/render/renderer.h"

namespace pt {

// Means over all camera rays of a pixel, where a ray without a hit counts as zeros, as in Mitsuba 3's integrator `aov`.
// Divided by the coverage, they are means over the rays that hit a surface.
struct FirstHits {
    std::uint32_t rays = 0;       // number of camera rays per pixel
    std::vector<float> albedo;    // linear RGB of the surface, by first_hit_albedo
    std::vector<float> normal;    // shading normal in world space, on the side of the ray origin
    std::vector<float> depth;     // distance from the ray origin (on the lens, if any), in scene units
    std::vector<float> coverage;  // share of a pixel's camera rays that hit a surface
};

// Most camera rays per pixel that first hits are averaged over; renders of more samples use only the first of them.
inline constexpr std::uint32_t most_first_hit_rays = 256;

// Traces the camera rays of the request's first samples (at most most_first_hit_rays) in the variant's precision and
// with its sampler, or the rays of a first-bounce cache. Surfaces are intersected by the robust formulas whatever the
// variant. Precondition: not depends_on_order(variant).
FirstHits first_hits(const Scene& scene, const RenderRequest& request);

// The albedo of a material without texture: diffuse albedo, reflectance of mirrors and rough conductors, mean of both
// for a mix, tint of dielectrics, sigma_s / sigma_t of subsurface bodies, 0 for emitters.
Vec3d first_hit_albedo(const SceneMaterial& material);
// The albedo of a material whose texture has `colour` at the hit point.
Vec3d first_hit_albedo(const SceneMaterial& material, const Vec3d& colour);

}  // namespace pt
