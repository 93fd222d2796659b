// The traversal stack short_restart: a few entries in shared memory and no more; a walk that has dropped one finds its
// way from the root by a trail of bits. Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010; for compressed
// wide trees after Vaidyanathan, Woop, Benthin, "Wide BVH Traversal with a Short Stack", HPG 2019.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: the traversal stack, which NVRTC compiles

#include "variants/bvh/stacks.h"
#include "variants/traversal_stack/shared_column.cuh"

namespace pt::traversal_stack::short_restart {

template <class Open>
inline constexpr std::uint32_t entries = shared_entries<Open>(tuned::short_entries);

template <class Open, std::uint32_t>
using Stack = typename ShortStackFor<Open, SharedColumn<Open, entries<Open>>, entries<Open>>::Type;

}  // namespace pt::traversal_stack::short_restart

#endif

#if defined(PT_HOST)  // host part of this file: the traversal stack's descriptor

#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::traversal_stack::short_restart {
namespace {

constexpr Tunable tunables[] = {
    {"short_entries", 4, 1, 32, 1, "entries of a thread's stack, in shared memory, as far as 32 KiB a block hold them"},
};

const Registration registration(
    {
        .axis = "traversal_stack",
        .name = "short_restart",
        .summary = "a few entries, and a trail of bits to find the way from the root again",
        .origin = "Laine 2010",
        .backends = on_cuda,
        .tunables = tunables,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal_stack::short_restart

#endif
