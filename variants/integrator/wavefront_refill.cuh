// The integrator wavefront_refill: a queue that stays full, as the next path takes the place of one that ends. Refilled
// at once, every kernel finds as many paths alive as there are slots, until none is left to begin. A round has two
// kernels, between which paths can be sorted, and a third where the queue is refilled every few rounds only
// (refill_every). A block that replaces paths first gathers the slots of those that ended, so that its first warps make
// the next camera rays together. The path pool of Laine, Karras and Aila 2013, "Megakernels considered harmful", and of
// Novák, Havran and Dachsbacher 2010, "Path regeneration for interactive path tracing".
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/walkers.h"

namespace pt::cuda {

// The paths of one go (a part of a render) by number: path n is pixel n mod pixels, sample first_sample + n / pixels.
struct PathSupply {
    std::uint32_t* next;  // in device memory: number of the next path to hand out; `total` or more: none is left
    std::uint32_t total;
    std::uint32_t first_sample;
};

// How far the device has come, as it tells the host without being asked: a word in host memory, written when a round
// begins. Upper half: number of rounds before it; lower half: number of paths handed out in them.
struct ProgressReport {
    std::uint64_t* word;
    std::uint32_t round;
};

// Parameters of the kernel that starts path n in slot n, for every slot.
template <class Real>
struct FillQueueParameters {
    static constexpr const char* kernel = "fill_queue";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t* count;
    std::uint32_t slots;
    PathSupply supply;
    HitCache<Real> cache;  // argument of first_path(); empty: the integrator has no first-bounce cache
    StoredHit<Real>* hits;
};

// Parameters of the intersection kernel. With `keys`, it writes the sort key of every position; ended paths get the
// last.
template <class Real>
struct IntersectQueueParameters {
    static constexpr const char* kernel = "intersect_queue";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // slots of paths by queue position; null: slot i is at position i
    std::uint32_t slots;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // number of slots in a chunk of the queue, for sort keys by chunk only
    std::uint32_t last_key;
    KeyBounds bounds;
    PathSupply supply;
    ProgressReport report;
    Totals* totals;
};

// Parameters of the kernel that shades the paths in slots order[0..*count-1]. The next path takes the slot of one that
// ends, unless supply.total is 0: no path is handed out then, and the slot waits for refill_queue.
template <class Real>
struct ShadeAndRefillParameters {
    static constexpr const char* kernel = "shade_and_refill";
    SceneView<Real> scene;
    FilmView film;
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    StoredHit<Real>* hits;
    PathSupply supply;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // counts of paths by their number of segments; null: not counted
    WalkerList walkers;
};

// Parameters of the kernel that takes subsurface walks on by some steps: a path is on its walk for several rounds, in
// which its slot is passed over, and no round waits for a long walk.
template <class Real>
struct WalkOnParameters {
    static constexpr const char* kernel = "walk_on";
    SceneView<Real> scene;
    FilmView film;
    PathStore store;
    StoredHit<Real>* hits;
    WalkerList list;   // list of walks that the kernel takes some steps on
    WalkerList again;  // list that gets the walks which are not over
    PathSupply supply;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;
};

// Parameters of the kernel that starts the next path in every slot whose path has ended.
template <class Real>
struct RefillQueueParameters {
    static constexpr const char* kernel = "refill_queue";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t slots;
    PathSupply supply;
    HitCache<Real> cache;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/hit_keys.cuh"
#include "variants/cuda/device/queue_slots.cuh"
#include "variants/cuda/device/walkers.cuh"

namespace pt::cuda {

// Mark of a slot whose path is on a subsurface walk: this distance in its hit, which no other hit has.
inline constexpr ::Real on_a_walk = -1;

// Whether the path in a slot is on a subsurface walk, so that it is neither traced nor shaded.
__device__ inline bool is_on_a_walk(const ::StoredHit* hits, std::uint32_t slot) {
    if constexpr (walks_apart) {
        return hits[slot].t == on_a_walk;
    } else {
        return false;
    }
}

// Puts the next paths into the slots of the threads whose path has `ended`, or marks the slots as ended where no path
// is left. Every thread of the block must call it.
__device__ inline void refill(const ::Scene& scene, const ::Paths& paths, const PathSupply& supply, bool ended,
                              std::uint32_t slot, const ::HitCache& cache) {
    const Gathered free_slots = gather_by_block(supply.next, ended, slot);
    if (threadIdx.x < free_slots.count) {
        const std::uint32_t number = free_slots.first + threadIdx.x;
        const std::uint32_t free_slot = free_slots.values[threadIdx.x];
        if (number < supply.total) {
            paths.put<carried_fields>(free_slot, path_of_number(scene, number, supply.first_sample, cache));
        } else {
            paths.end(free_slot);
        }
    }
}

}  // namespace pt::cuda

PT_KERNEL(fill_queue, pt::cuda::FillQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t* count, std::uint32_t slots,
           pt::cuda::PathSupply supply, HitCache cache, StoredHit* hits)) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = slots;
        *supply.next = slots;
    }
    if (i < slots) {
        if constexpr (walks_apart) {
            hits[i] = {};
        }
        Paths(store).put<carried_fields>(i, pt::cuda::path_of_number(scene.shade, i, supply.first_sample, cache));
    }
}

