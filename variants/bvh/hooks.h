// The functions of a choice of the axes `accelerator`, `builder` and `levels`, for the harness to call.
#pragma once

#include <memory>
#include <span>

#include "kernels/intersect.h"
#include "variants/bvh/encoded_tree.h"
#include "variants/cpu/host_mesh.h"

namespace pt {

struct BuilderHook {
    // Builds a tree over boxes, the same on any number of cores. `triangles` in the boxes are for builders that split
    // them.
    BinaryTree (*build)(const PrimitiveBoxes& boxes, std::span<const Triangle<float>> triangles) = nullptr;
};

// What an accelerator on the host, such as Embree, makes of a mesh for itself (MeshView::native).
struct NativeMesh {
    std::shared_ptr<const HostMesh> data;
    std::uint64_t bytes = 0;
};

// Returns what an accelerator prepared for an object's mesh, with the type that the accelerator's `prepare` made.
template <class Mesh>
const Mesh& mesh_of(const MeshInstance<float>& instance) {
    return static_cast<const Mesh&>(*static_cast<const HostMesh*>(instance.geometry.native));
}

struct AcceleratorHook {
    // Encodes a binary tree in the accelerator's format; null: the accelerator needs no tree, and slots are primitives.
    EncodedTree (*encode)(const BinaryTree& tree) = nullptr;
    // Prepares a mesh on the host; null: the tree and its leaves are enough.
    NativeMesh (*prepare)(const EncodedTree& tree, std::span<const LeafTriangle> leaves) = nullptr;
    MeetMesh<float> meet_single = nullptr;
    MeetMesh<double> meet_double = nullptr;
    // Searches all objects with meshes by one tree over their triangles; null: the accelerator has its own trees.
    MeetMeshes<float> meet_flat_single = nullptr;
    MeetMeshes<double> meet_flat_double = nullptr;
};

// What a choice of the axis `levels` brings: how a ray searches the objects with meshes, as by a two-level BVH.
struct LevelsHook {
    // Builds the top-level tree (TLAS) over the boxes of objects, one object a leaf; null: there is no such tree.
    std::vector<ObjectNode> (*build)(const PrimitiveBoxes& boxes) = nullptr;
    MeetMeshes<float> meet_single = nullptr;
    MeetMeshes<double> meet_double = nullptr;
    bool is_flat = false;  // the choice searches one tree over all objects' triangles, by the accelerator's meet_flat
};

// Kernel configuration for mesh searches on the host. Kernels are compiled with or without motion, but mesh searches
// always with it: on an object at rest both find the same hit.
template <class Traversal, class Real>
using SearchConfig = Config<Real, Feature::mesh | Feature::motion, Traversal>;

template <class Traversal, class Real>
void meet_flat(Hit<Real>& best, const SceneView<Real>& scene, const Ray<Real>& ray, Real enough) {
    closest_by_flat_tree<SearchConfig<Traversal, Real>>(best, scene, scene.meshes, ray, NearerThan<Real>{enough});
}

// Traces a ray through a mesh on the host, by an accelerator's `Traversal`, which GPU kernels have compiled in as well.
template <class Traversal, class Real>
void meet_mesh(Hit<Real>& best, const MeshInstance<Real>& mesh, std::uint32_t object, const Vec3<Real>& origin,
               const Ray<Real>& ray, Real enough) {
    NoTraversalCounter counter;
    closest_in_mesh<Traversal>(best, mesh, object, origin, ray, counter, NearerThan<Real>{enough});
}

template <class Traversal>
AcceleratorHook accelerator_hook(EncodedTree (*encode)(const BinaryTree& tree)) {
    return {encode,
            nullptr,
            &meet_mesh<Traversal, float>,
            &meet_mesh<Traversal, double>,
            &meet_flat<Traversal, float>,
            &meet_flat<Traversal, double>};
}

}  // namespace pt
