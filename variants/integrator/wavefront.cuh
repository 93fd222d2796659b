// The integrator wavefront on CUDA: stage by stage over a queue of paths, a kernel each: generate, intersect, (sort),
// shade, (compact). The shape of cis565, and of Laine, Karras and Aila 2013, "Megakernels considered harmful".
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/mesh_queue.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/walkers.h"

namespace pt::cuda {

// Parameters of the kernel that starts path i in slot i: pixel i mod pixels, sample first_sample + i / pixels; if
// `cursor` is not null, the first sample is read from it.
template <class Real>
struct GeneratePathsParameters {
    static constexpr const char* kernel = "generate_paths";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t* count;
    std::uint32_t pool;
    std::uint32_t first_sample;
    const std::uint32_t* cursor;
    HitCache<Real> cache;
};

// Parameters of the intersection kernel. With `keys`, it also writes the sort key of every position below `bound`;
// ended paths and positions beyond the count get the last key.
template <class Real>
struct IntersectPathsParameters {
    static constexpr const char* kernel = "intersect_paths";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // slots of paths by queue position; null: slot i is at position i
    const std::uint32_t* count;
    std::uint32_t bound;
    StoredHit<Real>* hits;
    HitCache<Real> cache;
    SegmentNumber segment;
    SegmentCounts segments;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // number of slots in a chunk of the queue, for sort keys by chunk only
    std::uint32_t last_key;
    KeyBounds bounds;
    MeshQueue meshes;  // gets the paths whose rays traversal=persistent takes through meshes in a kernel of its own
};

// Parameters of the kernel that writes the sort keys of rays that are yet to be traced; ended paths and positions
// beyond the count get the last key.
struct WriteRayKeysParameters {
    static constexpr const char* kernel = "write_ray_keys";
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    std::uint32_t bound;
    std::uint32_t* keys;
    std::uint32_t last_key;
    KeyBounds bounds;
};

template <class Real>
struct ShadePathsParameters {
    static constexpr const char* kernel = "shade_paths";
    SceneView<Real> scene;
    FilmView film;
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    const StoredHit<Real>* hits;
    Totals* totals;
    WalkerList walkers;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/advance.cuh"
#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/hit_keys.cuh"
#include "variants/cuda/device/mesh_queue.cuh"
#include "variants/cuda/device/queue_slots.cuh"
#include "variants/cuda/device/sort_keys.cuh"
#include "variants/cuda/device/walkers.cuh"

PT_KERNEL(generate_paths, pt::cuda::GeneratePathsParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, std::uint32_t* count, std::uint32_t pool,
           std::uint32_t first_sample, const std::uint32_t* cursor, HitCache cache)) {
    const SceneViews scene(parameter);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i == 0) {
        *count = pool;
    }
    if (i < pool) {
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        Paths(store).put<carried_fields>(i, pt::cuda::path_of_number(scene.shade, i, first, cache));
    }
}

// Traces the queue's rays, a position a thread. Paths that enter a mesh wait for the traversal's own kernel, if any.
PT_KERNEL(intersect_paths, pt::cuda::IntersectPathsParameters<Real>,
          (const __grid_constant__ Scene parameter, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, std::uint32_t bound, StoredHit* hits, HitCache cache, SegmentNumber segment,
           SegmentCounts segments, std::uint32_t* keys, std::uint32_t bits, std::uint32_t chunk, std::uint32_t last_key,
           pt::cuda::KeyBounds bounds, pt::cuda::MeshQueue meshes)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    std::uint32_t key = last_key;
    bool live = false;
    bool waits = false;
    if (i < *count) {
        const std::uint32_t slot = pt::cuda::slot_at(order, i);
        if (paths.alive(slot)) {
            live = true;
            pt::Ray<Real> ray = paths.ray(slot);
            Hit hit;
            if (kernel_config.keeps_first_hits && segment == 0) {
                hit = cache.load<Configuration>(cache.index(paths.pixel(slot), paths.sample(slot)));
            } else {
                if constexpr (carried_fields.primitive) {
                    ray.primitive = paths.primitive(slot);
                }
                if constexpr (pt::cuda::fetches_paths<Accelerator>) {
                    hit = pt::closest_hit<pt::cuda::WithoutMeshes>(scene.trace, ray);
                    waits = pt::cuda::enters_mesh<Accelerator>(scene.trace, ray, hit);
                } else {
                    hit = pt::closest_hit<Configuration>(scene.trace, ray);
                }
            }
            hits[slot] = {hit.t, hit.side};
            if constexpr (carried_fields.primitive) {
                if (!waits) {
                    paths.primitive(slot) = hit.primitive;
                }
            }
            if (keys != nullptr) {
                key = pt::cuda::key_of(scene.shade, ray, hit, slot, bits, chunk, bounds);
            }
        }
    }
    if (keys != nullptr && i < bound) {
        keys[i] = key;
    }
    if constexpr (pt::cuda::fetches_paths<Accelerator>) {
        pt::cuda::put_position(meshes, waits, i);
    }
    pt::cuda::add_segment_counts(segments, segment, live, *count);
}

