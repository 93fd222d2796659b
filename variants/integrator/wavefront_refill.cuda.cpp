// The host's side of wavefront_refill.cuh.
#include <algorithm>
#include <atomic>
#include <thread>

#include "variants/cuda/sort_stage.h"
#include "variants/cuda/wavefronts.h"
#include "variants/integrator/wavefront_refill_parameters.cuh"

namespace pt::cuda::integrator::wavefront_refill {
namespace {

constexpr Tunable tunables[] = {wavefront_tunables[0],
                                wavefront_tunables[1],
                                wavefront_tunables[2],
                                {"spp_in_flight", 1, 1, 256, 1, "slots of the queue, times the number of pixels"},
                                {"refill_every", 1, 1, 64, 1,
                                 "rounds between two refills: 1: shading refills, in its own kernel; more: a kernel "
                                 "of its own does, and until then the slots of paths that end stay empty"}};

Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (variant.compaction.compacts) {
        return {"nothing_to_compact",
                "replaces paths that end: needs compaction=none, not " + std::string(variant.compaction.name)};
    }
    if (variant.first_bounce.keeps_hits) {
        return {"no_first_hits", "traces camera rays among others: needs first_bounce=off, not " +
                                     std::string(variant.first_bounce.name)};
    }
    if (variant.launch.is_captured) {
        return {"unknown_rounds", "ends when the device says so, nothing to capture: needs launch=stream, not " +
                                      std::string(variant.launch.name)};
    }
    if (variant.sorting.sorts && !variant.sort_key.has_material) {
        return {"sorts_by_hit",
                "sorts paths once they have met something: needs a key with the material, not "
                "sort_key=" +
                    std::string(variant.sort_key.name)};
    }
    return {};
}

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront_refill",
    .summary = "a kernel a stage over a queue that stays full: the next path takes the place of one that ends",
    .origin = "Laine, Karras and Aila 2013; Novak, Havran and Dachsbacher 2010",
    .traits = IntegratorTraits{.has_queue = true, .refills_queue = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = wavefront_work_missing,
};

// The device's progress, which its kernels write into the host's memory (ProgressReport). Reading it costs the device
// nothing.
class Progress {
public:
    Progress() : word_(make_pinned_words(2)) {}

    // Sets the progress to 0 before a go, with nothing in flight that writes it.
    void start() { value().store(0, std::memory_order_relaxed); }
    std::uint64_t* word() const { return reinterpret_cast<std::uint64_t*>(word_.get()); }
    std::uint32_t rounds() const { return static_cast<std::uint32_t>(read() >> 32); }
    std::uint32_t handed_out() const { return static_cast<std::uint32_t>(read()); }

private:
    std::uint64_t read() const { return value().load(std::memory_order_relaxed); }
    std::atomic_ref<std::uint64_t> value() const { return std::atomic_ref<std::uint64_t>(*word()); }

    PinnedWords word_;
};

template <class Real>
class RefilledWavefront final : public Wavefront {
public:
    RefilledWavefront(JobOf<Real>& job, IntegratorNeeds&& needs)
        : Wavefront(job, std::move(needs), sizeof(Real), sizeof(StoredHit<Real>)),
          job_(job),
          sort_stage_(job, this->needs()),
          refill_every_(this->needs().tunable("refill_every")),
          ended_(make_pinned_words(counter_copies * sizeof(Totals) / sizeof(std::uint32_t))) {}

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<FillQueueParameters<Real>>(), kernel_of<IntersectQueueParameters<Real>>(),
                kernel_of<ShadeAndRefillParameters<Real>>(), kernel_of<RefillQueueParameters<Real>>()};
    }

    // Renders in goes, each of so many samples of every pixel that its paths and its rounds can be numbered.
    void render() override {
        const std::uint32_t most = std::max(1u, std::min(most_paths / job_.pixels, samples_within(most_rounds)));
        for (std::uint32_t done = 0; done < job_.samples;) {
            const std::uint32_t samples = std::min(most, job_.samples - done);
            run(job_.first_sample + done, samples);
            done += samples;
        }
    }

