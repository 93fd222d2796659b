// Lists the paths that a kernel of their own takes through meshes (mesh_queue.h), in kernels with one thread per path.
#pragma once

#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/mesh_queue.h"

namespace pt::cuda {

// Whether a choice of the axis `traversal` takes rays through meshes in a kernel whose warps fetch paths.
template <class Traversal>
inline constexpr bool fetches_paths = requires {
    Traversal::fetches_paths;
};

// The kernel's configuration (Config) without meshes.
using WithoutMeshes = Config<Real, ::Configuration::features & ~static_cast<FeatureSet>(Feature::mesh), Accelerator>;

// A ray in a mesh's space, and its traversal at the root of the mesh's tree.
template <class Traversal>
struct MeshWalk {
    using Walk = typename Traversal::template Walk<Real>;

    MeshRay<Real> ray;
    Walk walk;

    __device__ static MeshWalk of(const ::Scene& scene, std::uint32_t mesh, const Ray<Real>& ray) {
        const std::uint32_t object = first_of<ShapeKind::mesh>(scene) + mesh;
        const MeshInstance<Real>& instance = scene.meshes[mesh];
        MeshWalk made;
        made.ray =
            MeshRay<Real>::of(instance, object, at_rest<::Configuration>(scene, object, ray.origin, ray.time), ray);
        made.walk = Walk(instance.geometry.tree, made.ray.origin, made.ray.direction);
        return made;
    }
};

// Stack of a traversal that ends after the root: it only records whether the ray enters a child.
template <class Open>
class RootStack {
public:
    __device__ bool has_entered() const { return has_entered_; }
    __device__ bool pop(Open&) { return false; }
    template <int width>
    __device__ bool enters_nearest(const Real (&entries)[width], const std::uint32_t (&)[width], std::uint32_t&) {
        for (int child = 0; child < width; ++child) {
            has_entered_ = has_entered_ || !(entries[child] < Real(0));
        }
        return false;
    }
    __device__ bool enters_nearer(const Open&) { return true; }
    __device__ bool enters_only_child() { return true; }
    __device__ bool enter(std::uint32_t, const Open&) { return false; }
    __device__ void narrow(Open&) {}

private:
    bool has_entered_ = false;
};

// Whether a ray whose closest hit among the other shapes is `best` enters a child of a mesh's root before that hit.
template <class Traversal>
__device__ inline bool enters_mesh(const ::Scene& scene, const Ray<Real>& ray, const Hit<Real>& best) {
    using Walk = typename MeshWalk<Traversal>::Walk;
    for (std::uint32_t mesh = 0; mesh < scene.meshes.size; ++mesh) {
        if (scene.meshes[mesh].geometry.tree.node_count != 0) {
            Walk walk = MeshWalk<Traversal>::of(scene, mesh, ray).walk;
            RootStack<typename Walk::Open> stack;
            NoTraversalCounter counter;
            walk.visit_node(best.t, stack, counter);
            if (walk.wants_node() || walk.has_leaf() || stack.has_entered()) {
                return true;
            }
        }
    }
    return false;
}

// Appends to the mesh queue the positions of threads whose path `waits`. Every thread of the block must call it.
__device__ inline void put_position(const MeshQueue& queue, bool waits, std::uint32_t position) {
    const std::uint32_t place = append_by_block(&queue.counts->waiting, waits);
    if (waits) {
        queue.positions[place] = position;
    }
}

}  // namespace pt::cuda
