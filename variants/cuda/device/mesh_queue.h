// Paths of a queue whose rays go on through meshes: the kernel that traces a path a thread meets the scene's other
// shapes and the root of each tree, and lists the paths that enter one; persistent warps work the list off. For NVRTC,
// nvcc and the host compiler alike.
#pragma once

#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/list_counts.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

// A list with room for every position of the queue. Null where the traversal needs no kernel of its own.
struct MeshQueue {
    std::uint32_t* positions = nullptr;
    ListCounts* counts = nullptr;
};

// Parameters of the kernel for the paths at the listed positions, whose hits among the other shapes are in `hits`. With
// `keys`, it also writes the sort key of each.
template <class Real>
struct IntersectMeshesParameters {
    static constexpr const char* kernel = "intersect_meshes";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // null: slot i at position i
    MeshQueue queue;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // slots; read by keys by chunk only
    KeyBounds bounds;
};

}  // namespace pt::cuda
