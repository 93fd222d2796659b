// The host's side of persistent.cuh.
#include "variants/cuda/persistent.h"
#include "variants/cuda/handles.h"
#include "variants/integrator/persistent_parameters.cuh"

namespace pt::cuda::integrator::persistent {
namespace {

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "persistent",
    .summary = "as many warps as fit at once, each taking pieces of the image from a global counter",
    .origin = "Aila and Laine 2009 (persistent threads)",
    .traits = IntegratorTraits{.keeps_branches = true},
    .backends = on_cuda,
    .tunables = persistent_tunables,
    .unsupported_reason = megakernel_unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class Persistent final : public Megakernel<Real> {
public:
    Persistent(JobOf<Real>& job, const IntegratorNeeds& needs)
        : Megakernel<Real>(job),
          blocks_(static_cast<std::uint32_t>(job.module->blocks_per_multiprocessor("persistent", job.block)) *
                  job.multiprocessors),
          samples_per_piece_(needs.tunable("piece")) {}

    static std::vector<KernelSignature> kernels() { return {kernel_of<PersistentParameters<Real>>()}; }

    void reserve(Arena& arena) override { next_piece_ = arena.take<std::uint64_t>(1); }

private:
    std::uint32_t most_samples() const override { return samples_per_persistent_launch(this->job_); }
    void launch(std::uint32_t first_sample, std::uint32_t samples) override {
        JobOf<Real>& job = this->job_;
        clear(next_piece_, sizeof *next_piece_, job.stream);
        job.launch_blocks(blocks_, PersistentParameters<Real>{job.scene, job.film, first_sample, samples, job.cache,
                                                              job.totals, job.lengths(),
                                                              samples_per_strip(job, samples_per_piece_), next_piece_});
    }

    std::uint32_t blocks_;
    std::uint32_t samples_per_piece_;
    std::uint64_t* next_piece_ = nullptr;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<Persistent>();
    made.constants = regeneration_constants;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::persistent
