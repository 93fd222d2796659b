// The choice direct_light=off: light is found by chance only, and counts where a path hits it.
#include "variants/registry.h"

namespace pt::direct_light::off {
namespace {

const Registration registration(
    {
        .axis = "direct_light",
        .name = "off",
        .summary = "light is met by BSDF sampling only",
        .origin = "Kajiya 1986",
        .baseline = on_every_backend,
        .traits = DirectLightTraits{.connects = false},
        .backends = on_every_backend,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.connections == 0 ? "" : "connected vertices to lights";
        },
    },
    {});

}  // namespace
}  // namespace pt::direct_light::off
