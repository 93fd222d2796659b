// The integrator wavefront_materials: one kernel a bounce over a queue for each type of material. A thread shades its
// path's hit, traces the next ray, and appends the path to the queue of the material that the ray has met; so blocks
// shade one type of material, ended paths leave by themselves, and a path's state moves once a bounce. Rays that enter
// a mesh may go on through it in a kernel of their own, between tracing and shading. Queues by material as in Laine,
// Karras and Aila 2013 and in pbrt-v4.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/device/material_queues.h"
#include "variants/cuda/device/mesh_queue.h"
#include "variants/cuda/device/parameters.h"

namespace pt::cuda {

// Parameters of the kernel that starts path i (pixel i mod pixels, sample first_sample + i / pixels), for i below
// `pool`, and traces its first ray; if `cursor` is not null, the first sample is read from it. Paths that this ends are
// added to the film.
template <class Real>
struct TraceFirstParameters {
    static constexpr const char* kernel = "trace_first";
    SceneView<Real> scene;
    FilmView film;
    MaterialQueues<Real> out;
    std::uint32_t pool;
    std::uint32_t first_sample;
    const std::uint32_t* cursor;
    HitCache<Real> cache;
    Totals* totals;
    SegmentCounts segments;
    MeshQueue meshes;  // gets the slots of paths whose rays traversal=persistent takes through meshes
};

// Parameters of the kernel that shades the hits of segment number `segment` and traces the next segment. Paths that
// either ends are added to the film.
template <class Real>
struct ShadeAndTraceParameters {
    static constexpr const char* kernel = "shade_and_trace";
    SceneView<Real> scene;
    FilmView film;
    MaterialQueues<Real> in;
    MaterialQueues<Real> out;
    std::uint32_t* unused;  // words for the counts and chunks of the segment after the next, which the kernel clears
    std::uint32_t unused_words;
    std::uint32_t segment;
    Totals* totals;
    SegmentCounts segments;
    MeshQueue meshes;
};

}  // namespace pt::cuda

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: kernels, which NVRTC compiles

#include "variants/cuda/device/advance.cuh"
#include "variants/cuda/device/material_queues.cuh"
#include "variants/cuda/device/mesh_queue.cuh"
#include "variants/cuda/device/queue_slots.cuh"

// A ray's hit, and whether the ray is to go on through a mesh that it enters before this hit.
struct TracedHit {
    Hit hit;
    bool waits;
};

__device__ inline TracedHit trace_or_wait(const SceneViews& scene, const Path& path) {
    if constexpr (pt::cuda::fetches_paths<Accelerator>) {
        const pt::Ray<Real> ray = pt::ray_of(path);
        const Hit hit = pt::closest_hit<pt::cuda::WithoutMeshes>(scene.trace, ray);
        return {hit, pt::cuda::enters_mesh<Accelerator>(scene.trace, ray, hit)};
    } else {
        return {trace(scene, path), false};
    }
}

// Whether a path with this hit goes into a queue; else the hit ends the path, and is shaded at once.
__device__ inline bool is_kept(const SceneViews& scene, const Path& path, const TracedHit& traced) {
    return traced.waits || QueueKinds::keeps_ends || !QueueKinds::is_ended_by(scene.shade, path, traced.hit);
}

// The kind of a path that goes into a queue. What a waiting path meets is not known yet: it has the first mesh's kind.
__device__ inline std::uint32_t kind_of(const SceneViews& scene, const Path& path, const TracedHit& traced) {
    if (traced.waits) {
        return QueueKinds::of(scene.shade, pt::first_of<pt::ShapeKind::mesh>(scene.shade));
    }
    if (QueueKinds::keeps_ends && QueueKinds::is_ended_by(scene.shade, path, traced.hit)) {
        return QueueKinds::ending;
    }
    return QueueKinds::of(scene.shade, traced.hit.side.object());
}

__device__ inline void end_path(const FilmView& film, const Path& path, ThreadCounters& counters) {
    pt::accumulate(film, path);
    counters.paths += 1;
}

