// What batches of rays are traced through: a mesh of the OptiX probe, a generator's in a box like the probe's, one of a
// file, or the meshes of a scene; and the camera of the primary rays.
#pragma once

#include <string>
#include <vector>

#include "harness/mesh/mesh.h"
#include "kernels/triangle.h"

namespace pt::rays {

struct RayCamera {
    Vec3<float> eye, right, up, forward;  // a ray goes along right x + up y + forward, x and y from -1 to 1
};

struct RayMesh {
    std::string name;
    std::string said;  // what a reader should know about it; may be empty
    Mesh mesh;
    std::vector<Triangle<float>> triangles;
    RayCamera camera;
    Vec3<float> low, high;  // its bounds
};

// The mesh that an argument names: "sphere_262k" (one of probe_mesh_names), "icosphere:3" (a generator and its size) or
// a file's name. Throws InputError.
RayMesh mesh_for_rays(const std::string& argument);
// The mesh of a generator or a file, without a box for a camera.
RayMesh mesh_without_box(const std::string& argument);
// The triangles of all objects that are meshes, where they stand relative to the eye. Throws InputError where there is
// none.
RayMesh scene_for_rays(const std::string& name_or_file);

}  // namespace pt::rays
