#include "harness/bench/fastest.h"

namespace pt {

namespace {

std::vector<std::string> integrators_by_speed(Backend backend) {
    return backend == Backend::cpu ? std::vector<std::string>{"packet", "depth_first"}
                                   : std::vector<std::string>{"persistent", "megakernel"};
}

}  // namespace

Variant fastest_variant(const AxisChoices& axes, const TunableValues& tunables, FeatureSet scene, Backend backend) {
    for (const std::string& integrator : integrators_by_speed(backend)) {
        AxisChoices tried = axes;
        tried[std::string(integrator_axis)] = {integrator};
        const Variant variant = expand(tried, backend, tunables).front();
        if (why_not_applicable(variant, scene, backend).empty()) {
            return variant;
        }
    }
    return expand(axes, backend, tunables).front();
}

}  // namespace pt