// Puts a path into the queue of its kind, with its hit. Every thread of the block must call it.
__device__ inline void put_path(const SceneViews& scene, Path& path, const TracedHit& traced, bool keeps,
                                const pt::cuda::MaterialQueues<Real>& out, const pt::cuda::MeshQueue& meshes) {
    const std::uint32_t kind = keeps ? kind_of(scene, path, traced) : 0;
    const std::uint32_t slot = pt::cuda::append_to_kind(out, keeps, kind);
    if (keeps) {
        if constexpr (carried_fields.primitive) {
            if (!traced.waits) {
                path.primitive = traced.hit.primitive;
            }
        }
        Paths(out.paths).put<carried_fields>(slot, path);
        out.hits[slot] = {traced.hit.t, traced.hit.side};
    }
    if constexpr (pt::cuda::fetches_paths<Accelerator>) {
        pt::cuda::put_position(meshes, keeps && traced.waits, slot);
    }
}

// Counts paths of the block whose ray of a segment was traced. One thread must call it.
__device__ inline void count_traced(const SegmentCounts& segments, std::uint32_t segment, std::uint32_t paths) {
    if (paths != 0) {
        const std::size_t at = static_cast<std::size_t>(segment) * segments.copies + blockIdx.x % segments.copies;
        pt::atomic_add(&segments.live[at], std::uint64_t{paths});
        pt::atomic_add(&segments.in_play[at], std::uint64_t{paths});
    }
}

// Counts paths whose ray of a segment ended them, so that no queue of that segment holds them. Every thread of the
// block must call it.
__device__ inline void count_shaded_at_once(const SegmentCounts& segments, std::uint32_t segment, bool was_shaded) {
    const std::uint32_t paths = static_cast<std::uint32_t>(__syncthreads_count(was_shaded ? 1 : 0));
    if (threadIdx.x == 0) {
        count_traced(segments, segment, paths);
    }
}

PT_KERNEL(trace_first, pt::cuda::TraceFirstParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, pt::cuda::MaterialQueues<Real> out,
           std::uint32_t pool, std::uint32_t first_sample, const std::uint32_t* cursor, HitCache cache, Totals* totals,
           SegmentCounts segments, pt::cuda::MeshQueue meshes)) {
    const SceneViews scene(parameter);
    ThreadCounters counters;
    const std::uint32_t i = pt::cuda::thread_number();
    const bool mine = i < pool;
    Path path;
    TracedHit traced{};
    bool keeps = false;
    if (mine) {
        const std::uint32_t first = cursor != nullptr ? *cursor : first_sample;
        path = pt::cuda::path_of_number(scene.shade, i, first, cache);
        if (kernel_config.keeps_first_hits) {
            traced.hit = first_hit(scene, path, cache);
        } else {
            traced = trace_or_wait(scene, path);
        }
        keeps = is_kept(scene, path, traced);
        if (!keeps) {
            shade(scene, path, traced.hit, counters);
            end_path(film, path, counters);
        }
    }
    put_path(scene, path, traced, keeps, out, meshes);
    count_shaded_at_once(segments, 0, mine && !keeps);
    pt::cuda::add_shade_counters(totals, counters);
}

PT_KERNEL(shade_and_trace, pt::cuda::ShadeAndTraceParameters<Real>,
          (const __grid_constant__ Scene parameter, FilmView film, pt::cuda::MaterialQueues<Real> in,
           pt::cuda::MaterialQueues<Real> out, std::uint32_t* unused, std::uint32_t unused_words, std::uint32_t segment,
           Totals* totals, SegmentCounts segments, pt::cuda::MeshQueue meshes)) {
    for (std::uint32_t i = pt::cuda::thread_number(); i < unused_words; i += pt::cuda::thread_count()) {
        unused[i] = 0;
    }
    const pt::cuda::BlockSlots slots = pt::cuda::slots_of_block(in);
    if (slots.count == 0) {
        return;
    }
    const SceneViews scene(parameter);
    ThreadCounters counters;
    Path path;
    TracedHit traced{};
    bool keeps = false;
    bool shaded_at_once = false;
    if (threadIdx.x < slots.count) {
        const std::uint32_t slot = slots.first + threadIdx.x;
        path = load_path(Paths(in.paths), slot, scene.shade);
        const StoredHit stored = in.hits[slot];
        traced.hit = {stored.t, stored.side, path.primitive};
        // A hit that ends the path is shaded in the loop's second turn, by the same code.
        while (shade(scene, path, traced.hit, counters)) {
            traced = trace_or_wait(scene, path);
            keeps = is_kept(scene, path, traced);
            if (keeps) {
                break;
            }
            shaded_at_once = true;
        }
        if (!keeps) {
            end_path(film, path, counters);
        }
    }
    put_path(scene, path, traced, keeps, out, meshes);
    if (threadIdx.x == 0) {
        count_traced(segments, segment, slots.count);
    }
    count_shaded_at_once(segments, segment + 1, shaded_at_once);
    pt::cuda::add_shade_counters(totals, counters);
}

