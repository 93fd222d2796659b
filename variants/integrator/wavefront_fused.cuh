// The integrator wavefront_fused: one kernel a bounce over a queue of paths. Each thread traces and shades one segment
// of one path, and with compaction=atomic_append or block_scan_append puts a path that lives into the next bounce's
// queue itself. The kernel of the first bounce makes its camera rays, too.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/walkers.h"

namespace pt::cuda {

// Parameters of the kernel that starts path i (pixel i mod pixels, sample first_sample + i / pixels) and traces its
// first bounce; if `cursor` is not null, the first sample is read from it.
template <class Real>
struct FirstBounceParameters {
    static constexpr const char* kernel = "first_bounce";
    SceneView<Real> scene;
    FilmView film;
    PathStore out;
    std::uint32_t* out_count;
    std::uint32_t pool;
    std::uint32_t first_sample;
    const std::uint32_t* cursor;
    HitCache<Real> cache;
    Totals* totals;
    SegmentCounts segments;
    PathStore waiting;  // store of paths on a subsurface walk: slot i has path i
    WalkerList walkers;
};

// Parameters of the kernel for one bounce of the paths of `in` at order[0..*in_count-1] (no order: at 0..*in_count-1;
// where the kernel appends: where `locate` finds them).
template <class Real>
struct NextBounceParameters {
    static constexpr const char* kernel = "next_bounce";
    SceneView<Real> scene;
    FilmView film;
    PathStore in;
    const std::uint32_t* order;
    const std::uint32_t* in_count;
    PathStore out;
    std::uint32_t* out_count;
    SegmentNumber segment;
    Totals* totals;
    SegmentCounts segments;
    WalkerList walkers;  // list of walks that begin; their paths lie in `in`
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/advance.cuh"
#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/append_in_kernel.h"
#include "variants/cuda/device/queue_slots.cuh"
#include "variants/cuda/device/walkers.cuh"

// Paths stay in their slots unless the kernel appends. The queue then has tuned::append_counters parts, each with a
// counter of its own, since an append to one counter waits for all others: a GPU does a few hundred million atomic
// operations a second on one address. Block b appends to part b mod append_counters, which therefore never holds more
// than its share of the blocks.
using pt::cuda::counter_stride;
constexpr auto append_in_kernel = static_cast<pt::AppendInKernel>(tuned::append_in_kernel);
constexpr bool appends = append_in_kernel != pt::AppendInKernel::no;

__device__ inline std::uint32_t part_capacity(const PathStore& store) {
    return store.capacity / tuned::append_counters;
}

// The part of the queue to which the thread block's paths are appended.
__device__ inline std::uint32_t own_part() { return blockIdx.x % tuned::append_counters; }

// The number of paths in a queue, and the slot of the path at `position`, by locate(). Every thread of the block must
// call locate().
struct Located {
    std::uint32_t total, slot;
};
__device__ inline Located locate(const PathStore& store, const std::uint32_t* counts, std::uint32_t position) {
    __shared__ std::uint32_t part_count[tuned::append_counters];
    for (std::uint32_t part = threadIdx.x; part < tuned::append_counters; part += kernel_config.block) {
        part_count[part] = counts[part * counter_stride];
    }
    __syncthreads();
    Located located{0, 0};
    for (std::uint32_t part = 0; part < tuned::append_counters; ++part) {
        const std::uint32_t before = located.total;
        located.total += part_count[part];
        if (position >= before && position < located.total) {
            located.slot = part * part_capacity(store) + (position - before);
        }
    }
    return located;
}

// Puts a path where the next bounce finds it. `is_new`: its slot is empty. Every thread of the block must call it.
template <bool is_new>
__device__ inline void put_path(const Path& path, bool shaded, bool alive, std::uint32_t slot, const PathStore& out,
                                std::uint32_t* out_count) {
    const Paths paths(out);
    if constexpr (appends) {
        const std::uint32_t part = own_part();
        std::uint32_t* const count = out_count + part * counter_stride;
        std::uint32_t position = 0;
        if constexpr (append_in_kernel == pt::AppendInKernel::by_warp) {
            position = pt::cuda::append_by_warp(count, alive);
        } else {
            position = pt::cuda::append_by_block(count, alive);
        }
        if (alive) {
            paths.put<carried_fields>(part * part_capacity(out) + position, path);
        }
    } else if (alive && is_new) {
        paths.put<carried_fields>(slot, path);
    } else if (alive) {
        paths.update<carried_fields>(slot, path);
    } else if (shaded && is_new) {
        Path ended = path;
        ended.segment = Path::ended;
        paths.put<carried_fields>(slot, ended);
    } else if (shaded) {
        paths.end(slot);
    }
}

// Puts a path that is on a walk into the list of walkers and, where the kernel appends, the path itself into its slot
// of `waiting`. Every lane of the warp must call it.
__device__ inline void put_walker(const pt::cuda::WalkerList& walkers, const OwnWalk& walk, const Path& path,
                                  const PathStore& waiting, std::uint32_t slot) {
    if (appends && walk.is_on()) {
        Paths(waiting).put<carried_fields>(slot, path);
    }
    pt::cuda::put_walkers(walkers, walk, slot, own_part());
}

// Shades the hit of one segment, and adds a path that ends to the film. Returns whether the path lives.
__device__ inline bool bounce(const SceneViews& scene, const FilmView& film, Path& path, const Hit& hit,
                              ThreadCounters& counters, OwnWalk& walk) {
    if (shade<walks_apart>(scene, path, hit, counters, walk)) {
        return true;
    }
    pt::accumulate(film, path);
    counters.paths += 1;
    return false;
}

PT_KERNEL(first_bounce, pt::cuda::FirstBounceParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore out, std::uint32_t* out_count,
           std::uint32_t pool, std::uint32_t first_sample, const std::uint32_t* cursor, HitCache cache, Totals* totals,
           SegmentCounts segments, PathStore waiting, pt::cuda::WalkerList walkers)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    OwnWalk walk;
    const std::uint32_t i = pt::cuda::thread_number();
    const bool mine = i < pool;
    bool alive = false;
    Path path;
    if (mine) {
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        path = pt::cuda::path_of_number(scene.shade, i, first, cache);
        alive = bounce(scene, film, path, first_hit(scene, path, cache), counters, walk);
    }
    if constexpr (walks_apart) {
        put_walker(walkers, walk, path, waiting, i);
        alive = alive && !(appends && walk.is_on());
    }
    put_path<true>(path, mine, alive, i, out, out_count);
    if constexpr (!appends) {
        if (i == 0) {
            *out_count = pool;
        }
    }
    pt::cuda::add_segment_counts(segments, 0, mine, pool);
    pt::cuda::add_shade_counters(totals, counters);
}

PT_KERNEL(next_bounce, pt::cuda::NextBounceParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore in, const std::uint32_t* order,
           const std::uint32_t* in_count, PathStore out, std::uint32_t* out_count, SegmentNumber segment,
           Totals* totals, SegmentCounts segments, pt::cuda::WalkerList walkers)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    OwnWalk walk;
    const std::uint32_t i = pt::cuda::thread_number();
    bool live = false;
    bool alive = false;
    Path path;
    std::uint32_t in_play, slot;
    if constexpr (appends) {
        in_count += segment.passed() * tuned::append_counters * counter_stride;
        out_count += segment.passed() * tuned::append_counters * counter_stride;
        const Located located = locate(in, in_count, i);
        in_play = located.total;
        slot = located.slot;
    } else {
        in_play = *in_count;
        slot = i < in_play ? pt::cuda::slot_at(order, i) : i;
    }
    if (i < in_play) {
        live = Paths(in).alive(slot);
        if (live) {
            path = load_path(Paths(in), slot, scene.shade);
            alive = bounce(scene, film, path, trace(scene, path), counters, walk);
        }
    }
    if constexpr (walks_apart) {
        put_walker(walkers, walk, path, in, slot);
        alive = alive && !(appends && walk.is_on());
    }
    put_path<false>(path, live, alive, slot, out, out_count);
    pt::cuda::add_segment_counts(segments, segment, live, in_play);
    pt::cuda::add_shade_counters(totals, counters);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/walks.h"
#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront_fused {
namespace {

constexpr Tunable tunables[] = {
    wavefront_tunables[0],
    wavefront_tunables[1],
    wavefront_tunables[2],
    wavefront_tunables[3],
    wavefront_tunables[4],
    walks_tunable,
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
          counters_(Wavefront::needs().tunable("append_counters")),
          walks_(job, Wavefront::needs(), job.pixels * batches().samples_in_flight(), counters_) {}

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
        walks_.reserve(arena);
    }

