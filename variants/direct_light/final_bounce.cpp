// The choice direct_light=final_bounce: the last vertex of a path of full length is connected to a random light point,
// weighted by BSDF, both cosines, distance, area and visibility (kernels/light.h). A student's idea (CIS565-Fall-2022)
// with the weights that it lacked. Such a path has one segment more than by plain path tracing, so its expectation is
// that of depth + 1. A last vertex on a specular surface takes that segment by its BSDF.
#include "variants/registry.h"

namespace pt::direct_light::final_bounce {
namespace {

const Registration registration(
    {
        .axis = "direct_light",
        .name = "final_bounce",
        .summary = "the last diffuse vertex is connected to a random point on a random light",
        .origin = "a student's CIS565-Fall-2022/Project3-CUDA-Path-Tracer, with the weights that it lacked",
        .claim = Claim::statistical,
        .claim_note = "same expectation as direct_light=off at depth + 1",
        .mean_of = "off",
        .mean_at_extra_depth = 1,
        .backends = on_every_backend,
        .unsupported_reason = [](FeatureSet scene, const VariantTraits&) -> Reason {
            const FeatureSet lights =
                set_of(Feature::emitter, Feature::emission, Feature::environment, Feature::environment_map);
            return (scene & lights) != 0 ? Reason{} : Reason{"needs_light", "needs a light in the scene"};
        },
    },
    {.features = [] { return no_features | Feature::final_bounce; }});

}  // namespace
}  // namespace pt::direct_light::final_bounce