#endif

#if defined(PT_HOST)  // host part of this file: kernel launches, and the integrator's descriptor

#include "variants/cuda/mesh_rays.h"
#include "variants/cuda/wavefronts.h"

namespace pt::cuda::integrator::wavefront_materials {
namespace {

constexpr Tunable tunables[] = {
    wavefront_tunables[0],
    wavefront_tunables[1],
    wavefront_tunables[2],
    wavefront_tunables[3],
    {"append_counters", 4, 1, 16, 1,
     "queues of each kind, with a counter each: block b appends to number b mod so many"},
    {"by_material", 1, 0, 1, 1,
     "1: a queue for each type of material, and with connections to lights one for paths that their hit ends; 0: one "
     "queue for all, and such paths are shaded at once"}};

Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (variant.compaction.compacts) {
        return {"appends_itself",
                "appends live paths itself: needs compaction=none, not " + std::string(variant.compaction.name)};
    }
    if (variant.sorting.sorts) {
        return {"appends_itself",
                "appends paths by material itself: needs sorting=none, not " + std::string(variant.sorting.name)};
    }
    return {};
}

constexpr Descriptor descriptor{
    .axis = "integrator",
    .name = "wavefront_materials",
    .summary = "one kernel a bounce, which shades, traces on, and appends to the queue of the material met",
    .origin = "Laine, Karras and Aila 2013; pbrt-v4 (a queue for each material)",
    .traits = IntegratorTraits{.has_queue = true, .traces_in_own_kernel = true, .appends_itself = true},
    .backends = on_cuda,
    .tunables = tunables,
    .unsupported_reason = unsupported_reason,
    .check_counters = wavefront_work_missing,
};

template <class Real>
class MaterialWavefront final : public Wavefront {
public:
    MaterialWavefront(JobOf<Real>& job, IntegratorNeeds&& needs)
        : Wavefront(job, std::move(needs), sizeof(Real), 0),
          job_(job),
          keeps_ends_(keeps_ended_paths(this->needs().features, this->needs().tunable("by_material") != 0)),
          queues_(kinds_of_paths(this->needs().features, this->needs().tunable("by_material") != 0) *
                  this->needs().tunable("append_counters")),
          mesh_rays_(job, this->needs()) {}

    static std::vector<KernelSignature> kernels() {
        return {kernel_of<TraceFirstParameters<Real>>(), kernel_of<ShadeAndTraceParameters<Real>>(),
                kernel_of<AdvanceParameters>(false)};
    }

private:
    void fill_first_hits() override { fill_cache(job_); }

    // Each queue may have one chunk that is not full.
    std::uint32_t slots_for(std::uint32_t paths) const override {
        const std::uint32_t slots_per_chunk = blocks_per_chunk * job_.block;
        return ((paths + slots_per_chunk - 1) / slots_per_chunk + queues_) * slots_per_chunk;
    }
    // Each queue may have one block that is not full.
    std::uint32_t threads_for(std::uint32_t paths) const {
        return ((paths + job_.block - 1) / job_.block + queues_) * job_.block;
    }

