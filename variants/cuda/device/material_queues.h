// Queues of paths by the type of material that their rays have met, all in one store. A queue is a list of chunks of
// the store, each of some blocks' slots, so that the queues together need hardly more memory than one; a block takes
// paths of one queue. For NVRTC, nvcc and the host compiler alike.
#pragma once

#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/surface_kinds.h"
#include "variants/cuda/device/totals.h"

namespace pt::cuda {

// A chunk has the slots of so many blocks. A block that appends to a new chunk waits while another block finds the
// chunk its place: the more slots a chunk has, the fewer blocks wait.
inline constexpr std::uint32_t blocks_per_chunk = 16;

// The queues of paths whose rays of one segment have been traced.
template <class Real>
struct MaterialQueues {
    PathStore paths;
    StoredHit<Real>* hits = nullptr;  // hits of the paths' rays, by slot
    // At q * counter_stride the number of queue q's paths, for each queue; then, as for one queue more, the number of
    // chunks that have a place in the store.
    std::uint32_t* counts = nullptr;
    // Place in the store of chunk i of queue q, plus 1, at q * chunks_per_queue + i; 0: the chunk has none yet.
    std::uint32_t* chunks = nullptr;
    std::uint32_t chunks_per_queue = 0;
};

// Whether paths that their hit ends go into a queue of their own. With next-event estimation the light that they meet
// costs something to weigh, so it is worth it that whole warps do so; else they are shaded at once.
constexpr bool keeps_ended_paths(FeatureSet features, bool by_material) {
    return by_material && contains(features, Feature::next_event);
}

// The kinds of paths that kernels with these features keep apart, of which the first may be that of paths that their
// hit ends.
constexpr SurfaceKinds kinds_of_hits(FeatureSet features, bool by_material) {
    return SurfaceKinds::of(features, by_material, keeps_ended_paths(features, by_material) ? 1 : 0);
}
constexpr std::uint32_t kinds_of_paths(FeatureSet features, bool by_material) {
    const std::uint32_t of_hits = kinds_of_hits(features, by_material).count;
    return (of_hits == 0 ? 1 : of_hits) + (keeps_ended_paths(features, by_material) ? 1 : 0);
}

}  // namespace pt::cuda
