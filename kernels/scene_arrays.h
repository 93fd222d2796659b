// The arrays of a scene, listed once: all code that sizes, copies, bakes or places them expands this list, in its order
// where that matters, as in constant memory.
#pragma once

#include "kernels/scene_view.h"

namespace pt {

enum class ArrayKind : std::uint32_t {
    objects,    // objects of one kind of shape; every ray reads them
    traced,     // array by object index that every ray reads
    matrix,     // array by object index that every ray of a kernel with Feature::matrix reads; unused by others
    shading,    // array by object index, read where a ray has hit
    shared,     // array by an index of its own, not by object, read where a ray has hit
    selection,  // array read where a light is chosen, by kernels with one of light_selections; unused by others
    texture     // array read where a ray has hit, by kernels with Feature::textures; unused by others
};

struct SceneArray {
    const char* name;  // name of the member of SceneView
    ArrayKind kind;

    PT_HD constexpr bool is_used(FeatureSet features) const {
        return kind == ArrayKind::matrix      ? contains(features, Feature::matrix)
               : kind == ArrayKind::selection ? (features & light_selections) != 0
               : kind == ArrayKind::texture   ? contains(features, Feature::textures)
                                              : true;
    }
    // Whether every ray of a kernel with the given features reads the array.
    PT_HD constexpr bool is_traced(FeatureSet features) const { return is_used(features) && kind < ArrayKind::shading; }
};

// ARRAY(name, kind, word): the list of arrays for code that needs their names, one macro per kind. The word is in the
// name of the constant that tells a kernel the array's size: PT_SPHERES, baked::material_count.
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
