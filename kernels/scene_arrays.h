// The arrays of a scene, listed once: who sizes, copies, bakes or places them goes by this list, and where their order
// matters, as in constant memory, by the list's.
#pragma once

#include "kernels/scene_view.h"

namespace pt {

enum class ArrayKind : std::uint32_t {
    objects,    // of one kind; every ray reads them
    traced,     // by object number; every ray reads it
    matrix,     // by object number; every ray of a kernel with Feature::matrix reads it, others have no use for it
    shading,    // by object number; read where a ray has hit
    shared,     // by numbers of its own; read where a ray has hit
    selection,  // read where a light is drawn by a kernel with one of light_selections, others have no use for it
    texture     // read where a ray has hit by a kernel with Feature::textures, others have no use for it
};

struct SceneArray {
    const char* name;  // as in SceneView
    ArrayKind kind;

    PT_HD constexpr bool is_used(FeatureSet features) const {
        return kind == ArrayKind::matrix      ? contains(features, Feature::matrix)
               : kind == ArrayKind::selection ? (features & light_selections) != 0
               : kind == ArrayKind::texture   ? contains(features, Feature::textures)
                                              : true;
    }
    // Whether every ray of a kernel with these features reads the array.
    PT_HD constexpr bool is_traced(FeatureSet features) const { return is_used(features) && kind < ArrayKind::shading; }
};

// ARRAY(name, kind, word): the list for who needs the names in program text, a macro a kind. The word is in the name of
// the constant that tells a kernel how many there are: PT_SPHERES, baked::material_count.
#define PT_OBJECT_ARRAYS(ARRAY) PT_SHAPES_WITH(PT_ARRAY_OF_SHAPE, ARRAY)
#define PT_ARRAY_OF_SHAPE(name, array, Type, WORD, ARRAY) ARRAY(array, objects, WORD)
#define PT_TRACED_ARRAYS(ARRAY) ARRAY(velocity, traced, OBJECTS)
#define PT_MATRIX_ARRAYS(ARRAY) ARRAY(transforms, matrix, OBJECTS)
#define PT_SHADING_ARRAYS(ARRAY)             \
    ARRAY(object_material, shading, OBJECTS) \
    ARRAY(surfaces, shading, OBJECTS)
#define PT_SHARED_ARRAYS(ARRAY)        \
    ARRAY(materials, shared, material) \
    ARRAY(lights, shared, light)
#define PT_SELECTION_ARRAYS(ARRAY)          \
    ARRAY(object_light, selection, OBJECTS) \
    ARRAY(light_slots, selection, light)    \
    ARRAY(light_nodes, selection, light_nodes)
#define PT_TEXTURE_ARRAYS(ARRAY)             \
    ARRAY(object_textures, texture, OBJECTS) \
    ARRAY(texels, texture, texels)           \
    ARRAY(texture_coordinates, texture, texture_coordinates)
#define PT_SCENE_ARRAYS(ARRAY) \
    PT_OBJECT_ARRAYS(ARRAY)    \
    PT_TRACED_ARRAYS(ARRAY)    \
    PT_MATRIX_ARRAYS(ARRAY)    \
    PT_SHADING_ARRAYS(ARRAY)   \
    PT_SHARED_ARRAYS(ARRAY)    \
    PT_SELECTION_ARRAYS(ARRAY) \
    PT_TEXTURE_ARRAYS(ARRAY)

// Calls visit(SceneArray, array) for every array of a scene: a SceneView, or what has members of the same names.
template <class Scene, class Visit>
PT_HD constexpr void for_each_array(Scene& scene, Visit&& visit) {
#define PT_VISIT(name, kind, word) visit(SceneArray{#name, ArrayKind::kind}, scene.name);
    PT_SCENE_ARRAYS(PT_VISIT)
#undef PT_VISIT
}

// Calls visit(SceneArray, array of the first, array of the second) for every array of two scenes side by side.
template <class First, class Second, class Visit>
PT_HD constexpr void for_each_array(First& first, Second& second, Visit&& visit) {
#define PT_VISIT(name, kind, word) visit(SceneArray{#name, ArrayKind::kind}, first.name, second.name);
    PT_SCENE_ARRAYS(PT_VISIT)
#undef PT_VISIT
}

}  // namespace pt
