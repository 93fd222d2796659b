#include "variants/acceleration/reasons.h"
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
