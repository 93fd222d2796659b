// Single precision, but for intersection and the points that it gives (kernels/widen.h). On the CPU for the plainest
// kernel only.
#include "variants/registry.h"

namespace pt {
namespace {

std::string unsupported_reason(FeatureSet, const Variant& variant) {
    if (variant["specialisation"] == "matrix") {
        return "has its own intersection: needs another specialisation than matrix";
    }
    if (variant["sampler"] != "pcg4d") {
        return "is compiled with sampler=pcg4d only";
    }
    return "";
}

std::string does_not_apply_on_the_cpu(FeatureSet scene, const Variant& variant) {
    if (variant["integrator"] != "depth_first" && variant["integrator"] != "audited") {
        return "is compiled for a path at a time: needs integrator=depth_first, not " + variant["integrator"];
    }
    return unsupported_reason(scene, variant);
}

constexpr Descriptor descriptor_on(BackendSet backends, std::string (*why_not)(FeatureSet, const Variant&)) {
    return {
        .axis = "precision",
        .name = "double_intersection",
        .summary = "single precision, intersection in double",
        .origin = "numerics.md 4.5: the cheap cure of huge and distant spheres",
        .claim = Claim::statistical,
        .claim_note = "same expectation as precision=float, up to rounding",
        .mean_of = "float",
        .backends = backends,
        .unsupported_reason = why_not,
    };
}

FeatureSet features() { return no_features | Feature::double_intersection; }

const Registration on_the_cpu(descriptor_on(on_cpu, does_not_apply_on_the_cpu), {.features = features});
const Registration on_the_gpu(descriptor_on(on_cuda, unsupported_reason),
                              {.features = features, .cuda = {.real = "float", .real_bytes = 4}});

}  // namespace
}  // namespace pt
