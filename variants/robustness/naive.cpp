// The choice robustness=naive: the textbook's formulas (kernels/naive.h), to measure what the robust ones cost and what
// they are worth. It is for the plainest integrators, which keep the order of the samples: a film that sums in single
// precision depends on it.
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::robustness::naive {
namespace {

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    if (!variant.integrator.sums_in_order) {
        return {"needs_samples_in_order",
                "sums a pixel's samples in their order: needs integrator=depth_first, megakernel or audited, not " +
                    std::string(variant.integrator.name)};
    }
    if (variant.precision.is_mixed()) {
        return {"two_intersections", "has its own intersection: needs precision=float or double, not " +
                                         std::string(variant.precision.name)};
    }
    if (variant.specialisation.by_matrix) {
        return {"two_intersections", "has its own intersection: needs another specialisation than matrix"};
    }
    if (!variant.sampler.is_in_every_kernel) {
        return {"needs_plain_sampler", "is compiled with sampler=pcg4d only"};
    }
    return meets_no_mesh(scene);
}

const Registration registration(
    {
        .axis = "robustness",
        .name = "naive",
        .summary = "epsilon 1e-4, school-formula sphere, slabs without Ize's factor, textbook Fresnel, 1 - cos cones, "
                   "film summed in single precision",
        .origin = "cis565 and most first ray tracers",
        .claim = Claim::biased,
        .claim_note = "wrong wherever a scene's size, distance or depth does not suit an epsilon of 1e-4",
        .traits = RobustnessTraits{.is_naive = true},
        .backends = on_every_backend,
        .unsupported_reason = unsupported_reason,
    },
    {.features = [] { return no_features | Feature::naive; }});

}  // namespace
}  // namespace pt::robustness::naive