PT_KERNEL(intersect_queue, pt::cuda::IntersectQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, const std::uint32_t* order, std::uint32_t slots,
           StoredHit* hits, std::uint32_t* keys, std::uint32_t bits, std::uint32_t chunk, std::uint32_t last_key,
           pt::cuda::KeyBounds bounds, pt::cuda::PathSupply supply, pt::cuda::ProgressReport report, Totals* totals)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *static_cast<volatile std::uint64_t*>(report.word) = std::uint64_t{report.round} << 32 | *supply.next;
    }
    bool alive = false;
    if (i < slots) {
        const std::uint32_t slot = pt::cuda::slot_at(order, i);
        std::uint32_t key = last_key;
        alive = paths.alive(slot) && !pt::cuda::is_on_a_walk(hits, slot);
        if (alive) {
            pt::Ray<Real> ray = paths.ray(slot);
            if constexpr (carried_fields.primitive) {
                ray.primitive = paths.primitive(slot);
            }
            const Hit hit = pt::closest_hit<Configuration>(scene.trace, ray);
            hits[slot] = {hit.t, hit.side};
            if constexpr (carried_fields.primitive) {
                paths.primitive(slot) = hit.primitive;
            }
            if (keys != nullptr) {
                key = pt::cuda::key_of(scene.shade, ray, hit, slot, bits, chunk, bounds);
            }
        }
        if (keys != nullptr) {
            keys[i] = key;
        }
    }
    pt::cuda::add_votes(&pt::cuda::own_copy(totals)->paths.rays, alive);
}

PT_KERNEL(shade_and_refill, pt::cuda::ShadeAndRefillParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, StoredHit* hits, pt::cuda::PathSupply supply, HitCache cache, Totals* totals,
           std::uint64_t* ended, pt::cuda::WalkerList walkers)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t slot = 0;
    bool has_ended = false;
    OwnWalk walk;
    if (i < *count) {
        slot = pt::cuda::slot_at(order, i);
        if (paths.alive(slot) && !pt::cuda::is_on_a_walk(hits, slot)) {
            Path path = load_path(paths, slot, scene.shade);
            const StoredHit stored = hits[slot];
            if (shade<walks_apart>(scene, path, Hit{stored.t, stored.side, path.primitive}, counters, walk)) {
                paths.update<carried_fields>(slot, path);
                if (walks_apart && walk.is_on()) {
                    hits[slot].t = pt::cuda::on_a_walk;
                }
            } else {
                pt::accumulate(film, path);
                counters.paths += 1;
                has_ended = true;
                if (ended != nullptr) {
                    pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
                }
            }
        }
    }
    if (supply.total != 0) {
        pt::cuda::refill(scene.shade, paths, supply, has_ended, slot, cache);
    } else if (has_ended) {
        paths.end(slot);
    }
    if constexpr (walks_apart) {
        pt::cuda::put_walkers(walkers, walk, slot, 0);
    }
    pt::cuda::add_shade_counters(totals, counters);
}

