// The choice light_sampling=projected: points on the faces of boxes that are seen, and on quads, a face in proportion
// to its projected area times distance, so that the pdf does not depend on the face (kernels/light_sampling.h).
#include "variants/light_sampling/light_sampling.h"

namespace pt::light_sampling::projected {
namespace {

const Registration registration(
    {
        .axis = "light_sampling",
        .name = "projected",
        .summary = "as area, a face of a box by its projected area times distance; weights without bound where a light "
                   "is near",
        .origin = "Shirley, Wang and Zimmerman 1996; the far form of solid_angle",
        .claim = Claim::statistical,
        .claim_note = light_sampling_claim,
        .mean_of = "solid_angle",
        .traits = LightSamplingTraits{.is_by_solid_angle = false},
        .backends = on_every_backend,
        .unsupported_reason = light_sampling_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::projected_sampling; }});

}  // namespace
}  // namespace pt::light_sampling::projected
