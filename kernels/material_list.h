// The kinds of materials, listed once: everybody who does something for each of them goes by this list. A material is
// a header in kernels/materials/, a file in harness/scene/materials/ and a line here (docs/add_a_material.md).
#pragma once

#include <cstdint>

namespace pt {

// What a kernel, or whoever chooses one, has to know of a kind of material without looking into its header.
namespace material_trait {
inline constexpr std::uint32_t ends_paths = 1;   // it emits, and reflects nothing
inline constexpr std::uint32_t by_surface = 2;   // all that shading needs stands in Surface, one read of 16 bytes
inline constexpr std::uint32_t is_delta = 4;     // each direction is sent into one or two others
inline constexpr std::uint32_t connects = 8;     // its lobe is wide enough, or may be, to be connected to lights
inline constexpr std::uint32_t has_inside = 16;  // rays may run within the body that it bounds
inline constexpr std::uint32_t has_walks = 32;   // paths walk through its body (kernels/materials/subsurface.h)
}  // namespace material_trait

// MATERIAL(name, Type, traits): the name of its header, of its Feature and in scene files, the class of its parameters,
// and what of material_trait it has. Materials are asked for in the order of the lines, those that are by_surface
// first.
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

// Whether a kind of material has any of these traits.
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
