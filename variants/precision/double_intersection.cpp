// The choice precision=double_intersection: single precision, but for intersection and the points that it gives
// (kernels/widen.h). On the CPU only the plainest kernel has it.
#include "variants/mesh_reasons.h"
#include "variants/precision/kernels_in_double.h"

namespace pt::precision::double_intersection {
namespace {

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    if (variant.specialisation.by_matrix) {
        return {"two_intersections", "has its own intersection: needs another specialisation than matrix"};
    }
    if (!variant.sampler.is_in_every_kernel) {
        return {"needs_plain_sampler", "is compiled with sampler=pcg4d only"};
    }
    return meets_no_mesh(scene);
}

Reason does_not_apply_on_the_cpu(FeatureSet scene, const VariantTraits& variant) {
    Reason reason = needs_kernel_in_double(variant);
    return reason.empty() ? unsupported_reason(scene, variant) : reason;
}

constexpr Descriptor descriptor_on(BackendSet backends, Reason (*why_not)(FeatureSet, const VariantTraits&)) {
    return {
        .axis = "precision",
        .name = "double_intersection",
        .summary = "single precision, intersection in double",
        .origin = "numerics.md 4.5: the cheap cure of huge and distant spheres",
        .claim = Claim::statistical,
        .claim_note = "same expectation as precision=float, up to rounding",
        .mean_of = "float",
        .traits = PrecisionTraits{.real_bytes = sizeof(float), .intersects_in_double = true},
        .backends = backends,
        .unsupported_reason = why_not,
    };
}

FeatureSet features() { return no_features | Feature::double_intersection; }

const Registration on_the_cpu(descriptor_on(on_cpu, does_not_apply_on_the_cpu), {.features = features});
const Registration on_the_gpu(descriptor_on(on_cuda, unsupported_reason),
                              {.features = features, .cuda = {.real = "float"}});

}  // namespace
}  // namespace pt::precision::double_intersection