    void reserve_counts(Arena& arena) override {
        const std::uint32_t slots = slots_for(job_.pixels * batches().samples_in_flight());
        chunks_per_queue_ = slots / (blocks_per_chunk * job_.block);
        for (StoredHit<Real>*& hits : hits_) {
            hits = arena.take<StoredHit<Real>>(slots);
        }
        words_ = arena.take<std::uint32_t>(segments_counted * words_per_segment());
        mesh_rays_.reserve(arena, slots);
    }

    void begin(std::uint32_t first_sample) override {
        clear(words_, segments_counted * words_per_segment() * sizeof(std::uint32_t), job_.stream);
        mesh_rays_.begin();
        {
            const Stage stage(job_.stages, "first bounce", job_.stream);
            job_.launch(queue_.bound, TraceFirstParameters<Real>{job_.scene, job_.film, queues(0), queue_.bound,
                                                                 first_sample, batches().cursor(), job_.cache,
                                                                 job_.totals, job_.segments, mesh_rays_.queue()});
        }
        go_through_meshes(0);
        trace(0);
        end_segment(0);
    }

    void trace(std::uint32_t segment) override {
        if (is_last(segment) && !keeps_ends_ && !mesh_rays_.are_apart()) {
            return;  // every path was shaded at once as its last ray had been traced, so the queues are empty
        }
        {
            const Stage stage(job_.stages, "bounce", job_.stream);
            job_.launch(threads_for(queue_.bound),
                        ShadeAndTraceParameters<Real>{job_.scene, job_.film, queues(segment), queues(segment + 1),
                                                      queues(segment + 2).counts,
                                                      static_cast<std::uint32_t>(words_per_segment()), segment,
                                                      job_.totals, job_.segments, mesh_rays_.queue()});
        }
        if (!is_last(segment)) {
            go_through_meshes(segment + 1);
        }
    }

    // Takes the rays of a segment that enter meshes through them.
    void go_through_meshes(std::uint32_t segment) {
        if (!mesh_rays_.are_apart()) {
            return;
        }
        const Stage stage(job_.stages, "intersect", job_.stream);
        const MaterialQueues<Real> at = queues(segment);
        mesh_rays_.take(at.paths, nullptr, queue_.bound, at.hits);
    }

    std::size_t words_of_counts() const { return (queues_ + std::size_t{1}) * counter_stride; }
    std::size_t words_per_segment() const { return words_of_counts() + std::size_t{queues_} * chunks_per_queue_; }
    // The queues of paths whose ray of this segment has been traced. Segments use two stores in turn, and the words for
    // counts and chunks of three segments: a kernel reads one, writes one, and clears one.
    static constexpr std::uint32_t segments_counted = 3;
    MaterialQueues<Real> queues(std::uint32_t segment) const {
        const bool is_even = segment % 2 == 0;
        std::uint32_t* const counts = words_ + segment % segments_counted * words_per_segment();
        return {is_even ? queue_.paths : queue_.spare, hits_[is_even ? 0 : 1], counts, counts + words_of_counts(),
                chunks_per_queue_};
    }

    JobOf<Real>& job_;
    bool keeps_ends_;       // paths that their hit ends go into a queue, too
    std::uint32_t queues_;  // number of queues of all kinds
    std::uint32_t chunks_per_queue_ = 0;
    StoredHit<Real>* hits_[2] = {};   // hits of the paths in queue_.paths, and of those in queue_.spare
    std::uint32_t* words_ = nullptr;  // in device memory: counts and chunks of the queues of three segments
    MeshRays<Real> mesh_rays_;
};

IntegratorHook hook() {
    IntegratorHook made = integrator_hook<MaterialWavefront>();
    made.stores_hits = true;
    made.constants = [](const Variant& variant) -> std::vector<KernelConstant> {
        return {{"append_counters", tunable(variant, "append_counters", Backend::cuda)},
                {"by_material", tunable(variant, "by_material", Backend::cuda)}};
    };
    made.meshes = mesh_rays_part;
    return made;
}

const Registration registration(descriptor, {.cuda = {.integrator = hook()}});

}  // namespace
}  // namespace pt::cuda::integrator::wavefront_materials

#endif
