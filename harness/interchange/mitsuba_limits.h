// Finds what makes a scene look different in Mitsuba 3: docs/other_renderers.md has the reasons.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/scene/scene.h"

namespace pt {

// Reasons why a scene cannot be exported to Mitsuba with paths of `depth` segments, one line each, "FILE: PLACE: found
// X, allowed: Y"; empty if it can.
std::vector<std::string> mitsuba_problems(const Scene& scene, const std::string& file, std::uint32_t depth);

// Position of an object when the shutter opens.
Vec3d place_of(const Scene& scene, const SceneObject& object);

// Bounding box of an object that does not move, in double precision and not rounded outward.
struct Extent {
    Vec3d low, high;
};
Extent extent_of(const Scene& scene, const SceneObject& object);

// Mitsuba's rr_depth, the number of path events before Russian roulette starts, for a scene with subsurface bodies.
// Mitsuba kills at least one path in twenty at each event, so the long walks in bodies would be cut and the picture too
// dark. Roulette starts where less than 10^-5 of any body's light is left. In a slab of L transport mean free paths
// each step keeps albedo * exp(-(1 - g) pi^2 / (3 L^2)) of the slowest diffusion mode (A. Ishimaru, Wave Propagation
// and Scattering in Random Media, 1978, chapter 9). A surface that reflects 60 % from within adds three mean free
// paths.
std::uint64_t roulette_depth(const Scene& scene);

// Whether an object contains a point, at its position when the shutter opens.
bool contains_as_it_stands(const Scene& scene, const SceneObject& object, const Vec3d& point);

// Factor on a lamp's radiance that makes it as bright in Mitsuba: n^2 for each dielectric around the lamp, since each
// path to the lamp enters these once more than it leaves them.
double radiance_factor(const Scene& scene, const SceneObject& lamp);

// The texture that the surface is exported with to Mitsuba; null: a constant colour.
const SceneTexture* mitsuba_image(const SceneMaterial& material);

// Whether a material is smooth glass, across whose boundary Mitsuba scales radiance by 1 / n^2.
bool is_glass(const SceneMaterial& material);

// Whether a material emits light.
bool is_emissive(const SceneMaterial& material);

// Mitsuba's offset of ray origins from surfaces, taken at the scene's outermost corner, where it is largest, divided by
// the smallest axis of all spheres and boxes; 0 if the scene has none of these.
double mitsuba_offset_by_thickness(const Scene& scene, double scale);

}  // namespace pt
