// Lights are selected in proportion to their area times their mean radiance, by an alias table
// (kernels/light_selection.h).
#include "variants/light_selection/light_selection.h"

namespace pt::light_selection::power {
namespace {

const Registration registration(
    {
        .axis = "light_selection",
        .name = "power",
        .summary = "a light in proportion to what it emits, wherever it is, by an alias table",
        .origin = "Shirley, Wang and Zimmerman 1996; Vose 1991",
        .claim = Claim::statistical,
        .claim_note = light_selection_claim,
        .mean_of = "uniform",
        .traits = LightSelectionTraits{.is_uniform = false},
        .backends = on_every_backend,
        .unsupported_reason = light_selection_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::power_selection; }});

}  // namespace
}  // namespace pt::light_selection::power
