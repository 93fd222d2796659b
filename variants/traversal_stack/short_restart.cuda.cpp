#include "variants/acceleration/reasons.h"
#include "variants/registry.h"

namespace pt::traversal_stack::short_restart {
namespace {

constexpr Tunable tunables[] = {
    {"short_entries", 4, 1, 32, 1, "entries of a thread's stack, in shared memory, as far as 32 KiB a block hold them"},
};

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    Reason reason = needs_steps(scene, variant);
    if (reason.empty() && !variant.accelerator.leaves_trail) {
        return {"needs_trail",
                "finds its way by a trail: needs two children a node or an order of children that no hit "
                "changes, not accelerator=" +
                    std::string(variant.accelerator.name)};
    }
    return reason;
}

const Registration registration(
    {
        .axis = "traversal_stack",
        .name = "short_restart",
        .summary = "a few entries, and a trail of bits to find the way from the root again",
        .origin = "Laine 2010",
        .backends = on_cuda,
        .tunables = tunables,
        .unsupported_reason = unsupported_reason,
    },
    {});

}  // namespace
}  // namespace pt::traversal_stack::short_restart
