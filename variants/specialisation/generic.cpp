// The choice specialisation=generic: one kernel for every scene; shapes, materials and features are chosen at run time.
#include "variants/specialisation/smallest_superset.h"

namespace pt::specialisation::generic {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "generic",
        .summary = "one kernel with every feature, chosen at run time",
        .origin = "the usual renderer",
        .reference = on_cpu,
        .traits = SpecialisationTraits{.is_generic = true},
        .backends = on_every_backend,
    },
    {.specialisation = [](const KernelOffer& offer, const Variant&, Backend) { return every_feature(offer); }});

}  // namespace
}  // namespace pt::specialisation::generic
