// The host's side of wavefront_fused.cuh.
#include "variants/cuda/wavefronts.h"
#include "variants/integrator/wavefront_fused_parameters.cuh"

namespace pt::cuda::integrator::wavefront_fused {
namespace {

constexpr Tunable tunables[] = {
    wavefront_tunables[0],
    wavefront_tunables[1],
    wavefront_tunables[2],
    wavefront_tunables[3],
    wavefront_tunables[4],
    {"append_counters", 16, 1, 64, 1, "parts of the queue, with a counter each, where the kernel appends"}};

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront_fused",
    .summary = "one kernel a bounce over a queue of paths; appending compactions are part of it",
    .origin = "pbrt-v4's and Cycles' queues, taken to one kernel",
    .traits = IntegratorTraits{.has_queue = true, .can_loop = true, .appends_in_kernel = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        if (!variant.sorting.sorts) {
            return {};
        }
        return {"no_point_to_sort",
                "intersects and shades in one kernel, there is no point at which to sort: needs sorting=none, not " +
                    std::string(variant.sorting.name)};
    },
    .check_counters = wavefront_work_missing,
};

template <class Real>
class FusedWavefront final : public Wavefront {
public:
    FusedWavefront(JobOf<Real>& job, IntegratorNeeds&& needs)
        : Wavefront(job, std::move(needs), sizeof(Real), 0),
          job_(job),
          counters_(Wavefront::needs().tunable("append_counters")) {}

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<FirstBounceParameters<Real>>(), kernel_of<NextBounceParameters<Real>>(),
                kernel_of<AdvanceParameters>(false)};
    }

private:
    void fill_first_hits() override { fill_cache(job_); }
    std::uint32_t parts() const override { return appends_ ? counters_ : 1; }
    void reserve_counts(Arena& arena) override {
        if (appends_) {
            counts_ = arena.take<std::uint32_t>(words_per_segment() * job_.longest_path);
        }
    }

    void begin(std::uint32_t first_sample) override {
        if (appends_) {
            // Counters for every segment, all cleared at once: clearing between two bounces would cost a gap each time.
            clear(counts_, words_per_segment() * job_.longest_path * sizeof(std::uint32_t), job_.stream);
            queue_.count = counts_after(0);
        }
        {
            const Stage stage(job_.stages, "first bounce", job_.stream);
            job_.launch(queue_.bound, FirstBounceParameters<Real>{job_.scene, job_.film, queue_.paths, queue_.count,
                                                                  queue_.bound, first_sample, batches().cursor(),
                                                                  job_.cache, job_.totals, job_.segments});
        }
        end_segment(0);
    }

    void trace(std::uint32_t segment) override {
        if (appends_) {
            queue_.count = counts_after(segment - 1);  // of the segment before, also of one that a loop took
        }
        const PathStore out = appends_ ? queue_.spare : queue_.paths;
        std::uint32_t* const out_count = appends_ ? counts_after(segment) : queue_.count;
        {
            const Stage stage(job_.stages, "bounce", job_.stream);
            job_.launch(queue_.bound,
                        NextBounceParameters<Real>{job_.scene, job_.film, queue_.paths, order(), queue_.count, out,
                                                   out_count, batches().segment(segment), job_.totals, job_.segments});
        }
        if (appends_) {
            queue_.swap_paths();
            queue_.count = out_count;
        }
    }

    LiveCounts end_round(const Queue& before) override {
        if (!appends_) {
            return Wavefront::end_round(before);
        }
        const std::uint32_t* const counts = queue_.count;
        queue_.count = before.count;
        return {counts, counters_, counter_stride, static_cast<std::uint32_t>(words_per_segment())};
    }

    std::size_t words_per_segment() const { return std::size_t{counters_} * counter_stride; }
    // The device's counters of the paths that live after a segment.
    std::uint32_t* counts_after(std::uint32_t segment) const { return counts_ + segment * words_per_segment(); }

    JobOf<Real>& job_;
    std::uint32_t counters_;           // parts of the queue where the kernel appends
    std::uint32_t* counts_ = nullptr;  // device: of every segment
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<FusedWavefront>();
    made.constants = [](const Variant& variant) -> std::vector<KernelConstant> {
        const AppendInKernel append = traits_of(variant, Backend::cuda).compaction.append_in_kernel;
        return {{"append_in_kernel", static_cast<std::uint32_t>(append)},
                {"append_counters", tunable(variant, "append_counters", Backend::cuda)}};
    };
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront_fused
