// Intersection in double precision within kernels that are in single precision otherwise: every object, the ray and the
// hit are widened, intersected by the same functions, and rounded again. The scene keeps the single precision numbers
// that it was loaded with, so this mends the rounding of the intersection alone (docs/numerics.md S13, S14).
#pragma once

#include "kernels/scene_view.h"

namespace pt {

PT_HD inline Vec3<float> narrowed(const Vec3<double>& v) { return Vec3<float>(v); }

template <class Body>
struct WideView {
    const Body* data;
    std::uint32_t size;

    PT_HD auto operator[](std::uint32_t i) const { return widened(data[i]); }
};

template <class Body>
PT_HD inline WideView<Body> wide_view(const View<Body>& view) {
    return {view.data, view.size};
}

// A scene in single precision as the functions of intersect.h read it in double.
struct WideScene {
#define PT_WIDE_VIEW(name, array, Type) WideView<Type<float>> array;
    PT_SHAPES(PT_WIDE_VIEW)
#undef PT_WIDE_VIEW
    WideView<Vec3<float>> velocity;

    PT_HD explicit WideScene(const SceneView<float>& scene)
        :
#define PT_WIDEN(name, array, Type) array(wide_view(scene.array)),
          PT_SHAPES(PT_WIDEN)
#undef PT_WIDEN
              velocity(wide_view(scene.velocity)) {
    }
};

// The configuration of a kernel's intersection when that is done in double.
template <class Kernel>
using InDouble = Config<double, Kernel::features & ~static_cast<FeatureSet>(Feature::double_intersection),
                        typename Kernel::Accelerator>;

}  // namespace pt
