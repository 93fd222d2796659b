// Every shape of the list (kernels/shape_list.h), whole: a shape's header has the name of its line.
#pragma once

#include "kernels/shape.h"

// PT_PICK_n is the name of the list's n-th header. An #include takes a macro, but no loop, hence one line for each
// place.
#define PT_STEM(name, array, Type) name,
#define PT_PICK_0(a, ...) a
#define PT_PICK_1(a, b, ...) b
#define PT_PICK_2(a, b, c, ...) c
#define PT_PICK_3(a, b, c, d, ...) d
#define PT_PICK_4(a, b, c, d, e, ...) e
#define PT_PICK_5(a, b, c, d, e, f, ...) f
#define PT_PICK_6(a, b, c, d, e, f, g, ...) g
#define PT_PICK_7(a, b, c, d, e, f, g, h, ...) h
#define PT_PICK_8(a, b, c, d, e, f, g, h, i, ...) i
#define PT_PICK_9(a, b, c, d, e, f, g, h, i, j, ...) j
#define PT_PICK_10(a, b, c, d, e, f, g, h, i, j, k, ...) k
#define PT_PICK_11(a, b, c, d, e, f, g, h, i, j, k, l, ...) l
#define PT_PICK_12(a, b, c, d, e, f, g, h, i, j, k, l, m, ...) m
#define PT_PICK(n, ...) PT_PICK_##n(__VA_ARGS__)
#define PT_QUOTED(path) #path
// clang-format off
#define PT_FILE_NAMED(name) PT_QUOTED(kernels/shapes/name.h)
// clang-format on
#define PT_FILE_OF(name) PT_FILE_NAMED(name)
#define PT_FILE_AT(n, ...) PT_FILE_OF(PT_PICK(n, __VA_ARGS__))
#define PT_SHAPE_FILE(n) \
    PT_FILE_AT(n, PT_SHAPES(PT_STEM) none, none, none, none, none, none, none, none, none, none, none, none, none, none)

#include PT_SHAPE_FILE(0)
#include PT_SHAPE_FILE(1)
#include PT_SHAPE_FILE(2)
#include PT_SHAPE_FILE(3)
#include PT_SHAPE_FILE(4)
#include PT_SHAPE_FILE(5)
#include PT_SHAPE_FILE(6)
#include PT_SHAPE_FILE(7)
#include PT_SHAPE_FILE(8)
#include PT_SHAPE_FILE(9)
#include PT_SHAPE_FILE(10)
#include PT_SHAPE_FILE(11)
#include PT_SHAPE_FILE(12)

#undef PT_STEM

namespace pt {

static_assert(shape_count <= 13, "kernels/shapes.h includes, and kernels/config.h has bits for, 13 shapes");

// The class of a kind of shape.
template <ShapeKind kind, class Real>
struct ShapeOfKind;
#define PT_SHAPE_OF(name, array, Type)          \
    template <class Real>                       \
    struct ShapeOfKind<ShapeKind::name, Real> { \
        using Shape = Type<Real>;               \
    };
PT_SHAPES(PT_SHAPE_OF)
#undef PT_SHAPE_OF
template <ShapeKind kind, class Real>
using ShapeOf = typename ShapeOfKind<kind, Real>::Shape;

// The kinds of shapes that are no image of a unit shape, and that a matrix kernel meets as any kernel does.
#define PT_UNLESS_UNIT(name, array, Type) \
    | (Type<float>::unit_shape == UnitShape::none ? static_cast<FeatureSet>(Feature::name) : no_features)
inline constexpr FeatureSet shapes_without_matrix = no_features PT_SHAPES(PT_UNLESS_UNIT);
#undef PT_UNLESS_UNIT

}  // namespace pt
