// The choice dwivedi: a share of a subsurface walk's steps is drawn towards the nearest surface
// (kernels/guided_walk.h).
#include "variants/registry.h"

namespace pt::subsurface_sampling::dwivedi {
namespace {

constexpr Tunable tunables[] = {
    {"guided_percent", 50, 1, 99, 1,
     "how many of a walk's steps are guided; a step's weight is at most 1 over the rest", true},
};

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    if (!contains(scene, Feature::subsurface)) {
        return {"needs_subsurface", "needs a subsurface material: nothing else has walks to guide"};
    }
    if (variant.robustness.is_naive) {
        return {"needs_robust", "needs robustness=robust, not " + std::string(variant.robustness.name)};
    }
    if (variant.precision.is_mixed()) {
        return {"needs_one_precision", "needs precision=float or double, not " + std::string(variant.precision.name)};
    }
    if (variant.specialisation.by_matrix) {
        return {"needs_own_kernel", "needs another specialisation than matrix, whose one kernel guides no walks"};
    }
    return {};
}

const Registration registration(
    {
        .axis = "subsurface_sampling",
        .name = "dwivedi",
        .summary = "a share of the steps towards the surface, by the zero-variance walk of a half space, weighted by "
                   "the balance heuristic",
        .origin = "Dwivedi 1982; Krivanek and d'Eon 2014; Meng, Hanika and Dachsbacher 2016",
        .claim = Claim::statistical,
        .claim_note = "same expectation as subsurface_sampling=classical: a step counts by one over the mean density "
                      "of all ways in which it could have been drawn",
        .mean_of = "classical",
        .traits = SubsurfaceSamplingTraits{.is_classical = false},
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = unsupported_reason,
    },
    {.features = [] { return no_features | Feature::guided_walk; }});

}  // namespace
}  // namespace pt::subsurface_sampling::dwivedi
