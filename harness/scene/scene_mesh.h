// Meshes as scenes show them: made or read once, in canonical order, placed where an object stands.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "harness/mesh/mesh.h"
#include "harness/scene/scene.h"
#include "variants/bvh/binary_tree.h"

namespace pt {

// Canonical order, hash, and whether it is closed. `source`: for messages and results. `with_normals`: those of its
// vertices are asked for.
std::shared_ptr<const SceneMesh> make_scene_mesh(const Mesh& mesh, const std::string& source,
                                                 bool with_normals = false);
// The mesh of a file or a generator, kept for the whole process: files are read again only when their time or size has
// changed. Throws InputError for a file or a size that is none. Normals of generators are computed
// (harness/mesh/vertex_normals.h).
std::shared_ptr<const SceneMesh> mesh_from_file(const std::filesystem::path& file, bool with_normals = false);
std::shared_ptr<const SceneMesh> mesh_from_generator(const std::string& name, std::uint32_t size,
                                                     bool with_normals = false);

// While one lives, mesh_from_file has these meshes, by path, whether or not they are written yet. One at a time.
class MeshesToBe {
public:
    using Meshes = std::map<std::string, std::shared_ptr<const SceneMesh>>;
    explicit MeshesToBe(Meshes meshes);
    ~MeshesToBe();
    MeshesToBe(const MeshesToBe&) = delete;
    MeshesToBe& operator=(const MeshesToBe&) = delete;
};

// The triangles of a mesh where an object stands, relative to the eye: transformed in double, rounded once.
std::vector<Triangle<float>> placed_triangles(const SceneMesh& mesh, const Placement& placement);

// A box round a triangle: its coordinates are numbers of single precision, so it is exact.
Box box_round(const Triangle<float>& triangle);
// A box round all triangles of a mesh, as a placement moves them: rounded outward.
Box box_round(const SceneMesh& mesh, const Placement& placement);

// Whether a point lies inside a closed mesh, in the mesh's own space: by how often a ray from it crosses the mesh.
bool is_inside(const SceneMesh& mesh, const Vec3d& point);

}  // namespace pt
