// Kinds of paths by the material type that they have hit: paths of one kind are shaded together. For NVRTC, nvcc and
// the host compiler alike.
#pragma once

#include "kernels/config.h"
#include "kernels/material_list.h"

namespace pt::cuda {

// Kinds of paths that hit a surface, by material type: 4 bits per type.
struct SurfaceKinds {
    std::uint64_t table = 0;
    std::uint32_t count = 0;

    // The kinds in kernels with these features, numbered from `others` on: one for each material type that does not end
    // paths; one for all of them unless `by_material`.
    static constexpr SurfaceKinds of(FeatureSet features, bool by_material, std::uint32_t others) {
        using namespace material_trait;
        SurfaceKinds kinds;
#define PT_ADD_KIND(name, Type, traits)                                         \
    if (((traits)&ends_paths) == 0 && contains(features, Feature::name)) {      \
        kinds.count += by_material || kinds.count == 0 ? 1u : 0u;               \
        kinds.table |= static_cast<std::uint64_t>(others + kinds.count - 1)     \
                       << (4 * static_cast<std::uint32_t>(MaterialType::name)); \
    }
        PT_MATERIALS(PT_ADD_KIND)
#undef PT_ADD_KIND
        return kinds;
    }
};

}  // namespace pt::cuda
