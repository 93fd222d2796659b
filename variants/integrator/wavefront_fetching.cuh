// The intersection stage of a wavefront whose warps fetch paths from the queue (traversal=persistent). A path that is
// fetched meets the scene's other shapes at once, then its meshes one after the other; what it leaves behind is what
// the stage with a thread a path leaves.
#pragma once

#include "variants/cuda/device/hit_keys.cuh"
#include "variants/cuda/device/queue_slots.cuh"
#include "variants/traversal/warp_queue.cuh"

namespace pt::cuda {

// Whether the accelerator is a choice of the axis traversal that has a kernel for itself.
template <class Traversal>
inline constexpr bool fetches_paths = requires {
    Traversal::fetches_paths;
};

// The parameters of the intersection stage (IntersectPathsParameters), as views.
struct IntersectStage {
    const SceneViews& scene;
    const Paths& paths;
    const std::uint32_t* order;
    const std::uint32_t* count;
    std::uint32_t bound;
    StoredHit<Real>* hits;
    const HitCache<Real>& cache;
    std::uint32_t segment;
    std::uint32_t* keys;
    std::uint32_t bits, chunk, last_key;
    const KeyBounds& bounds;

    // Number of positions that a lane has to look at.
    __device__ std::uint32_t positions() const { return keys != nullptr ? bound : *count; }
    __device__ Ray<Real> ray(std::uint32_t slot) const {
        Ray<Real> ray = paths.ray(slot);
        if constexpr (carried_fields.primitive) {
            ray.primitive = paths.primitive(slot);
        }
        return ray;
    }
};

// The path that one lane traces at the moment; a State of traversal::work_off.
template <class Traversal>
class FetchedPath {
public:
    using Walk = typename Traversal::template Walk<Real>;
    using Stack = typename Traversal::template Stack<Real>;

    __device__ FetchedPath(const IntersectStage& stage, Stack& stack) : stage_(stage), stack_(stack) {}

    __device__ bool active() const { return wants_node() || wants_triangle(); }
    __device__ bool wants_node() const { return walk_.wants_node(); }
    __device__ bool wants_triangle() const { return !triangles_.empty(); }
    __device__ std::uint32_t live_paths() const { return live_paths_; }

    __device__ void start(std::uint32_t position) {
        position_ = position;
        if (position < *stage_.count) {
            slot_ = slot_at(stage_.order, position);
            if (stage_.paths.alive(slot_)) {
                ++live_paths_;
                start_path();
                return;
            }
        }
        if (stage_.keys != nullptr) {
            stage_.keys[position] = stage_.last_key;
        }
    }

    // Visits the next node. Triangles that were found wait, so a lane goes on to nodes while others test theirs.
    __device__ void visit_node() {
        NoTraversalCounter counter;
        walk_.visit_node(best_.t, stack_, counter);
        go_on();
    }
    __device__ void test_triangle() {
        const LeafTriangle leaf = leaves_[triangles_.take()];
        meet_triangle(best_, leaf, ray_);
        go_on();
    }

private:
    using Others = Config<Real, Configuration::features & ~static_cast<FeatureSet>(Feature::mesh), Accelerator>;

    __device__ void start_path() {
        if (kernel_config.keeps_first_hits && stage_.segment == 0) {
            best_ = stage_.cache.template load<Configuration>(
                stage_.cache.index(stage_.paths.pixel(slot_), stage_.paths.sample(slot_)));
            finish();
            return;
        }
        const Ray<Real> ray = stage_.ray(slot_);
        best_ = closest_hit<Others>(stage_.scene.trace, ray);
        mesh_ = 0;
        start_meshes(ray);
    }
    // Starts on the first mesh from mesh_ on that has a tree.
    __device__ void start_meshes(const Ray<Real>& ray) {
        const Scene& scene = stage_.scene.trace;
        while (mesh_ < scene.meshes.size && scene.meshes[mesh_].geometry.tree.node_count == 0) {
            ++mesh_;
        }
        if (mesh_ == scene.meshes.size) {
            finish();
            return;
        }
        const std::uint32_t object = first_of<ShapeKind::mesh>(scene) + mesh_;
        const MeshInstance<Real>& mesh = scene.meshes[mesh_];
        ray_ = MeshRay<Real>::of(mesh, object, at_rest<Configuration>(scene, object, ray.origin, ray.time), ray);
        leaves_ = mesh.geometry.leaves;
        walk_ = Walk(mesh.geometry.tree, ray_.origin, ray_.direction);
        stack_.clear();
    }
    __device__ void go_on() {
        if (triangles_.empty() && walk_.has_leaf()) {
            triangles_ = walk_.leaf();
            walk_.pass_leaf(best_.t, stack_);
        }
        if (triangles_.empty() && !walk_.wants_node()) {
            ++mesh_;
            start_meshes(stage_.ray(slot_));
        }
    }
    __device__ void finish() {
        stage_.hits[slot_] = {best_.t, best_.side};
        if (stage_.keys != nullptr) {
            stage_.keys[position_] = key_of(stage_.scene.shade, stage_.paths.ray(slot_), best_, slot_, stage_.bits,
                                            stage_.chunk, stage_.bounds);
        }
        if constexpr (carried_fields.primitive) {
            stage_.paths.primitive(slot_) = best_.primitive;
        }
    }

    const IntersectStage& stage_;
    Stack& stack_;
    Walk walk_;
    MeshRay<Real> ray_;
    const LeafTriangle* leaves_;
    Hit<Real> best_;
    typename Walk::Leaf triangles_;
    std::uint32_t position_, slot_, mesh_;
    std::uint32_t live_paths_ = 0;
};

// Traces the paths of a queue by persistent warps. The positions fetched are counted in the module; who is last makes
// the count ready for the next launch. Every thread of the grid must call it.
template <class Traversal>
__device__ inline void intersect_fetched(const IntersectStage& stage, const SegmentCounts& segments) {
    static __device__ std::uint32_t next, finished_blocks;
    using Stack = typename Traversal::template Stack<Real>;
    typename Stack::Memory memory;
    Stack stack(memory);
    FetchedPath<Traversal> path(stage, stack);
    traversal::work_off<typename Traversal::Policy>(path, &next, stage.positions());
    const std::size_t copy = static_cast<std::size_t>(stage.segment) * segments.copies + blockIdx.x % segments.copies;
    const std::uint32_t live[] = {path.live_paths()};
    std::uint64_t* const sums[] = {&segments.live[copy]};
    add_over_block(live, sums);
    if (thread_number() == 0) {
        atomic_add(&segments.in_play[copy], static_cast<std::uint64_t>(*stage.count));
    }
    __syncthreads();
    if (threadIdx.x == 0 && atomicAdd(&finished_blocks, 1u) == gridDim.x - 1) {
        next = finished_blocks = 0;
    }
}

}  // namespace pt::cuda
