// What the camera rays of a film's own samples meet first, averaged over each pixel: albedo, normal, distance, and how
// many meet anything. A pass of its own on the CPU, outside every clock, that no kernel or film knows of.
#pragma once

#include <vector>

#include "harness/render/renderer.h"

namespace pt {

// A ray that meets nothing counts with zeros, as in Mitsuba 3's integrator `aov`; divided by the coverage, they are
// means over the rays that do.
struct FirstHits {
    std::uint32_t rays = 0;       // a pixel
    std::vector<float> albedo;    // linear RGB; of what it is of a material, first_hit_albedo
    std::vector<float> normal;    // that it is shaded with, in the world, on the side that the ray came from
    std::vector<float> depth;     // along the ray from its origin, on the lens if there is one; scene units
    std::vector<float> coverage;  // the share of the rays that meet something
};

// A longer render's first samples stand for all of them.
inline constexpr std::uint32_t most_first_hit_rays = 256;

// The rays of the request's first samples, most_first_hit_rays at most, in the variant's precision and with its
// sampler; a first-bounce cache's own. Surfaces are met by the plain formulas whatever the variant. Precondition: not
// depends_on_order(variant).
FirstHits first_hits(const Scene& scene, const RenderRequest& request);

// The number that the scene gives: a diffuse surface's albedo, the reflectance of mirrors and rough conductors, of a
// mix both by its probability, the tint of dielectrics, sigma_s / sigma_t of a subsurface body, 0 of emitters.
Vec3d first_hit_albedo(const SceneMaterial& material);
// The albedo of a material whose texture has this colour at the hit.
Vec3d first_hit_albedo(const SceneMaterial& material, const Vec3d& colour);

}  // namespace pt
