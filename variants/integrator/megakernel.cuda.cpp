// The host's side of megakernel.cuh.
#include "variants/cuda/megakernels.h"
#include "variants/integrator/megakernel_parameters.cuh"

namespace pt::cuda::integrator::megakernel {
namespace {

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel",
    .summary = "one kernel, a thread a pixel, a path at a time, state in registers",
    .origin = "Aila and Laine 2009 for the shape",
    .reference = on_cuda,
    .traits = IntegratorTraits{.sums_in_order = true, .keeps_branches = true},
    .backends = on_cuda,
    .tunables = megakernel_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class PlainMegakernel final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<MegakernelParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch(job.pixels * stride, MegakernelParameters<Real>{job.scene, job.film, first_sample, samples, stride,
                                                                   job.cache, job.totals, job.lengths()});
    }
};

const Registration registration(descriptor, {.cuda = {.integrator = integrator_hook<PlainMegakernel>()}});

}  // namespace
}  // namespace pt::cuda::integrator::megakernel
