// No first-bounce cache: every sample traces its camera ray.
#include "variants/registry.h"

namespace pt::first_bounce::off {
namespace {

const Registration registration(
    {
        .axis = "first_bounce",
        .name = "off",
        .summary = "every sample traces its camera ray",
        .origin = "cis565, cache off",
        .baseline = on_every_backend,
        .traits = FirstBounceTraits{.keeps_hits = false},
        .backends = on_every_backend,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.cache_fills + work.cache_hits == 0 ? "" : "a cache was used";
        },
    },
    {.first_bounce = [](const Variant&, Backend) { return 0u; }});

}  // namespace
}  // namespace pt::first_bounce::off
