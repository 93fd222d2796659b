// The choice light_sampling=area: points on the faces of boxes that are seen, and on quads, sampled uniformly by area
// (kernels/light_sampling.h).
#include "variants/light_sampling/light_sampling.h"

namespace pt::light_sampling::area {
namespace {

const Registration registration(
    {
        .axis = "light_sampling",
        .name = "area",
        .summary = "boxes and quads by the area that is seen of them; weights without bound where a light is near",
        .origin = "Shirley, Wang and Zimmerman 1996",
        .claim = Claim::statistical,
        .claim_note = light_sampling_claim,
        .mean_of = "solid_angle",
        .traits = LightSamplingTraits{.is_by_solid_angle = false},
        .backends = on_every_backend,
        .unsupported_reason = light_sampling_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::area_sampling; }});

}  // namespace
}  // namespace pt::light_sampling::area
