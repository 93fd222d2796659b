// The host's side of megakernel_regen.cuh.
#include "variants/cuda/megakernels.h"
#include "variants/integrator/megakernel_regen_parameters.cuh"

namespace pt::cuda::integrator::megakernel_regen {
namespace {

constexpr Tunable tunables[] = {megakernel_tunables[0], megakernel_tunables[1], megakernel_tunables[2],
                                megakernel_tunables[3], regeneration_tunable};

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "megakernel_regen",
    .summary =
        "one kernel, a warp a strip of pixels; a lane whose path ended takes one that waits; full warps begin paths",
    .origin = "Novák, Havran and Dachsbacher 2010 (path regeneration)",
    .traits = IntegratorTraits{.keeps_branches = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class MegakernelRegen final : public StridedMegakernel<Real> {
public:
    using StridedMegakernel<Real>::StridedMegakernel;
    static std::vector<KernelSignature> kernels() { return {kernel_of<MegakernelRegenParameters<Real>>()}; }

private:
    void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) override {
        JobOf<Real>& job = this->job_;
        job.launch((job.pixels + warp_size - 1) / warp_size * warp_size * stride,
                   MegakernelRegenParameters<Real>{job.scene, job.film, first_sample, samples, stride, job.cache,
                                                   job.totals, job.lengths()});
    }
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<MegakernelRegen>();
    made.constants = regeneration_constants;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::megakernel_regen
