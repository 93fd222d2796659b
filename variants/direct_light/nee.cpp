// The choice direct_light=nee, next-event estimation (kernels/next_event.h): diffuse and rough vertices are connected
// to light, one random direction towards one random light each. Light that the camera, a specular surface or a body
// leads to counts where a path hits it.
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
