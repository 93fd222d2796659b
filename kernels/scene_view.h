// A scene as flat arrays, ready for a kernel on either side. Objects are numbered by kind, in the order of the arrays
// below, and canonically within a kind: an object's number does not depend on its place in the scene file.
#pragma once

#include "kernels/axis_aligned_enclosure.h"
#include "kernels/box.h"
#include "kernels/camera.h"
#include "kernels/material.h"
#include "kernels/quad.h"
#include "kernels/sphere.h"
#include "kernels/transform.h"

namespace pt {

// An object that emits, for sampling points on it.
struct Light {
    std::uint32_t object;
};

template <class Real>
struct SceneView {
    View<Sphere<Real>> spheres;
    View<Ellipsoid<Real>> ellipsoids;
    View<AxisBox<Real>> axis_boxes;
    View<OrientedBox<Real>> oriented_boxes;
    View<Quad<Real>> quads;
    View<Transform<Real>> transforms;     // by object number; only for kernels with Feature::matrix
    View<std::uint32_t> object_material;  // by object number
    View<Surface<Real>> surfaces;         // by object number
    View<Vec3<Real>> velocity;            // by object number, scene units a second
    View<Material<Real>> materials;
    View<Light> lights;
    Vec3<Real> environment;  // radiance of rays that leave the scene
    Camera<Real> camera;
    AxisAlignedEnclosure<Real> enclosure;  // that the axis boxes make
    RandomSeed seed;
    std::uint32_t depth;           // ray segments in a path, at least 1
    std::uint32_t final_bounce;    // 1: connect the last vertex to a light
    std::uint32_t next_event;      // 1: connect every diffuse vertex but the last to a light
    std::uint32_t mis_exponent;    // 0: lights count where connected only; 1: balance heuristic, 2: power heuristic
    std::uint32_t roulette_start;  // Russian roulette from the vertex at the end of this segment on; 0: none

    PT_HD std::uint32_t first_ellipsoid() const { return spheres.size; }
    PT_HD std::uint32_t first_axis_box() const { return first_ellipsoid() + ellipsoids.size; }
    PT_HD std::uint32_t first_oriented_box() const { return first_axis_box() + axis_boxes.size; }
    PT_HD std::uint32_t first_quad() const { return first_oriented_box() + oriented_boxes.size; }
    PT_HD std::uint32_t object_count() const { return first_quad() + quads.size; }
    PT_HD std::uint32_t pixel_count() const { return camera.width * camera.height; }
    // Segments that the longest path can have: with a final bounce, a path whose last vertex is specular goes one
    // further.
    PT_HD std::uint32_t longest_path() const { return depth + final_bounce; }
};

}  // namespace pt
