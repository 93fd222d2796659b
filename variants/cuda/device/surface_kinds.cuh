// Kinds of paths by the material type that they have hit: paths of one kind are shaded together.
#pragma once

#include "variants/cuda/device/device.cuh"

// Kinds of paths that hit a surface, by material type: 4 bits per type. Only types that these kernels have are told
// apart, and only where tuned::by_material asks for it.
struct SurfaceKinds {
    std::uint64_t table = 0;
    std::uint32_t count = 0;

    __device__ static constexpr SurfaceKinds after(std::uint32_t others) {
        using namespace pt::material_trait;
        SurfaceKinds kinds;
#define PT_ADD_KIND(name, Type, traits)                                             \
    if (((traits)&ends_paths) == 0 && pt::has<Configuration>(pt::Feature::name)) {  \
        kinds.count += tuned::by_material != 0 || kinds.count == 0 ? 1u : 0u;       \
        kinds.table |= static_cast<std::uint64_t>(others + kinds.count - 1)         \
                       << (4 * static_cast<std::uint32_t>(pt::MaterialType::name)); \
    }
        PT_MATERIALS(PT_ADD_KIND)
#undef PT_ADD_KIND
        return kinds;
    }
};
