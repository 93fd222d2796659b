// The traversal stack `shared`: the first entries in shared memory, which is as fast as the first-level cache but not
// in its way, the rest in local memory. Ylitie, Karras, Laine, HPG 2017, section 4.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: the traversal stack, which NVRTC compiles

#include "variants/bvh/stacks.h"
#include "variants/traversal_stack/shared_column.cuh"

namespace pt::traversal_stack::shared {

template <class Open, std::uint32_t most>
struct Memory {
    static constexpr std::uint32_t first = shared_entries<Open>(tuned::shared_entries);
    static_assert(first < most);
    SharedColumn<Open, first> column;
    Open rest[most - first];

    PT_HD Open get(std::uint32_t i) const { return i < first ? column.get(i) : rest[i - first]; }
    PT_HD void set(std::uint32_t i, const Open& open) {
        if (i < first) {
            column.set(i, open);
        } else {
            rest[i - first] = open;
        }
    }
};

template <class Open, std::uint32_t most>
using Stack = FullStack<Open, Memory<Open, most>>;

}  // namespace pt::traversal_stack::shared

#endif

#if defined(PT_HOST)  // host part of this file: the traversal stack's descriptor

#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::traversal_stack::shared {
namespace {

constexpr Tunable tunables[] = {
    {"shared_entries", 8, 1, 32, 1, "entries of a thread's stack in shared memory, as far as 32 KiB a block hold them"},
};

const Registration registration(
    {
        .axis = "traversal_stack",
        .name = "shared",
        .summary = "the first entries in shared memory, the rest in local memory",
        .origin = "Ylitie, Karras and Laine 2017",
        .backends = on_cuda,
        .tunables = tunables,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal_stack::shared

#endif
