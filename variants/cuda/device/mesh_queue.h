// Paths of a queue whose rays go on through meshes: the kernel with one thread per path intersects the other shapes and
// the root of each mesh's tree, and lists the paths that enter one; persistent warps work off the list. For NVRTC, nvcc
// and the host compiler alike.
#pragma once

#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/list_counts.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

// Block size of the kernel that works off the mesh queue, in programs of `block` threads per block. Seven blocks of 128
// leave a thread 72 registers, which hold a ray's state without spills (H200: 0.97 of the time with 64 registers).
inline constexpr std::uint32_t most_fetching_threads = 128;
PT_HD constexpr std::uint32_t fetching_block(std::uint32_t block) {
    return block < most_fetching_threads ? block : most_fetching_threads;
}
PT_HD constexpr std::uint32_t fetching_blocks_at_once(std::uint32_t block, std::size_t real_bytes) {
    return static_cast<std::uint32_t>(7 * most_fetching_threads * sizeof(float) / real_bytes) / fetching_block(block);
}

// List of the queue positions of rays that enter a mesh, with room for all. Null: no kernel takes rays through meshes.
struct MeshQueue {
    std::uint32_t* positions = nullptr;
    ListCounts* counts = nullptr;
};

// Parameters of the kernel that takes the paths at the listed positions through meshes; their hits among the other
// shapes are in `hits`. With `keys`, the kernel also writes their sort keys.
template <class Real>
struct IntersectMeshesParameters {
    static constexpr const char* kernel = "intersect_meshes";
    static constexpr std::uint32_t most_threads = most_fetching_threads;
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // slots of paths by queue position; null: slot i is at position i
    MeshQueue queue;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // number of slots in a chunk of the queue, for sort keys by chunk only
    KeyBounds bounds;
};

}  // namespace pt::cuda