private:
    static constexpr std::uint32_t most_paths = 1u << 30;
    static constexpr std::uint32_t most_rounds = 1u << 31;
    // Rounds enqueued beyond what the device has begun: enough that it never waits for the host.
    static constexpr std::uint32_t rounds_ahead = 4;
    // Rounds between two looks at how many paths have ended, once all have begun. A look waits for the device.
    static constexpr std::uint32_t rounds_between_looks = 64;

    // A path has its slot for at most longest_path rounds and leaves it empty for fewer than refill_every_. The rounds
    // of the last paths have room in the other half of the 32 bits.
    std::uint32_t samples_within(std::uint32_t rounds) const {
        const std::uint64_t paths_a_slot = rounds / (std::uint64_t{job_.longest_path} + refill_every_);
        return static_cast<std::uint32_t>(
            std::min<std::uint64_t>(paths_a_slot * batches().samples_in_flight(), most_paths));
    }

    void fill_first_hits() override {}
    void reserve_counts(Arena& arena) override { next_ = arena.take<std::uint32_t>(1); }

    void run(std::uint32_t first_sample, std::uint32_t samples) {
        const std::uint32_t total = job_.pixels * samples;
        start_queue(std::min(total, job_.pixels * batches().samples_in_flight()));
        supply_ = {next_, total, first_sample};
        paths_before_ += total;
        // The kernels of the go before have run: its end was seen, or all that it had enqueued is waited for.
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        progress_.start();
        begin(first_sample);
        // A path that is handed out in a round has its first segment in the next.
        std::uint32_t rounds = ~0u;
        for (std::uint32_t round = 0; round < rounds && !is_over(round, rounds); ++round) {
            trace(round);
            job_.work.bounces += 1;
            if (refill_every_ > 1 && rounds == ~0u && (round + 1) % refill_every_ == 0) {
                refill();
            }
            wait_for(round);
            if (rounds == ~0u && progress_.handed_out() >= total) {
                rounds = std::max(round + 1, progress_.rounds() + job_.longest_path);
            }
        }
    }

    void begin(std::uint32_t) override {
        const Stage stage(job_.stages, "generate", job_.stream);
        job_.launch(queue_.bound, FillQueueParameters<Real>{job_.scene, queue_.paths, queue_.count, queue_.bound,
                                                            supply_, job_.cache});
    }

    void trace(std::uint32_t round) override {
        {
            const Stage stage(job_.stages, "intersect", job_.stream);
            job_.launch(queue_.bound, IntersectQueueParameters<Real>{
                                          job_.scene, queue_.paths, order(), queue_.bound, hits(),
                                          sort_stage_.exists() ? queue_.keys : nullptr, sort_stage_.key().bits,
                                          sort_stage_.chunk(queue_), sort_stage_.last_key(queue_), needs().key_bounds,
                                          supply_, ProgressReport{progress_.word(), round}, job_.totals});
        }
        if (sort_stage_.exists()) {
            const Stage stage(job_.stages, "sort", job_.stream);
            sort_stage_.sort(queue_);
        }
        const PathSupply none = {};
        const Stage stage(job_.stages, "shade", job_.stream);
        for (const ShadeRange& range : sort_stage_.shade_ranges(queue_, sort_stage_.exists())) {
            job_.launch(queue_.bound,
                        ShadeAndRefillParameters<Real>{job_.scene, job_.film, queue_.paths, range.order, range.count,
                                                       hits(), refill_every_ == 1 ? supply_ : none, job_.cache,
                                                       job_.totals, job_.lengths()});
        }
    }

    void refill() {
        const Stage stage(job_.stages, "generate", job_.stream);
        job_.launch(queue_.bound,
                    RefillQueueParameters<Real>{job_.scene, queue_.paths, queue_.bound, supply_, job_.cache});
    }

    StoredHit<Real>* hits() const { return static_cast<StoredHit<Real>*>(queue_.hits); }

    // Waits until the device has begun a round not long before this one.
    void wait_for(std::uint32_t round) {
        if (progress_.rounds() + rounds_ahead >= round) {
            return;
        }
        job_.work.host_waits += 1;
        while (progress_.rounds() + rounds_ahead < round) {
            std::this_thread::yield();
            const cudaError_t state = cudaStreamQuery(job_.stream);
            if (state != cudaErrorNotReady) {
                PT_CUDA_CHECK(state);  // a kernel that failed reports nothing more
                return;
            }
        }
    }

    // Whether all paths have ended, which may be long before the longest path that there could be.
    bool is_over(std::uint32_t round, std::uint32_t rounds) {
        if (rounds == ~0u || (rounds - round) % rounds_between_looks != 0) {
            return false;
        }
        PT_CUDA_CHECK(cudaMemcpyAsync(ended_.get(), job_.totals, counter_copies * sizeof(Totals),
                                      cudaMemcpyDeviceToHost, job_.stream));
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        job_.work.host_waits += 1;
        const Totals* const copies = reinterpret_cast<const Totals*>(ended_.get());
        std::uint64_t ended = 0;
        for (std::uint32_t copy = 0; copy < counter_copies; ++copy) {
            ended += copies[copy].paths.paths;
        }
        return ended == paths_before_;
    }

    JobOf<Real>& job_;
    SortStage sort_stage_;
    Progress progress_;
    std::uint32_t refill_every_;
    PinnedWords ended_;              // Totals, copied
    std::uint32_t* next_ = nullptr;  // device: PathSupply::next
    PathSupply supply_ = {};
    std::uint64_t paths_before_ = 0;  // that this cell has begun, with the go that runs
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<RefilledWavefront>();
    made.stores_hits = true;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront_refill
