// Next-event estimation (kernels/next_event.h): light is found by connecting diffuse and rough vertices to it, one
// random direction towards one random light each. From the camera, specular surfaces and bodies it is met by chance, as
// before.
#include "variants/direct_light/next_event.h"

namespace pt::direct_light::nee {
namespace {

const Registration registration(
    {
        .axis = "direct_light",
        .name = "nee",
        .summary = "every diffuse or rough vertex but the last is connected to a random light; light met after one "
                   "does not count",
        .origin = "Kajiya 1986; Shirley, Wang and Zimmerman 1996",
        .claim = Claim::statistical,
        .claim_note = next_event_claim,
        .mean_of = "off",
        .traits = DirectLightTraits{.connects_every_vertex = true, .counts_light_met = false},
        .backends = on_every_backend,
        .unsupported_reason = next_event_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::next_event; }});

}  // namespace
}  // namespace pt::direct_light::nee
