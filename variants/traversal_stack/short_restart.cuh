// A few entries in shared memory and no more; a walk that has lost one finds its way from the root by a trail of bits.
// Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010; of compressed wide trees after Vaidyanathan, Woop,
// Benthin, "Wide BVH Traversal with a Short Stack", HPG 2019.
#pragma once

#include "variants/acceleration/stacks.h"
#include "variants/traversal_stack/shared_column.cuh"

namespace pt::traversal_stack::short_restart {

template <class Open>
inline constexpr std::uint32_t entries = shared_entries<Open>(tuned::short_entries);

template <class Open, std::uint32_t>
using Stack = typename ShortStackFor<Open, SharedColumn<Open, entries<Open>>, entries<Open>>::Type;

}  // namespace pt::traversal_stack::short_restart
