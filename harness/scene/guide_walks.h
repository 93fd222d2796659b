// Guides for random walks in subsurface bodies (kernels/guided_walk.h): how fast light falls with depth, by channel.
#pragma once

#include "harness/scene/scene.h"
#include "kernels/medium.h"

namespace pt {

// Solves albedo = kappa / artanh(kappa) for kappa from 0 to 1 and returns theta = artanh(kappa) > 0, the root of
// tanh(theta) = albedo theta, since kappa itself has too few digits near its ends. The albedo must be above 0 and below
// 1; the diffusion length of the medium is 1 / kappa mean free paths.
double artanh_of_decay(double albedo);

// The decay rate that guides random walks in a medium of this albedo and mean cosine g, in a body `depth` mean free
// paths deep (volume over surface). Anisotropic scattering goes by similarity: a share 1 - g of it counts as isotropic,
// the rest as none. In a plate lit from both sides the importance of light goes as cosh(kappa way from the middle), so
// the decay next to the surface is kappa tanh(kappa depth); for a ball of a few diffusion lengths this is right to a
// fifth. The result is clamped to `least_decay` .. `most_decay`: a guide may be wrong, but sampling needs a decay that
// is neither 0 nor 1.
inline constexpr double least_decay = 0x1p-20;
inline constexpr double most_decay = 0.985;
double guide_decay(double albedo, double g, double depth);

// Depth of an object: its volume over its surface, in scene units. Infinite for shapes other than boxes and spheres.
double depth_of(const SceneObject& object);

// Sets the guiding parameters of a subsurface medium. `depth`: the least `depth_of` any object that the medium fills.
template <class Real>
void guide_walks(ScatteringMedium<Real>& medium, const SceneMaterial& body, double guided_share, double depth);

}  // namespace pt
