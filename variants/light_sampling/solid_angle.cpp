// The choice light_sampling=solid_angle: directions sampled uniformly in the solid angle that a light fills; weights
// are bounded however near the light is (kernels/solid_angle.h).
#include "variants/registry.h"

namespace pt::light_sampling::solid_angle {
namespace {

const Registration registration(
    {
        .axis = "light_sampling",
        .name = "solid_angle",
        .summary = "by solid angle: cones and spherical rectangles, boxes farther away than 2 diagonals by area",
        .origin = "Shirley, Wang and Zimmerman 1996; Urena, Fajardo and King 2013",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::light_sampling::solid_angle