PT_KERNEL(refill_queue, pt::cuda::RefillQueueParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t slots, pt::cuda::PathSupply supply,
           HitCache cache)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    pt::cuda::refill(scene.shade, paths, supply, i < slots && !paths.alive(i), i, cache);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include <algorithm>
#include <atomic>
#include <thread>
#include "variants/cuda/sort_stage.h"
#include "variants/cuda/walks.h"
#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront_refill {
namespace {

constexpr Tunable tunables[] = {
    wavefront_tunables[0],
    wavefront_tunables[1],
    wavefront_tunables[2],
    {"spp_in_flight", 1, 1, 256, 1, "slots of the queue, times the number of pixels"},
    walks_tunable,
    {"walk_steps", 8, 1, 1024, 1, "steps that a walk takes in a round, where walks have a kernel of their own"},
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

// The device's progress, which its kernels write into host memory (ProgressReport). Reading it costs the device
// nothing.
class Progress {
public:
    Progress() : word_(make_pinned_words(2)) {}

    // Resets the progress for the next part of a render ("go"), while nothing in flight writes it.
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
          walkers_(job, this->needs(), job.pixels * batches().samples_in_flight(), WalkOnParameters<Real>::kernel),
          ended_(make_pinned_words(counter_copies * sizeof(Totals) / sizeof(std::uint32_t))) {}

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<FillQueueParameters<Real>>(), kernel_of<IntersectQueueParameters<Real>>(),
                kernel_of<ShadeAndRefillParameters<Real>>(), kernel_of<RefillQueueParameters<Real>>()};
    }

    // Renders in goes, each of as many samples of every pixel as can have their paths and rounds numbered.
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
    // Rounds enqueued ahead of the one that the device has begun, so that the device never waits for the host.
    static constexpr std::uint32_t rounds_ahead = 4;
    // Rounds between two checks of how many paths have ended, once all have begun. A check waits for the device.
    static constexpr std::uint32_t rounds_between_looks = 64;
    // Rounds between two checks where walks take rounds of their own: how many rounds are left is not known then.
    static constexpr std::uint32_t rounds_between_looks_at_walks = 8;
    // Bound on the rounds that a subsurface walk takes between two segments of a path; hardly any walk takes more.
    static constexpr std::uint32_t rounds_of_long_walks = 1024;

    // Samples of a pixel in one go (part of a render), few enough for its rounds to be numbered. A path has its slot
    // for at most longest_path rounds, walks aside, and leaves it empty for fewer than refill_every_. Half of the
    // numbers is left for the last paths.
    std::uint32_t samples_within(std::uint32_t rounds) const {
        const std::uint64_t longest =
            std::uint64_t{job_.longest_path} * (walkers_.are_apart() ? rounds_of_long_walks : 1);
        const std::uint64_t paths_a_slot = rounds / (longest + refill_every_);
        return static_cast<std::uint32_t>(
            std::min<std::uint64_t>(paths_a_slot * batches().samples_in_flight(), most_paths));
    }

    void fill_first_hits() override {}
    void reserve_counts(Arena& arena) override {
        next_ = arena.take<std::uint32_t>(1);
        walkers_.reserve(arena);
    }

