// Bounding boxes in scene space of a mesh instance, wide enough for every hit that a kernel can report. Rounding errors
// arise when a ray is transformed into the instance's space, in the triangle test (kernels/triangle.h), and when the
// hit is named by its t: the point o + t d of the scene may lie off the triangle by all of them together. Higham's
// gamma(n) bounds each ("Accuracy and Stability of Numerical Algorithms", 3.1); the part that grows with the distance
// of the ray origin is kept apart.
#pragma once

#include "harness/scene/scene.h"
#include "kernels/scene_view.h"

namespace pt {

// Motion of an object while the shutter is open: constant velocity between two times.
struct Sweep {
    Vec3d velocity{0.0};
    double first_time = 0, last_time = 0;
};

class InstanceBoxes {
public:
    // Prepares the bounding boxes of a mesh instance that moves by `sweep`. `own` is the bounding box of the mesh in
    // the instance's own space, or in scene space if the mesh is placed there.
    template <class Real>
    InstanceBoxes(const MeshInstance<Real>& instance, const Box& own, const Sweep& sweep);

    // Bounding box of the whole instance in scene space.
    Box box() const;
    // Bounding box, in scene space, of one triangle, for ray origins with coordinates up to `farthest_origin`.
    Box box(const Triangle<float>& triangle, double farthest_origin) const;
    // The part of the bounding box's margin that grows with ray origins, in multiples of their largest coordinate.
    double margin_by_origin() const { return margin_by_origin_; }

private:
    Vec3d in_scene(const Vec3d& own) const;
    void set_inverse();
    void set_margins();
    // Extends a bounding box over the instance's motion and grows it by margins for rounding errors, rounding outward.
    Box swept(const Vec3d& low, const Vec3d& high, double margin_of_origins) const;

    double row_[3][3], inverse_[3][3];  // matrix from scene space into the instance's own, and its inverse
    Vec3d offset_;
    Box own_;
    Sweep sweep_;
    Vec3d margin_;  // margin for rounding errors of the instance's bounding boxes by axis, for ray origins at 0
    double margin_by_origin_ = 0;
};

// The largest coordinate, up to `last_time` before or after time 0, that a ray origin of the scene can have on a
// surface, inside a body or on the camera's lens.
template <class Real>
double farthest_origin(const SceneView<Real>& scene, double last_time);

}  // namespace pt
