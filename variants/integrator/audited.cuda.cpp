// The host's side of audited.cuh.
#include "variants/cuda/megakernels.h"
#include "variants/integrator/audited_parameters.cuh"

namespace pt::cuda::integrator::audited {
namespace {

Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits",
                "looks at every segment: needs first_bounce=off, not " + std::string(variant.first_bounce.name)};
    }
    return megakernel_unsupported_reason(features, variant);
}

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "audited",
    .summary = "megakernel that looks at every path's state between stages; for health, not for times",
    .origin = "Falcor's InvalidPixelDetectionPass",
    .traits = IntegratorTraits{.sums_in_order = true, .inspects = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class Audited final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<AuditedParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch(job.pixels * stride,
                   AuditedParameters<Real>{job.scene, job.film, first_sample, samples, stride, job.health, job.totals});
    }
};

const Registration registration(descriptor, {.cuda = {.integrator = integrator_hook<Audited>()}});

}  // namespace
}  // namespace pt::cuda::integrator::audited
