// The kernel of a wavefront with traversal=persistent that takes rays through meshes, one mesh after the other, by
// warps that fetch paths. Its results are those of one thread a path.
#pragma once

#include "variants/cuda/device/hit_keys.cuh"
#include "variants/cuda/device/mesh_queue.cuh"
#include "variants/cuda/device/queue_slots.cuh"
#include "variants/traversal/warp_queue.cuh"

namespace pt::cuda {

// What the kernel that takes rays through meshes is handed, as views of the scene, the paths and the hits.
struct MeshStage {
    const SceneViews& scene;
    const Paths& paths;
    const std::uint32_t* order;
    const MeshQueue& queue;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits, chunk;
    const KeyBounds& bounds;

    __device__ Ray<Real> ray(std::uint32_t slot) const {
        Ray<Real> ray = paths.ray(slot);
        if constexpr (carried_fields.primitive) {
            ray.primitive = paths.primitive(slot);
        }
        return ray;
    }
};

// What triangle tests need of a ray, in few registers: from the axis kz the axes kx and ky follow.
class CompactRay {
public:
    CompactRay() = default;
    __device__ explicit CompactRay(const MeshRay<Real>& ray)
        : shear_(ray.sheared.shear), along_(ray.along), kz_(ray.sheared.kz), passed_over_(ray.passed_over) {}

    __device__ MeshRay<Real> whole(std::uint32_t object) const {
        MeshRay<Real> ray;
        const std::uint32_t kx = kz_ == 2u ? 0u : kz_ + 1u;
        ray.sheared = {kx, kx == 2u ? 0u : kx + 1u, kz_, shear_};
        ray.along = along_;
        ray.object = object;
        ray.passed_over = passed_over_;
        return ray;
    }

private:
    Vec3<Real> shear_, along_;
    std::uint32_t kz_, passed_over_;
};

// The path whose ray one lane takes through meshes at the moment; a State of traversal::work_off.
template <class Traversal>
class FetchedPath {
public:
    using Walk = typename Traversal::template Walk<Real>;
    using Stack = typename Traversal::template Stack<Real>;

    __device__ FetchedPath(const MeshStage& stage, Stack& stack) : stage_(stage), stack_(stack) {}

    __device__ bool active() const { return wants_node() || wants_triangle(); }
    __device__ bool wants_node() const { return walk_.wants_node(); }
    __device__ bool wants_triangle() const { return !triangles_.empty(); }

    __device__ void start(std::uint32_t place) {
        position_ = stage_.queue.positions[place];
        slot_ = slot_at(stage_.order, position_);
        const StoredHit<Real> met = stage_.hits[slot_];
        best_ = Hit<Real>{};
        best_.t = met.t;
        best_.side = met.side;
        mesh_ = 0;
        start_meshes();
    }
    // Visits the next node. Triangles that were found wait, so a lane goes on to nodes while other lanes test theirs.
    __device__ void visit_node() {
        NoTraversalCounter counter;
        walk_.visit_node(best_.t, stack_, counter);
        go_on();
    }
    __device__ void test_triangle() {
        meet_triangle(best_, leaves_[triangles_.take()],
                      ray_.whole(first_of<ShapeKind::mesh>(stage_.scene.trace) + mesh_));
        go_on();
    }

private:
    // Starts on the first mesh that has a tree, from mesh number mesh_ on.
    __device__ void start_meshes() {
        const ::Scene& scene = stage_.scene.trace;
        while (mesh_ < scene.meshes.size && scene.meshes[mesh_].geometry.tree.node_count == 0) {
            ++mesh_;
        }
        if (mesh_ == scene.meshes.size) {
            finish();
            return;
        }
        const auto start = MeshWalk<Traversal>::of(scene, mesh_, stage_.ray(slot_));
        ray_ = CompactRay(start.ray);
        walk_ = start.walk;
        leaves_ = scene.meshes[mesh_].geometry.leaves;
        stack_.clear();
    }
    __device__ void go_on() {
        if (triangles_.empty() && walk_.has_leaf()) {
            triangles_ = walk_.leaf();
            walk_.pass_leaf(best_.t, stack_);
        }
        if (triangles_.empty() && !walk_.wants_node()) {
            ++mesh_;
            start_meshes();
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

    const MeshStage& stage_;
    Stack& stack_;
    Walk walk_;
    CompactRay ray_;
    const LeafTriangle* leaves_;
    Hit<Real> best_;
    typename Walk::Leaf triangles_;
    std::uint32_t position_, slot_, mesh_;
};

}  // namespace pt::cuda

PT_KERNEL_WITH(__launch_bounds__(pt::cuda::fetching_block(kernel_config.block),
                                 pt::cuda::fetching_blocks_at_once(kernel_config.block, sizeof(Real))),
               intersect_meshes, pt::cuda::IntersectMeshesParameters<Real>,
               (const __grid_constant__ Scene parameter, PathStore store, const std::uint32_t* order,
                pt::cuda::MeshQueue queue, StoredHit* hits, std::uint32_t* keys, std::uint32_t bits,
                std::uint32_t chunk, pt::cuda::KeyBounds bounds)) {
    using Stack = Accelerator::Stack<Real>;
    const SceneViews scene(parameter);
    const Paths paths(store);
    const pt::cuda::MeshStage stage{scene, paths, order, queue, hits, keys, bits, chunk, bounds};
    typename Stack::Memory memory;
    Stack stack(memory);
    pt::cuda::FetchedPath<Accelerator> path(stage, stack);
    pt::traversal::work_off<Accelerator::Policy>(path, &queue.counts->taken, queue.counts->waiting);
    pt::cuda::finish_list(queue.counts);
}
