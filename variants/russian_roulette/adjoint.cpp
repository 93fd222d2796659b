// The choice russian_roulette=adjoint: a path that is expected to bring little of its pixel's light is likely to be
// ended before it scatters (kernels/adjoint.h).
#include "variants/russian_roulette/adjoint.h"

namespace pt::russian_roulette::adjoint {
namespace {

constexpr Tunable tunables[] = {adjoint_paths_tunable, adjoint_cells_tunable, weight_window_tunable};

const Registration registration(
    {
        .axis = "russian_roulette",
        .name = "adjoint",
        .summary = "a path goes on with a probability by what it is expected to bring, as other paths have learned",
        .origin = "Vorba and Krivanek 2016",
        .claim = Claim::statistical,
        .claim_note = "same expectation as russian_roulette=off: what goes on is divided by its probability, whatever "
                      "was learned",
        .mean_of = "off",
        .backends = on_every_backend,
        .tunables = tunables,
    },
    {.features = [] { return no_features | Feature::adjoint_roulette; }});

}  // namespace
}  // namespace pt::russian_roulette::adjoint
