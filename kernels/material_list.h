// The material types, listed once: all code that does something for each of them expands this list. A material is a
// header in kernels/materials/, a file in harness/scene/materials/ and a line in this list (docs/add_a_material.md).
#pragma once

#include <cstdint>

namespace pt {

// Traits of a material type that a kernel, or code that chooses one, must know without the type's header.
namespace material_trait {
inline constexpr std::uint32_t ends_paths = 1;   // the material emits light and reflects none
inline constexpr std::uint32_t by_surface = 2;   // shading reads only struct Surface, 16 bytes, and not the material
inline constexpr std::uint32_t is_delta = 4;     // specular: each direction is scattered into one or two others
inline constexpr std::uint32_t connects = 8;     // the lobe is wide enough, or may be, to be connected to lights
inline constexpr std::uint32_t has_inside = 16;  // rays may run inside the body that the material bounds
inline constexpr std::uint32_t has_walks = 32;   // paths do random walks in the body (kernels/materials/subsurface.h)
}  // namespace material_trait

// MATERIAL(name, Type, traits): name of the header, of the Feature and in scene files, class of the parameters, and
// traits (material_trait). Kernels test the material types in the order of these lines, those with by_surface first.
#define PT_MATERIALS(MATERIAL)                                                 \
    MATERIAL(diffuse, DiffuseMaterial, by_surface | connects)                  \
    MATERIAL(emitter, EmitterMaterial, ends_paths)                             \
    MATERIAL(mirror, MirrorMaterial, by_surface | is_delta)                    \
    MATERIAL(mix, MixMaterial, connects)                                       \
    MATERIAL(dielectric, DielectricMaterial, is_delta | has_inside)            \
    MATERIAL(rough_conductor, RoughConductorMaterial, connects)                \
    MATERIAL(rough_dielectric, RoughDielectricMaterial, connects | has_inside) \
    MATERIAL(principled, PrincipledMaterial, connects | has_inside)            \
    MATERIAL(subsurface, SubsurfaceMaterial, has_inside | has_walks)

#define PT_MATERIAL_TYPE(name, Type, traits) name,
enum class MaterialType : std::uint32_t { PT_MATERIALS(PT_MATERIAL_TYPE) };
#undef PT_MATERIAL_TYPE

// Whether a material type has any of the traits in the set `wanted`.
constexpr bool has_trait(MaterialType type, std::uint32_t wanted) {
    using namespace material_trait;
#define PT_TRAITS(name, Type, traits) (traits),
    const std::uint32_t traits_of[] = {PT_MATERIALS(PT_TRAITS)};
#undef PT_TRAITS
    return (traits_of[static_cast<std::uint32_t>(type)] & wanted) != 0;
}

#define PT_COUNT(name, Type, traits) +1u
inline constexpr std::uint32_t material_type_count = 0u PT_MATERIALS(PT_COUNT);
#undef PT_COUNT

}  // namespace pt
