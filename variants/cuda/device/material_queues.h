// Queues of paths by the type of material that their rays have met, all in one store. A queue is a list of chunks of
// the store, each of some blocks' slots, so that the queues together need hardly more memory than one; a block takes
// paths of one queue. For NVRTC, nvcc and the host compiler alike.
#pragma once

#include "kernels/material_list.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/totals.h"

namespace pt::cuda {

// Blocks' worth of slots in a chunk. Whoever appends waits where another block is about to find a new chunk its place:
// the more slots a chunk has, the fewer wait.
inline constexpr std::uint32_t blocks_per_chunk = 16;

// The queues of paths whose rays of one segment have been traced.
template <class Real>
struct MaterialQueues {
    PathStore paths;
    StoredHit<Real>* hits = nullptr;  // hits of the paths' rays, by slot
    // Number of queue q's paths at q * counter_stride, then of chunks that have a place at that of one more queue.
    std::uint32_t* counts = nullptr;
    // Place in the store of chunk i of queue q, plus 1, at q * chunks_per_queue + i; 0: the chunk has none yet.
    std::uint32_t* chunks = nullptr;
    std::uint32_t chunks_per_queue = 0;
};

// The number of kinds of paths that kernels with these features keep apart: one for each material type that does not
// end paths, or one for all; and with next-event estimation one of paths whose hit ends them.
constexpr std::uint32_t kinds_of_paths(FeatureSet features, bool by_material) {
    using namespace material_trait;
    std::uint32_t kinds = 0;
#define PT_COUNT_KIND(name, Type, traits)                                  \
    if (((traits)&ends_paths) == 0 && contains(features, Feature::name)) { \
        kinds += by_material || kinds == 0 ? 1u : 0u;                      \
    }
    PT_MATERIALS(PT_COUNT_KIND)
#undef PT_COUNT_KIND
    return (kinds == 0 ? 1u : kinds) + (by_material && contains(features, Feature::next_event) ? 1u : 0u);
}

}  // namespace pt::cuda
