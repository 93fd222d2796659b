// The choice direct_light=nee_mis, next-event estimation with multiple importance sampling: light found by a light
// sample and by a BSDF sample counts, each by its share of the two pdfs (kernels/next_event.h).
#include "variants/direct_light/next_event.h"

namespace pt::direct_light::nee_mis {
namespace {

constexpr Tunable tunables[] = {
    {"mis_exponent", 2, 1, 2, 1, "1: balance heuristic, 2: power heuristic", true},
};

const Registration registration(
    {
        .axis = "direct_light",
        .name = "nee_mis",
        .summary = "as nee, and light met counts too, both weighted by their densities",
        .origin = "Veach and Guibas 1995",
        .claim = Claim::statistical,
        .claim_note = next_event_claim,
        .mean_of = "off",
        .traits = DirectLightTraits{.connects_every_vertex = true},
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = next_event_unsupported_reason,
    },
    {.features = [] { return Feature::next_event | Feature::multiple_importance; }});

}  // namespace
}  // namespace pt::direct_light::nee_mis
