// The host's side of regroup.cuh.
#include "variants/cuda/handles.h"
#include "variants/cuda/persistent.h"
#include "variants/integrator/regroup_parameters.cuh"

namespace pt::cuda::integrator::regroup {
namespace {

constexpr Tunable min_blocks = [] {
    Tunable bound = min_blocks_tunable;
    bound.default_value = 4;
    bound.generic_value = 0;
    return bound;
}();

constexpr Tunable tunables[] = {
    {"block", 256, 32, 1024, 32, "threads a block"},
    shading_tunable,
    min_blocks,
    piece_tunable,
    {"pool", 0, 0, 4096, 32, "paths a block, as far as 48 KiB hold them; 0: as many as keep every warp full"},
    {"walk_until", 16, 0, 31, 1, "walks within bodies are taken on together until no more lanes than this walk"},
    {"stay_at", 24, 1, 33, 1, "a warp goes on with its paths while at least so many do the same again; 33: never"},
    {"by_material", 1, 0, 1, 1, "1: paths to be shaded are grouped by the type of material; 0: not"}};

Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (!variant.traversal_stack.is_in_thread) {
        return {"no_shared_memory_left", "keeps its paths in shared memory: needs traversal_stack=local, not " +
                                             std::string(variant.traversal_stack.name)};
    }
    if (!variant.subsurface_sampling.is_classical) {
        return {"keeps_plain_walks",
                "keeps no guide of a walk with its paths: needs subsurface_sampling=classical, not " +
                    std::string(variant.subsurface_sampling.name)};
    }
    return megakernel_unsupported_reason(features, variant);
}

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "regroup",
    .summary = "persistent warps; each takes paths of its block that meet one material, from shared memory",
    .origin = "Hoberock et al. 2009; Laine, Karras and Aila 2013 (regrouping by material)",
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = megakernel_work_missing,
};

template <class Real>
class Regroup final : public Megakernel<Real> {
public:
    Regroup(JobOf<Real>& job, const IntegratorNeeds& needs)
        : Megakernel<Real>(job),
          blocks_(static_cast<std::uint32_t>(job.module->blocks_per_multiprocessor("regroup", job.block)) *
                  job.multiprocessors),
          samples_per_piece_(needs.tunable("piece")) {}

    static std::vector<KernelSignature> kernels() { return {kernel_of<RegroupParameters<Real>>()}; }

    void reserve(Arena& arena) override { next_piece_ = arena.take<std::uint64_t>(1); }

private:
    std::uint32_t most_samples() const override { return samples_per_persistent_launch(this->job_); }
    void launch(std::uint32_t first_sample, std::uint32_t samples) override {
        JobOf<Real>& job = this->job_;
        clear(next_piece_, sizeof *next_piece_, job.stream);
        job.launch_blocks(
            blocks_, RegroupParameters<Real>{job.scene, job.film, first_sample, samples, job.cache, job.totals,
                                             job.lengths(), samples_per_strip(job, samples_per_piece_), next_piece_});
    }

    std::uint32_t blocks_;
    std::uint32_t samples_per_piece_;
    std::uint64_t* next_piece_ = nullptr;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<Regroup>();
    made.constants = [](const Variant& variant) -> std::vector<KernelConstant> {
        return {{"pool", tunable(variant, "pool", Backend::cuda)},
                {"walk_until", tunable(variant, "walk_until", Backend::cuda)},
                {"stay_at", tunable(variant, "stay_at", Backend::cuda)},
                {"by_material", tunable(variant, "by_material", Backend::cuda)}};
    };
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::regroup
