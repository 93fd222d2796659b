// The shapes, listed once: all code that does something for each of them expands this list. A shape is a header in
// kernels/shapes/ and a line in this list (docs/add_a_shape.md); objects are numbered by kind, in line order.
#pragma once

#include <cstdint>

// SHAPE(name, array, Type, WORD, more): name of the shape's header and of its Feature, array of SceneView that holds
// the shape's objects, class, and the word in PT_WORD, the constant that tells a kernel how many objects there are.
// `more` is passed on unchanged, for macros that need further arguments.
#define PT_SHAPES_WITH(SHAPE, more)                                        \
    SHAPE(sphere, spheres, Sphere, SPHERES, more)                          \
    SHAPE(ellipsoid, ellipsoids, Ellipsoid, ELLIPSOIDS, more)              \
    SHAPE(axis_box, axis_boxes, AxisBox, AXIS_BOXES, more)                 \
    SHAPE(oriented_box, oriented_boxes, OrientedBox, ORIENTED_BOXES, more) \
    SHAPE(quad, quads, Quad, QUADS, more)                                  \
    SHAPE(mesh, meshes, MeshInstance, MESHES, more)

// The list of shapes without the word: SHAPE(name, array, Type) for each.
#define PT_SHAPES(SHAPE) PT_SHAPES_WITH(PT_SHAPE_ALONE, SHAPE)
#define PT_SHAPE_ALONE(name, array, Type, WORD, SHAPE) SHAPE(name, array, Type)

namespace pt {

#define PT_SHAPE_KIND(name, array, Type) name,
enum class ShapeKind : std::uint32_t { PT_SHAPES(PT_SHAPE_KIND) };
#undef PT_SHAPE_KIND

#define PT_COUNT(name, array, Type) +1u
inline constexpr std::uint32_t shape_count = 0u PT_SHAPES(PT_COUNT);
#undef PT_COUNT

}  // namespace pt
