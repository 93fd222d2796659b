// Looks up a variant's accelerator, builder and levels in the registry. Only this file of the scene code depends on the
// registry: a program that is linked without it has brute force only.
#include "harness/scene/mesh_geometry.h"
#include "variants/registry.h"

namespace pt {

Acceleration Acceleration::of(const Variant& variant, Backend backend) {
    const Registry& registry = Registry::instance();
    Acceleration acceleration{variant[axes::accelerator],
                              variant[axes::builder],
                              registry.at(axes::accelerator, variant, backend).hook.accelerator,
                              registry.at(axes::builder, variant, backend).hook.builder,
                              variant[axes::levels],
                              registry.at(axes::levels, variant, backend).hook.levels};
    if (backend != Backend::cpu) {
        acceleration.accelerator_hook.prepare = nullptr;
    }
    return acceleration;
}

}  // namespace pt
