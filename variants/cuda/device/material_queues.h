// Queues of paths by the type of material that their rays have met, all in one store. A queue is a list of chunks of
// the store, each with a slot for every thread of a block, so a block takes a chunk and shades paths of one type, and
// the queues together need hardly more memory than one. For NVRTC, nvcc and the host compiler alike.
#pragma once

#include "kernels/material_list.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/totals.h"

namespace pt::cuda {

// A chunk of a queue that has no place in the store yet.
inline constexpr std::uint32_t no_chunk = 0xffffffffu;

template <class Real>
struct MaterialQueues {
    PathStore paths;
    StoredHit<Real>* hits = nullptr;  // hits of the paths' rays, by slot
    std::uint32_t* chunks = nullptr;  // chunk of the store that is chunk i of queue q, at q * chunks_per_queue + i
    std::uint32_t* counts = nullptr;  // number of queue q's paths at q * counter_stride; last, of chunks handed out
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
