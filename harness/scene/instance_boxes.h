// Boxes in the scene round what an instance's own space holds, wide enough for every hit there. A ray is taken into
// that space with roundings, met by kernels/triangle.h with more, and named by its t: the point o + t d of the scene
// may lie off the triangle by all of them together. Higham's gamma(n) bounds each ("Accuracy and Stability of Numerical
// Algorithms", 3.1); what grows with the distance of the ray's origin is kept apart.
#pragma once

#include "harness/scene/scene.h"
#include "kernels/scene_view.h"

namespace pt {

// How an object moves while the shutter is open.
struct Sweep {
    Vec3d velocity{0.0};
    double first_time = 0, last_time = 0;
};

class InstanceBoxes {
public:
    // Boxes of an instance that moves by `sweep`. `own`: bounds in the instance's own space, which is the scene's where
    // the mesh is placed.
    template <class Real>
    InstanceBoxes(const MeshInstance<Real>& instance, const Box& own, const Sweep& sweep);

    // A box round all of the instance.
    Box box() const;
    // A box round a triangle of the instance, for rays whose origins have no coordinate beyond `farthest_origin`.
    Box box(const Triangle<float>& triangle, double farthest_origin) const;
    // By how much a box must grow besides, in multiples of the largest coordinate of a ray's origin.
    double margin_by_origin() const { return margin_by_origin_; }

private:
    Vec3d in_scene(const Vec3d& own) const;
    void set_inverse();
    void set_margins();
    // A box moved along the instance's way and grown, rounded outward.
    Box swept(const Vec3d& low, const Vec3d& high, double margin_of_origins) const;

    double row_[3][3], inverse_[3][3];  // into the instance's own space, and back
    Vec3d offset_;
    Box own_;
    Sweep sweep_;
    Vec3d margin_;  // of origins at 0
    double margin_by_origin_ = 0;
};

// The largest coordinate that the origin of a ray can have, on a surface, inside a body or on the lens, up to a time
// after or before 0.
template <class Real>
double farthest_origin(const SceneView<Real>& scene, double last_time);

}  // namespace pt
