// What a choice of the axes `accelerator` and `builder` brings, as functions that the harness calls.
#pragma once

#include <memory>
#include <span>

#include "kernels/intersect.h"
#include "variants/acceleration/encoded_tree.h"

namespace pt {

struct BuilderHook {
    // `triangles`: those that the boxes are round, for builders that split them. The same tree on any number of cores.
    BinaryTree (*build)(const PrimitiveBoxes& boxes, std::span<const Triangle<float>> triangles) = nullptr;
};

// What an accelerator of the host makes of a mesh for itself: MeshView::native.
struct NativeMesh {
    std::shared_ptr<const void> data;
    std::uint64_t bytes = 0;
};

struct AcceleratorHook {
    // In the accelerator's format; null: it needs no tree, and slots are primitives.
    EncodedTree (*encode)(const BinaryTree& tree) = nullptr;
    // On the host alone; null: the tree and its leaves are enough.
    NativeMesh (*prepare)(const EncodedTree& tree, std::span<const LeafTriangle> leaves) = nullptr;
    MeetMesh<float> meet_single = nullptr;
    MeetMesh<double> meet_double = nullptr;
};

// A ray through a mesh on the host, by the traversal that kernels of a device have compiled in.
template <class Traversal, class Real>
void meet_mesh(Hit<Real>& best, const MeshInstance<Real>& mesh, std::uint32_t object, const Vec3<Real>& origin,
               const Ray<Real>& ray) {
    NoTraversalCounter counter;
    closest_in_mesh<Traversal>(best, mesh, object, origin, ray, counter);
}

template <class Traversal>
AcceleratorHook accelerator_hook(EncodedTree (*encode)(const BinaryTree& tree)) {
    return {encode, nullptr, &meet_mesh<Traversal, float>, &meet_mesh<Traversal, double>};
}

}  // namespace pt
