// The choice specialisation=matrix: kernels that intersect every object through its 4x4 matrix, in one loop over all
// objects, with every branch compiled in: what cis565 does, and the price that classifying objects at load saves.
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::specialisation::matrix {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "matrix",
        .summary = "one kernel with every feature; every object through its 4x4 inverse matrix",
        .origin = "cis565",
        .claim = Claim::statistical,
        .claim_note = "same expectation as generic; a matrix rounds otherwise, and a path that grazes an edge may go "
                      "elsewhere",
        .mean_of = "generic",
        .traits = SpecialisationTraits{.by_matrix = true},
        .backends = on_every_backend,
        .unsupported_reason = [](FeatureSet scene, const VariantTraits& variant) -> Reason {
            if (!variant.sampler.is_in_every_kernel) {
                return {"needs_plain_sampler", "is compiled with sampler=pcg4d only"};
            }
            // Which surface a camera ray hits at an edge depends on rounding. With jitter that averages out, but an
            // unjittered ray through a pixel's centre is the same in every sample.
            if (!contains(scene, Feature::jitter)) {
                return {"needs_jitter", "needs jitter: an unjittered camera ray may meet an edge exactly"};
            }
            return meets_no_mesh(scene);
        },
    },
    {.specialisation = [](const KernelOffer&, const Variant&, Backend) { return all_features | Feature::matrix; }});

}  // namespace
}  // namespace pt::specialisation::matrix
