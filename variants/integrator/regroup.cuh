// The integrator regroup keeps warps full *and* coherent: a block keeps more paths than it has threads, in shared
// memory. Each warp takes 32 of them that do the same next, shade or walk, traces the next segment, and hands them back
// under the kind of what they hit (path_pool.cuh), as shader execution reordering does in hardware. Queues by material:
// Laine, Karras and Aila 2013; regrouping within a block through shared memory: Hoberock et al. 2009.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

template <class Real>
struct RegroupParameters {
    static constexpr const char* kernel = "regroup";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // counts of paths by their number of segments; null: not counted
    std::uint32_t samples_per_piece;
    std::uint64_t* next_piece;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/block_items.cuh"
#include "variants/cuda/device/path_pool.cuh"

// Adds a path that has ended to the film and to its lane's counters.
__device__ inline void end_path(const FilmView& film, Path& path, ThreadCounters& counters, std::uint64_t* ended) {
    pt::accumulate(film, path);
    counters.rays += path.segment - (kernel_config.keeps_first_hits ? 1 : 0);
    counters.paths += 1;
    if (ended != nullptr) {
        pt::atomic_add(&ended[path.segment - 1], std::uint64_t{1});
    }
    path.segment = Path::ended;
}

// Takes subsurface walks on together, each at least one step, until few lanes are on one. Returns whether the lane's
// path lives. Every lane of the warp must call it.
__device__ inline bool walk_on(const SceneViews& scene, Path& path, pt::Walk& walk, bool alive,
                               ThreadCounters& counters) {
    bool walks = alive && walk.is_on();
    do {
        if (walks) {
            alive = pt::walk_on<Configuration>(scene.shade, path, walk, counters);
            walks = alive && walk.is_on();
        }
    } while (__popc(__ballot_sync(pt::cuda::all_lanes, walks)) > static_cast<int>(tuned::walk_until));
    return alive;
}

// Begins a path in each lane that asks for one, as long as there are any. Returns whether the lane got one;
// `is_exhausted`: a lane that got none gets none later. Every lane of the warp must call it.
__device__ inline bool begin_paths(const SceneViews& scene, BlockItems& items, const Pieces& pieces, bool asks,
                                   const HitCache& cache, Path& path, bool& is_exhausted) {
    const unsigned asking = __ballot_sync(pt::cuda::all_lanes, asks);
    const GivenItems given = items.take(pieces, __popc(asking));
    is_exhausted = given.is_exhausted;
    const std::uint32_t rank = pt::cuda::rank_in(asking);
    const std::uint32_t item = given.first + rank;
    if (!asks || rank >= given.count || !given.items.exists(item)) {
        return false;
    }
    path = first_path(scene.shade, pt::cuda::in_image(given.items.place(item), given.items.width),
                      given.items.sample(item), cache);
    return true;
}

PT_KERNEL(regroup, pt::cuda::RegroupParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, std::uint32_t first_sample, std::uint32_t samples,
           HitCache cache, Totals* totals, std::uint64_t* ended, std::uint32_t samples_per_piece,
           std::uint64_t* next_piece)) {
    const SceneViews scene(parameter);
    __shared__ PathPool pool;
    __shared__ BlockItems items;
    items.begin();
    pool.fill();
    const Pieces pieces{pt::cuda::own_pixels(scene.shade),
                        scene.shade.camera.width,
                        first_sample,
                        samples,
                        samples_per_piece,
                        next_piece};
    ThreadCounters counters;
    Path path;
    Hit hit;
    pt::Walk walk;
    std::uint32_t kind = Kinds::nothing;  // kind of the next stage of the lane's path
    Taken taken = pool.exchange(0, kind);
    bool is_taken = true;  // the warp has just taken paths from the pool, and is to load them
    while (!taken.finished) {
        if (is_taken) {
            kind = pt::cuda::lane() < taken.count ? taken.kind : Kinds::nothing;
            if (kind != Kinds::nothing) {
                pool.load(taken.slot, scene.shade, path, hit, walk);
            }
        }
        const bool active = kind == taken.kind;
        const bool was_alive = active && path.alive();
        bool alive = was_alive;
        if (alive && Kinds::is_traced(taken.kind)) {
            injected_cost(scene.shade, hit, path);
            alive = pt::shade<Configuration>(scene.shade, scene.trace, path, hit, counters, walk);
        }
        if constexpr (Kinds::has_walks) {
            if (Kinds::may_walk(taken.kind)) {
                alive = walk_on(scene, path, walk, alive, counters);
            }
        }
        if (was_alive && !alive) {
            end_path(film, path, counters, ended);
            kind = Kinds::over;
        }
        pt::cuda::add_if_many(totals, counters);
        if (taken.kind == Kinds::over) {
            bool is_exhausted = false;
            alive = begin_paths(scene, items, pieces, active && !alive, cache, path, is_exhausted) || alive;
            kind = active && is_exhausted ? Kinds::retired : kind;
        }
        if (alive && Kinds::has_walks && walk.is_on()) {
            kind = Kinds::walking;
        } else if (alive && Kinds::may_walk(taken.kind)) {
            kind = Kinds::starting;  // the ray waits to be traced with others: few paths leave a body at a time
        } else if (alive) {
            const bool is_kept = kernel_config.keeps_first_hits && path.segment == 0;
            hit = is_kept ? first_hit(scene, path, cache) : trace(scene, path);
            path.primitive = hit.primitive;
            kind = Kinds::of(scene.shade, path, hit);
        }
        // A warp keeps its paths, and saves the exchange, if most of its lanes need the same kind of stage again.
        const unsigned staying = __ballot_sync(pt::cuda::all_lanes, kind == taken.kind);
        is_taken = __popc(staying) < static_cast<int>(tuned::stay_at);
        if (is_taken) {
            if (kind < Kinds::lists) {
                pool.store(taken.slot, path, hit, walk);
            }
            taken = pool.exchange(taken.slot, kind);
        }
    }
    pt::cuda::add_counters(totals, counters, kernel_config.keeps_first_hits ? counters.paths : 0);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/persistent.h"
#include "variants/cuda/runtime/handles.h"

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

#endif
