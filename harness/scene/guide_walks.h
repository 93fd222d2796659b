// What a body's material says to guided walks (kernels/guided_walk.h): how fast light falls with depth, by channel.
#pragma once

#include "harness/scene/scene.h"
#include "kernels/medium.h"

namespace pt {

// The root kappa of albedo = kappa / artanh(kappa), from 0 to 1, as theta = artanh(kappa) > 0 that solves
// tanh(theta) = albedo theta: near the ends kappa itself says little. For an albedo above 0 and below 1; the diffusion
// length is 1 / kappa mean free paths.
double artanh_of_decay(double albedo);

// The decay by which walks are guided in a medium of this albedo and mean cosine, `depth` mean free paths deep: volume
// over surface. Scattering that is not even goes by similarity, as if 1 - g of it were even and the rest nothing. In a
// plate lit from both sides what light is worth goes as cosh(kappa way from the middle), so its decay next to the
// surface is kappa tanh(kappa depth); in a ball of a few diffusion lengths it is within a fifth of the same. Kept from
// `least_decay` to `most_decay`: a guide may be wrong, and sampling needs it to be neither 0 nor 1.
inline constexpr double least_decay = 0x1p-20;
inline constexpr double most_decay = 0.985;
double guide_decay(double albedo, double g, double depth);

// Depth of an object, its volume over its surface in scene units; infinite for a shape that has none of its own here.
double depth_of(const SceneObject& object);

// Fills in what guided walks need of a body's material. `depth`: the least depth_of an object that the material fills.
template <class Real>
void guide_walks(ScatteringMedium<Real>& medium, const SceneMaterial& body, double guided_share, double depth);

}  // namespace pt
