// The choice russian_roulette=adjoint_splitting: a path that is expected to bring little of its pixel's light is likely
// to be ended before it scatters (kernels/adjoint.h), and one that is expected to bring much scatters several times
// (kernels/path_tree.h).
#include "variants/russian_roulette/adjoint.h"

namespace pt::russian_roulette::adjoint_splitting {
namespace {

constexpr Tunable tunables[] = {
    adjoint_paths_tunable,
    adjoint_cells_tunable,
    weight_window_tunable,
    {"most_branches", 4, 2, 32, 1, "into so many at most a path splits at a vertex", true},
};

Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (!variant.integrator.keeps_branches) {
        return {"needs_branches",
                "needs an integrator that keeps the branches of a path: depth_first, megakernel, "
                "megakernel_regen or persistent, not " +
                    std::string(variant.integrator.name)};
    }
    if (variant.sampler.is_by_position) {
        return {"needs_numbered_branches",
                "needs a sampler whose numbers follow from the branch, not " + std::string(variant.sampler.name)};
    }
    if (variant.robustness.is_naive || variant.specialisation.by_matrix || variant.precision.is_mixed()) {
        return {"needs_usual_formulas",
                "is compiled for the usual formulas only: needs robustness=robust, another specialisation than matrix, "
                "and precision=float or double"};
    }
    return {};
}

const Registration registration(
    {
        .axis = "russian_roulette",
        .name = "adjoint_splitting",
        .summary = "as adjoint, and a path that is expected to bring much scatters several times",
        .origin = "Vorba and Krivanek 2016",
        .claim = Claim::statistical,
        .claim_note = "same expectation as russian_roulette=off: branches share what the path carried, whatever was "
                      "learned",
        .mean_of = "off",
        .traits = RouletteTraits{.splits_paths = true},
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = unsupported_reason,
    },
    {.features = [] { return Feature::adjoint_roulette | Feature::splitting; }});

}  // namespace
}  // namespace pt::russian_roulette::adjoint_splitting
