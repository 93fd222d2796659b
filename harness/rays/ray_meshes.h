// The meshes that ray batches are traced through: a mesh of the OptiX probe, a generated mesh in a box, a mesh from a
// file, or all meshes of a scene; and the camera of the primary rays.
#pragma once

#include <string>
#include <vector>

#include "harness/mesh/mesh.h"
#include "kernels/triangle.h"

namespace pt::rays {

struct RayCamera {
    Vec3<float> eye, right, up, forward;  // direction of a primary ray: right x + up y + forward, with x, y in [-1, 1]
};

struct RayMesh {
    std::string name;
    std::string said;  // remark on the mesh, to print; may be empty
    Mesh mesh;
    std::vector<Triangle<float>> triangles;
    RayCamera camera;
    Vec3<float> low, high;  // bounding box of the mesh
};

// Loads the mesh that an argument names: a mesh of the OptiX probe ("sphere_262k"), a generator and its size
// ("icosphere:3"), or a file. Throws InputError.
RayMesh mesh_for_rays(const std::string& argument);
// Loads a generated mesh or a mesh file, without the box that is put around a mesh for a camera.
RayMesh mesh_without_box(const std::string& argument);
// Collects the triangles of all meshes in a scene, relative to the eye. Throws InputError if there are none.
RayMesh scene_for_rays(const std::string& name_or_file);

}  // namespace pt::rays
