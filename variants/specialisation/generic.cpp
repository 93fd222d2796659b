// One kernel for every scene: all primitive kinds, materials and features compiled in and chosen at run time.
#include "variants/registry.h"

namespace pt {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "generic",
        .summary = "one kernel with every feature, chosen at run time",
        .origin = "the usual renderer",
        .reference = on_every_backend,
        .backends = on_every_backend,
    },
    {.specialisation = [](const KernelOffer&, const Variant&, Backend) { return all_features; }});

}  // namespace
}  // namespace pt
