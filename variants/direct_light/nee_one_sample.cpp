// The choice direct_light=nee_one_sample, multiple importance sampling by the one-sample model: light is found by a
// light sample or by a BSDF sample, one of the two at random (kernels/next_event.h). Half the shadow rays of nee_mis.
#include "variants/direct_light/next_event.h"

namespace pt::direct_light::nee_one_sample {
namespace {

// MIS weights default to the balance heuristic's, the best that there is for one sample (Veach 1997, th. 9.4).
constexpr Tunable tunables[] = {
    {"mis_exponent", 1, 1, 2, 1, "1: balance heuristic, 2: power heuristic", true},
};

const Registration registration(
    {
        .axis = "direct_light",
        .name = "nee_one_sample",
        .summary = "a connection or light that is met, one of the two at random, weighted by their densities",
        .origin = "Veach 1997, sec. 9.2.4",
        .claim = Claim::statistical,
        .claim_note = next_event_claim,
        .mean_of = "off",
        .traits = DirectLightTraits{.connects_every_vertex = true},
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = next_event_unsupported_reason,
    },
    {.features = [] { return Feature::next_event | Feature::multiple_importance | Feature::one_sample; }});

}  // namespace
}  // namespace pt::direct_light::nee_one_sample
