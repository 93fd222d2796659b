// The choice robustness=robust: formulas whose rounding is bounded. A ray knows the surface that it departed from,
// spheres are intersected in their own frame, slabs reach by their rounding, cones and Fresnel factors do not cancel,
// the film sums integers.
#include "variants/registry.h"

namespace pt::robustness::robust {
namespace {

const Registration registration(
    {
        .axis = "robustness",
        .name = "robust",
        .summary = "no epsilon: other-root rule, stable quadratic, Ize's slabs, stable Fresnel and cones, integer film",
        .origin = "Ray Tracing Gems ch. 7, Ize 2013, pbrt-v4",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::robustness::robust