PT_KERNEL(write_ray_keys, pt::cuda::WriteRayKeysParameters,
          (PathStore store, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t bound,
           std::uint32_t* keys, std::uint32_t last_key, pt::cuda::KeyBounds bounds)) {
    const Paths paths(store);
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < bound) {
        std::uint32_t key = last_key;
        const std::uint32_t slot = i < *count ? pt::cuda::slot_at(order, i) : 0;
        if (i < *count && paths.alive(slot)) {
            key = sort_key::rest(paths.ray(slot), Hit(), bounds);
        }
        keys[i] = key;
    }
}

PT_KERNEL(shade_paths, pt::cuda::ShadePathsParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, PathStore store, const std::uint32_t* order,
           const std::uint32_t* count, const StoredHit* hits, Totals* totals, pt::cuda::WalkerList walkers)) {
    const SceneViews scene(parameter);
    const Paths paths(store);
    ThreadCounters counters;
    OwnWalk walk;
    std::uint32_t slot = 0;
    const std::uint32_t i = pt::cuda::thread_number();
    if (i < *count) {
        slot = pt::cuda::slot_at(order, i);
        if (paths.alive(slot)) {
            Path path = load_path(paths, slot, scene.shade);
            // The random numbers of cis565 are seeded by where a path lies in the queue, not by its pixel.
            const std::uint32_t pixel = path.pixel;
            if (contains(pt::sampler_of<Configuration>(scene.shade.seed), pt::Feature::minstd)) {
                path.pixel = i;
            }
            const StoredHit stored = hits[slot];
            const bool alive =
                shade<walks_apart>(scene, path, Hit{stored.t, stored.side, path.primitive}, counters, walk);
            path.pixel = pixel;
            if (alive) {
                paths.update<carried_fields>(slot, path);
            } else {
                pt::accumulate(film, path);
                counters.paths += 1;
                paths.end(slot);
            }
        }
    }
    if constexpr (walks_apart) {
        pt::cuda::put_walkers(walkers, walk, slot, i);
    }
    pt::cuda::add_shade_counters(totals, counters);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/mesh_rays.h"
#include "variants/cuda/sort_stage.h"
#include "variants/cuda/walks.h"
#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront {
namespace {

constexpr Tunable tunables[] = {wavefront_tunables[0], wavefront_tunables[1], wavefront_tunables[2],
                                wavefront_tunables[3], wavefront_tunables[4], walks_tunable};

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront",
    .summary = "a kernel a stage over a queue of paths: generate, intersect, shade",
    .origin = "Laine, Karras and Aila 2013; cis565",
    .baseline = on_cuda,
    .traits =
        IntegratorTraits{.has_queue = true, .can_loop = true, .seeds_by_position = true, .traces_in_own_kernel = true},
    .backends = on_cuda,
    .tunables = tunables,
    .check_counters = wavefront_work_missing,
};

template <class Real>
class StagedWavefront final : public Wavefront {
public:
    StagedWavefront(JobOf<Real>& job, IntegratorNeeds&& needs)
        : Wavefront(job, std::move(needs), sizeof(Real), sizeof(StoredHit<Real>)),
          job_(job),
          sort_stage_(job, this->needs()),
          walks_(job, this->needs(), job.pixels * batches().samples_in_flight()),
          mesh_rays_(job, this->needs()) {}

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<GeneratePathsParameters<Real>>(), kernel_of<IntersectPathsParameters<Real>>(),
                kernel_of<ShadePathsParameters<Real>>(), kernel_of<WriteRayKeysParameters>(false),
                kernel_of<AdvanceParameters>(false)};
    }

private:
    void fill_first_hits() override { fill_cache(job_); }
    void reserve_counts(Arena& arena) override {
        walks_.reserve(arena);
        mesh_rays_.reserve(arena, job_.pixels * batches().samples_in_flight());
    }

    void begin(std::uint32_t first_sample) override {
        walks_.begin();
        mesh_rays_.begin();
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
            job_.launch(queue_.bound,
                        IntersectPathsParameters<Real>{
                            job_.scene, queue_.paths, order(), queue_.count, queue_.bound, hits(), job_.cache,
                            batches().segment(segment), job_.segments, keys, key.bits, sort_stage_.chunk(queue_),
                            sort_stage_.last_key(queue_), needs().key_bounds, mesh_rays_.queue()});
            mesh_rays_.take(queue_.paths, order(), queue_.bound, hits(), keys, key.bits, sort_stage_.chunk(queue_));
        }
        if (sorts && by_hit) {
            const Stage stage(job_.stages, "sort", job_.stream);
            sort_stage_.sort(queue_);
        }
        shade(sorts && by_hit);
    }

    StoredHit<Real>* hits() const { return static_cast<StoredHit<Real>*>(queue_.hits); }

    void shade(bool is_sorted) {
        {
            const Stage stage(job_.stages, "shade", job_.stream);
            for (const ShadeRange& range : sort_stage_.shade_ranges(queue_, is_sorted)) {
                job_.launch(queue_.bound, ShadePathsParameters<Real>{job_.scene, job_.film, queue_.paths, range.order,
                                                                     range.count, hits(), job_.totals, walks_.list()});
            }
        }
        walks_.take_in_place(queue_.paths);
    }

    JobOf<Real>& job_;
    SortStage sort_stage_;
    Walks<Real> walks_;
    MeshRays<Real> mesh_rays_;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<StagedWavefront>();
    made.stores_hits = true;
    made.constants = walks_constants;
    made.walks = walk_paths_part;
    made.meshes = mesh_rays_part;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront

#endif
