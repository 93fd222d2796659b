// Paths of a queue whose rays go on through meshes: the kernel that traces a path a thread meets the scene's other
// shapes and the root of each tree, and lists the paths that enter one; persistent warps work the list off. For NVRTC,
// nvcc and the host compiler alike.
#pragma once

#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/device/list_counts.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

// Threads of a block of the kernel that works the list off, in programs of so many a block. Seven blocks of 128 leave a
// thread 72 registers, which hold a ray's state without spills (H200: 0.97 of the time with 64).
inline constexpr std::uint32_t most_fetching_threads = 128;
PT_HD constexpr std::uint32_t fetching_block(std::uint32_t block) {
    return block < most_fetching_threads ? block : most_fetching_threads;
}
PT_HD constexpr std::uint32_t fetching_blocks_at_once(std::uint32_t block, std::size_t real_bytes) {
    return static_cast<std::uint32_t>(7 * most_fetching_threads * sizeof(float) / real_bytes) / fetching_block(block);
}

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
    static constexpr std::uint32_t most_threads = most_fetching_threads;
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