    void run(std::uint32_t first_sample, std::uint32_t samples) {
        const std::uint32_t total = job_.pixels * samples;
        start_queue(std::min(total, job_.pixels * batches().samples_in_flight()));
        supply_ = {next_, total, first_sample};
        paths_before_ += total;
        // Waits until the kernels of the previous go, which write the progress, have run.
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        progress_.start();
        begin(first_sample);
        // A path that is begun in one round has its first segment traced in the next.
        std::uint32_t rounds = ~0u;
        for (std::uint32_t round = 0; round < rounds && !is_over(round, rounds); ++round) {
            trace(round);
            job_.work.bounces += 1;
            if (refill_every_ > 1 && rounds == ~0u && (round + 1) % refill_every_ == 0) {
                refill();
            }
            wait_for(round);
            if (rounds == ~0u && progress_.handed_out() >= total) {
                rounds =
                    walkers_.are_apart() ? most_rounds : std::max(round + 1, progress_.rounds() + job_.longest_path);
            }
        }
    }

    void begin(std::uint32_t) override {
        const Stage stage(job_.stages, "generate", job_.stream);
        walkers_.begin();
        job_.launch(queue_.bound, FillQueueParameters<Real>{job_.scene, queue_.paths, queue_.count, queue_.bound,
                                                            supply_, job_.cache, hits()});
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
        const PathSupply at_once = refill_every_ == 1 ? supply_ : none;
        {
            const Stage stage(job_.stages, "shade", job_.stream);
            for (const ShadeRange& range : sort_stage_.shade_ranges(queue_, sort_stage_.exists())) {
                job_.launch(queue_.bound, ShadeAndRefillParameters<Real>{
                                              job_.scene, job_.film, queue_.paths, range.order, range.count, hits(),
                                              at_once, job_.cache, job_.totals, job_.lengths(), walkers_.list()});
            }
        }
        if (walkers_.are_apart()) {
            const Stage stage(job_.stages, "walk", job_.stream);
            job_.launch_blocks(walkers_.blocks(), WalkOnParameters<Real>{job_.scene, job_.film, queue_.paths, hits(),
                                                                         walkers_.list(0), walkers_.list(1), at_once,
                                                                         job_.cache, job_.totals, job_.lengths()});
            walkers_.swap_lists();
        }
    }

    void refill() {
        const Stage stage(job_.stages, "generate", job_.stream);
        job_.launch(queue_.bound,
                    RefillQueueParameters<Real>{job_.scene, queue_.paths, queue_.bound, supply_, job_.cache});
    }

    StoredHit<Real>* hits() const { return static_cast<StoredHit<Real>*>(queue_.hits); }

    // Waits until the device has begun a round that is no more than rounds_ahead before the given one.
    void wait_for(std::uint32_t round) {
        if (progress_.rounds() + rounds_ahead >= round) {
            return;
        }
        job_.work.host_waits += 1;
        while (progress_.rounds() + rounds_ahead < round) {
            std::this_thread::yield();
            const cudaError_t state = cudaStreamQuery(job_.stream);
            if (state != cudaErrorNotReady) {
                PT_CUDA_CHECK(state);  // a failed kernel reports no progress
                return;
            }
        }
    }

    // Whether all paths of the current part of a render ("go") have ended, which may be long before the longest could.
    bool is_over(std::uint32_t round, std::uint32_t rounds) {
        const std::uint32_t between = walkers_.are_apart() ? rounds_between_looks_at_walks : rounds_between_looks;
        if (rounds == ~0u || (rounds - round) % between != 0) {
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
    WalkerLists<Real, 2> walkers_;   // walks of the current round, and walks that go on in the next round
    PinnedWords ended_;              // host's copy of the device's Totals
    std::uint32_t* next_ = nullptr;  // in device memory: number of the next path to hand out
    PathSupply supply_ = {};
    std::uint64_t paths_before_ = 0;  // paths that this cell has begun in all goes, the current one included
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<RefilledWavefront>();
    made.stores_hits = true;
    made.walks = kernel_part<WalkOnParameters>("variants/integrator/wavefront_refill_walks.cuh");
    made.constants = [](const Variant& variant) -> std::vector<KernelConstant> {
        return {walks_constants(variant).front(), {"walk_steps", tunable(variant, "walk_steps", Backend::cuda)}};
    };
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront_refill

#endif
