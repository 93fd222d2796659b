// Includes all shapes of the list (kernels/shape_list.h); a shape's header has the name of its line.
#pragma once

#include "kernels/pick_header.h"
#include "kernels/shape.h"

#define PT_STEM(name, array, Type) name,
#define PT_SHAPE_FILE(n) PT_FILE_AT(n, shapes, PT_SHAPES(PT_STEM) PT_NO_MORE)

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

// ShapeOf<kind, Real> is the class of a kind of shape.
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

// Features of shapes that are no image of a unit shape: a matrix kernel intersects them as any kernel does.
#define PT_UNLESS_UNIT(name, array, Type) \
    | (Type<float>::unit_shape == UnitShape::none ? static_cast<FeatureSet>(Feature::name) : no_features)
inline constexpr FeatureSet shapes_without_matrix = no_features PT_SHAPES(PT_UNLESS_UNIT);
#undef PT_UNLESS_UNIT

}  // namespace pt