    void begin(std::uint32_t first_sample) override {
        if (appends_) {
            // Counters of all segments are cleared at once: clearing them between two bounces would cost a gap each
            // time.
            clear(counts_, words_per_segment() * job_.longest_path * sizeof(std::uint32_t), job_.stream);
            queue_.count = counts_after(0);
        }
        walks_.begin();
        const PathStore waiting = appends_ ? queue_.spare : queue_.paths;
        {
            const Stage stage(job_.stages, "first bounce", job_.stream);
            job_.launch(queue_.bound,
                        FirstBounceParameters<Real>{job_.scene, job_.film, queue_.paths, queue_.count, queue_.bound,
                                                    first_sample, batches().cursor(), job_.cache, job_.totals,
                                                    job_.segments, waiting, walks_.list()});
        }
        take_walks(waiting, queue_.paths, queue_.count, {});
        end_segment(0);
    }

    void trace(std::uint32_t segment) override {
        if (appends_) {
            queue_.count = counts_after(segment - 1);  // live paths after the segment before, also in a graph's loop
        }
        const PathStore out = appends_ ? queue_.spare : queue_.paths;
        std::uint32_t* const out_count = appends_ ? counts_after(segment) : queue_.count;
        {
            const Stage stage(job_.stages, "bounce", job_.stream);
            job_.launch(queue_.bound, NextBounceParameters<Real>{
                                          job_.scene, job_.film, queue_.paths, order(), queue_.count, out, out_count,
                                          batches().segment(segment), job_.totals, job_.segments, walks_.list()});
        }
        take_walks(queue_.paths, out, out_count, batches().segment(segment));
        if (appends_) {
            queue_.swap_paths();
            queue_.count = out_count;
        }
    }

    void take_walks(const PathStore& in, const PathStore& out, std::uint32_t* out_count, const SegmentNumber& segment) {
        if (appends_) {
            walks_.take_to(in, out, out_count, segment);
        } else {
            walks_.take_in_place(in);
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
    // The device's counters of the paths that live after a segment (one per part of the queue).
    std::uint32_t* counts_after(std::uint32_t segment) const { return counts_ + segment * words_per_segment(); }

    JobOf<Real>& job_;
    std::uint32_t counters_;           // number of the queue's parts, if the kernel appends
    std::uint32_t* counts_ = nullptr;  // in device memory: counters of live paths after every segment
    Walks<Real> walks_;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<FusedWavefront>();
    made.constants = [](const Variant& variant) -> std::vector<KernelConstant> {
        const AppendInKernel append = traits_of(variant, Backend::cuda).compaction.append_in_kernel;
        return {{"append_in_kernel", static_cast<std::uint32_t>(append)},
                {"append_counters", tunable(variant, "append_counters", Backend::cuda)},
                walks_constants(variant).front()};
    };
    made.walks = walk_paths_part;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront_fused

#endif
