// What of a scene Mitsuba 3 cannot render to the same picture: docs/other_renderers.md has the reasons.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/scene/scene.h"

namespace pt {

// Why the scene cannot be exported at that depth, one line each, "FILE: PLACE: found X, allowed: Y"; empty: it can.
std::vector<std::string> mitsuba_problems(const Scene& scene, const std::string& file, std::uint32_t depth);

// The place of an object while the shutter is open; of one that moves, its first.
Vec3d place_of(const Scene& scene, const SceneObject& object);

// A box round an object that does not move, in double precision and not rounded outward.
struct Extent {
    Vec3d low, high;
};
Extent extent_of(const Scene& scene, const SceneObject& object);

// Events of a path after which Mitsuba's roulette begins, in a scene with bodies that scatter. It kills at least one
// path in twenty at each event, so walks that are longer by some hundreds are never seen and the picture is too dark:
// it begins where less than 10^-5 of any body's light is left. In a slab of L transport mean free paths a step leaves
// albedo * exp(-(1 - g) pi^2 / (3 L^2)) in the mode of diffusion that lasts longest (A. Ishimaru, Wave Propagation and
// Scattering in Random Media, 1978, chapter 9); a surface that reflects six tenths of what comes from within is as
// three more mean free paths on its side.
std::uint64_t roulette_depth(const Scene& scene);

// Whether an object contains a point, where it stands while the shutter is open.
bool contains_as_it_stands(const Scene& scene, const SceneObject& object, const Vec3d& point);

// What makes a lamp as bright in Mitsuba as here: n^2 of each dielectric that holds it, since every path to the lamp
// enters those once more than it leaves them.
double radiance_factor(const Scene& scene, const SceneObject& lamp);

// The image that the surface shows in Mitsuba; null: one colour.
const SceneTexture* mitsuba_image(const SceneMaterial& material);

// Whether a material is smooth glass, across whose boundary Mitsuba divides radiance by n^2.
bool is_glass(const SceneMaterial& material);

// Whether a material sends out light.
bool is_emissive(const SceneMaterial& material);

// How far off a surface Mitsuba's rays start at the scene's outermost corner, in units of the least axis of its spheres
// and boxes; 0 without any.
double mitsuba_offset_by_thickness(const Scene& scene, double scale);

}  // namespace pt
