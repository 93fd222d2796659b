// Paths of a queue whose rays go on through meshes: the kernel that traces a path a thread meets the scene's other
// shapes and the root of each tree, and lists the paths that enter one; persistent warps work the list off. For NVRTC,
// nvcc and the host compiler alike.
#pragma once

#include "kernels/intersect.h"
#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/list_counts.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

// A path in the list: its ray, what the ray meets among the other shapes, and where the path is in the queue. Side by
// side, for warps fetch neighbours.
template <class Real>
struct alignas(16) WaitingPath {
    Ray<Real> ray;
    Real t;
    SurfaceId side;
    std::uint32_t position;
};
static_assert(sizeof(WaitingPath<float>) == 48);

// A list with room for every position of the queue. Null where the traversal needs no kernel of its own.
template <class Real>
struct MeshQueue {
    WaitingPath<Real>* paths = nullptr;
    ListCounts* counts = nullptr;
};

// Parameters of the kernel for the listed paths. With `keys`, it also writes the sort key of each.
template <class Real>
struct IntersectMeshesParameters {
    static constexpr const char* kernel = "intersect_meshes";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // null: slot i at position i
    MeshQueue<Real> queue;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // slots; read by keys by chunk only
    KeyBounds bounds;
};

}  // namespace pt::cuda
