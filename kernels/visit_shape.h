// Finds an object's shape by its number: the one place that knows in which order the kinds of shapes are numbered. Code
// that needs an object's shape passes a generic function.
#pragma once

#include "kernels/scene_view.h"
#include "kernels/widen.h"

namespace pt {

PT_HD constexpr bool is_last(ShapeKind kind) { return static_cast<std::uint32_t>(kind) + 1 == shape_count; }

// Whether a kernel has no kind of shape after this one. Where meshes are the last kind, kernels without them end with
// the kind before.
PT_HD constexpr bool is_last(ShapeKind kind, FeatureSet features) {
    constexpr bool ends_with_meshes = is_last(ShapeKind::mesh);
    return is_last(kind) || (ends_with_meshes && static_cast<std::uint32_t>(kind) + 2 == shape_count &&
                             !contains(features, Feature::mesh));
}

// Shape number i of an array. A kernel that is compiled for a scene's numbers of objects ignores the index if there is
// only one shape of the kind.
template <class Config, class Shapes>
PT_HD inline decltype(auto) shape_in(const Shapes& shapes, std::uint32_t i) {
#if defined(__CUDA_ARCH__)
    if constexpr (!has_everything(Config::features)) {
        return shapes[shapes.size == 1 ? 0 : i];
    }
#endif
    return shapes[i];
}

// Calls visit(shape) with the object's shape: a Sphere, Ellipsoid, and so on. Kinds of shapes that the kernel lacks
// cost nothing, and their objects are not visited. The last kind takes all objects that are left, without a comparison.
template <class Config, class Scene, class Visitor>
PT_HD inline void visit_shape(const Scene& scene, std::uint32_t object, Visitor&& visit) {
#define PT_VISIT(name, array, Type)                                                                \
    if (has<Config>(Feature::name) &&                                                              \
        (is_last(ShapeKind::name, Config::features) || object < end_of<ShapeKind::name>(scene))) { \
        visit(shape_in<Config>(scene.array, object - first_of<ShapeKind::name>(scene)));           \
    } else
    PT_SHAPES(PT_VISIT) {}
#undef PT_VISIT
}

// Whether an object is flat: a surface without an inside.
template <class Scene>
PT_HD inline bool is_flat(const Scene& scene, std::uint32_t object) {
    bool flat = false;
#define PT_IS_FLAT(name, array, Type)                                                           \
    if constexpr (Type<float>::is_flat) {                                                       \
        flat = flat || (object >= first_of<ShapeKind::name>(scene) &&                           \
                        (is_last(ShapeKind::name) || object < end_of<ShapeKind::name>(scene))); \
    }
    PT_SHAPES(PT_IS_FLAT)
#undef PT_IS_FLAT
    return flat;
}

// A configuration with every shape, for code that is compiled once for all scenes.
template <class Real>
using EveryShape = Config<Real, shape_features>;

}  // namespace pt
