// The host's side of wavefront.cuh.
#include "variants/cuda/sort_stage.h"
#include "variants/cuda/wavefronts.h"
#include "variants/integrator/wavefront_parameters.cuh"

namespace pt::cuda::integrator::wavefront {
namespace {

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront",
    .summary = "a kernel a stage over a queue of paths: generate, intersect, shade",
    .origin = "Laine, Karras and Aila 2013; cis565",
    .baseline = on_cuda,
    .traits =
        IntegratorTraits{.has_queue = true, .can_loop = true, .seeds_by_position = true, .traces_in_own_kernel = true},
    .backends = on_cuda,
    .tunables = wavefront_tunables,
    .check_counters = wavefront_work_missing,
};

template <class Real>
class StagedWavefront final : public Wavefront {
public:
    StagedWavefront(JobOf<Real>& job, IntegratorNeeds&& needs)
        : Wavefront(job, std::move(needs), sizeof(Real), sizeof(StoredHit<Real>)),
          job_(job),
          sort_stage_(job, this->needs()) {
        if (this->needs().traits.traversal.needs_own_kernel) {
            const int blocks = job.module->blocks_per_multiprocessor(IntersectPathsParameters<Real>::kernel, job.block);
            most_intersecting_threads_ = static_cast<std::uint32_t>(blocks) * job.multiprocessors * job.block;
        }
    }

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<GeneratePathsParameters<Real>>(), kernel_of<IntersectPathsParameters<Real>>(),
                kernel_of<ShadePathsParameters<Real>>(), kernel_of<WriteRayKeysParameters>(false),
                kernel_of<AdvanceParameters>(false)};
    }

private:
    void fill_first_hits() override { fill_cache(job_); }

    void begin(std::uint32_t first_sample) override {
        {
            const Stage stage(job_.stages, "generate", job_.stream);
            job_.launch(queue_.bound,
                        GeneratePathsParameters<Real>{job_.scene, queue_.paths, queue_.count, queue_.bound,
                                                      first_sample, batches().cursor(), job_.cache});
        }
        trace(0);
        end_segment(0);
    }

    void trace(std::uint32_t segment) override {
        const bool sorts = sort_stage_.exists() && !is_last(segment);
        const SortKeyTraits& key = sort_stage_.key();
        const bool by_hit = key.has_material;
        if (sorts && !by_hit) {
            const Stage stage(job_.stages, "sort", job_.stream);
            job_.launch(queue_.bound,
                        WriteRayKeysParameters{queue_.paths, order(), queue_.count, queue_.bound, queue_.keys,
                                               sort_stage_.last_key(queue_), needs().key_bounds});
            sort_stage_.sort(queue_);
        }
        {
            const Stage stage(job_.stages, "intersect", job_.stream);
            std::uint32_t* const keys = sorts && by_hit ? queue_.keys : nullptr;
            job_.launch(intersecting_threads(),
                        IntersectPathsParameters<Real>{job_.scene, queue_.paths, order(), queue_.count, queue_.bound,
                                                       hits(), job_.cache, batches().segment(segment), job_.segments,
                                                       keys, key.bits, sort_stage_.chunk(queue_),
                                                       sort_stage_.last_key(queue_), needs().key_bounds});
        }
        if (sorts && by_hit) {
            const Stage stage(job_.stages, "sort", job_.stream);
            sort_stage_.sort(queue_);
        }
        shade(sorts && by_hit);
    }

    // Threads of the intersection kernel: one a path or, with persistent threads, as many as fit at once.
    std::uint32_t intersecting_threads() const { return std::min(queue_.bound, most_intersecting_threads_); }

    StoredHit<Real>* hits() const { return static_cast<StoredHit<Real>*>(queue_.hits); }

    void shade(bool is_sorted) {
        const Stage stage(job_.stages, "shade", job_.stream);
        for (const ShadeRange& range : sort_stage_.shade_ranges(queue_, is_sorted)) {
            job_.launch(queue_.bound, ShadePathsParameters<Real>{job_.scene, job_.film, queue_.paths, range.order,
                                                                 range.count, hits(), job_.totals});
        }
    }

    JobOf<Real>& job_;
    SortStage sort_stage_;
    std::uint32_t most_intersecting_threads_ = ~0u;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<StagedWavefront>();
    made.stores_hits = true;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront
