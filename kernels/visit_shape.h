// From an object's number to its shape, whatever that is: the one place that knows in which order the kinds of shapes
// are numbered. Who wants to do something with an object's shape hands a generic function over.
#pragma once

#include "kernels/scene_view.h"
#include "kernels/widen.h"

namespace pt {

// Calls visit(shape) with the object's shape: a Sphere, Ellipsoid, AxisBox, OrientedBox or Quad. Kinds that the kernel
// has not leave nothing behind; an object of such a kind is not visited.
template <class Config, class Scene, class Visitor>
PT_HD inline void visit_shape(const Scene& scene, std::uint32_t object, Visitor&& visit) {
    if (has<Config>(Feature::sphere) && object < scene.first_ellipsoid()) {
        visit(scene.spheres[object]);
    } else if (has<Config>(Feature::ellipsoid) && object < scene.first_axis_box()) {
        visit(scene.ellipsoids[object - scene.first_ellipsoid()]);
    } else if (has<Config>(Feature::axis_box) && object < scene.first_oriented_box()) {
        visit(scene.axis_boxes[object - scene.first_axis_box()]);
    } else if (has<Config>(Feature::oriented_box) && object < scene.first_quad()) {
        visit(scene.oriented_boxes[object - scene.first_oriented_box()]);
    } else if (has<Config>(Feature::quad)) {
        visit(scene.quads[object - scene.first_quad()]);
    }
}

// The same for code that is compiled once, for every scene.
template <class Real>
using EveryShape = Config<Real, shape_features>;

}  // namespace pt
