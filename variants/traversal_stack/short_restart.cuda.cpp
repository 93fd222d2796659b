#include "variants/acceleration/reasons.h"
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
