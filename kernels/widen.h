// Intersection in double precision within kernels that are in single precision otherwise: every object, the ray and
// the hit are widened, met by the same functions, and rounded again. The scene's numbers stay the single ones that it
// was loaded with, so what this mends is the rounding of the intersection itself (docs/numerics.md S13, S14).
#pragma once

#include "kernels/scene_view.h"

namespace pt {

PT_HD inline Vec3<double> widened(const Vec3<float>& v) { return Vec3<double>(v); }
PT_HD inline Vec3<float> narrowed(const Vec3<double>& v) { return Vec3<float>(v); }

PT_HD inline Sphere<double> widened(const Sphere<float>& s) {
    return {widened(s.centre), s.radius, 1.0 / static_cast<double>(s.radius), s.eye_power, s.is_near_eye};
}
PT_HD inline AxisBox<double> widened(const AxisBox<float>& box) { return {widened(box.low), widened(box.high)}; }
PT_HD inline OrientedBox<double> widened(const OrientedBox<float>& box) {
    return {widened(box.centre), {widened(box.axis[0]), widened(box.axis[1]), widened(box.axis[2])}, widened(box.half)};
}
PT_HD inline Quad<double> widened(const Quad<float>& q) {
    return {widened(q.centre), widened(q.normal), widened(q.axis_u), widened(q.axis_v), q.half_u, q.half_v};
}

// The inverse is formed anew: rounded to single precision it is not the inverse of the axes.
PT_HD inline Ellipsoid<double> widened(const Ellipsoid<float>& e) {
    Ellipsoid<double> wide{
        widened(e.centre), {widened(e.semi_axis[0]), widened(e.semi_axis[1]), widened(e.semi_axis[2])}, {}};
    for (int i = 0; i < 3; ++i) {
        const Vec3<double> area = cross(wide.semi_axis[(i + 1) % 3], wide.semi_axis[(i + 2) % 3]);
        wide.inverse_axis[i] = area * (1.0 / dot(wide.semi_axis[i], area));
    }
    return wide;
}

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
    WideView<Sphere<float>> spheres;
    WideView<Ellipsoid<float>> ellipsoids;
    WideView<AxisBox<float>> axis_boxes;
    WideView<OrientedBox<float>> oriented_boxes;
    WideView<Quad<float>> quads;
    WideView<Vec3<float>> velocity;

    PT_HD explicit WideScene(const SceneView<float>& scene)
        : spheres(wide_view(scene.spheres)),
          ellipsoids(wide_view(scene.ellipsoids)),
          axis_boxes(wide_view(scene.axis_boxes)),
          oriented_boxes(wide_view(scene.oriented_boxes)),
          quads(wide_view(scene.quads)),
          velocity(wide_view(scene.velocity)) {}

    PT_HD std::uint32_t first_ellipsoid() const { return spheres.size; }
    PT_HD std::uint32_t first_axis_box() const { return first_ellipsoid() + ellipsoids.size; }
    PT_HD std::uint32_t first_oriented_box() const { return first_axis_box() + axis_boxes.size; }
    PT_HD std::uint32_t first_quad() const { return first_oriented_box() + oriented_boxes.size; }
};

// The same kernel with its intersection in double.
template <class Kernel>
using InDouble = Config<double, Kernel::features & ~static_cast<FeatureSet>(Feature::double_intersection)>;

}  // namespace pt
