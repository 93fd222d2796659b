// All materials of the list (kernels/material_list.h), and an object's material as kernels read it. A material's header
// has the name of its line in the list; its parameters are a class with
//   scatter(at)                static, of a material with the trait by_surface, or else
//   scatter(at, material)      at a path vertex (kernels/scattering.h); returns whether the path goes on.
#pragma once

#include "kernels/material_list.h"
#include "kernels/pick_header.h"

#define PT_STEM(name, Type, traits) name,
#define PT_MATERIAL_FILE(n) PT_FILE_AT(n, materials, PT_MATERIALS(PT_STEM) PT_NO_MORE)

#include PT_MATERIAL_FILE(0)
#include PT_MATERIAL_FILE(1)
#include PT_MATERIAL_FILE(2)
#include PT_MATERIAL_FILE(3)
#include PT_MATERIAL_FILE(4)
#include PT_MATERIAL_FILE(5)
#include PT_MATERIAL_FILE(6)
#include PT_MATERIAL_FILE(7)
#include PT_MATERIAL_FILE(8)
#include PT_MATERIAL_FILE(9)
#include PT_MATERIAL_FILE(10)

#undef PT_STEM

namespace pt {

static_assert(material_type_count <= 11,
              "kernels/materials.h includes, and kernels/config.h has bits for, 11 materials");

// One material as kernels read it.
template <class Real>
struct Material {
    MaterialType type;
    std::uint32_t emits;    // 1 if the material's emission is not black
    Vec3<Real> emission;    // radiance that the material emits, linear RGB
    Vec3<Real> sigma_a;     // absorption coefficient of the medium behind the surface, 1 / scene unit
    std::uint32_t absorbs;  // 1 if the medium behind the surface lets rays run through and absorbs (sigma_a is not 0)
    // Parameters of the material: the member of the union for its type is in use.
#define PT_PARAMETERS(name, Type, traits) Type<Real> name;
    union {
        PT_MATERIALS(PT_PARAMETERS)
    };
#undef PT_PARAMETERS
};

}  // namespace pt
