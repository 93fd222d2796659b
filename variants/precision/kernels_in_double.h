// What the choices that compute in double precision on the CPU have in common. They exist only for integrators that are
// compiled in double (cmake/variants.cmake, integrators_in_double).
#pragma once

#include "variants/registry.h"

namespace pt {

inline Reason needs_kernel_in_double(const VariantTraits& variant) {
    const Choice* integrator = Registry::instance().find(axes::integrator, variant.integrator.name, Backend::cpu);
    if (integrator != nullptr && !integrator->hook.integrator_in_double.empty()) {
        return {};
    }
    return {"needs_path_at_a_time", "is compiled for a path at a time: needs integrator=depth_first, not " +
                                        std::string(variant.integrator.name)};
}

}  // namespace pt
