// Meshes as scenes show them: loaded or generated once, sorted into a canonical order, and placed by objects.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "harness/mesh/mesh.h"
#include "harness/scene/scene.h"
#include "variants/bvh/binary_tree.h"

namespace pt {

// Makes a SceneMesh from a mesh: sorts its triangles into canonical order, hashes them, and finds out whether the mesh
// is closed. `source` names the mesh in messages and results. `with_normals` asks for vertex normals.
std::shared_ptr<const SceneMesh> make_scene_mesh(const Mesh& mesh, const std::string& source,
                                                 bool with_normals = false);
// Loads a mesh file or runs a mesh generator, and keeps the result for the whole process. A file is read again only if
// its time or size has changed. Normals of generated meshes are computed (harness/mesh/vertex_normals.h). Throws
// InputError for a bad file, generator or size.
std::shared_ptr<const SceneMesh> mesh_from_file(const std::filesystem::path& file, bool with_normals = false);
std::shared_ptr<const SceneMesh> mesh_from_generator(const std::string& name, std::uint32_t size,
                                                     bool with_normals = false);

// While a MeshesToBe lives, `mesh_from_file` finds its meshes by path, written yet or not. Only one may live at a time.
class MeshesToBe {
public:
    using Meshes = std::map<std::string, std::shared_ptr<const SceneMesh>>;
    explicit MeshesToBe(Meshes meshes);
    ~MeshesToBe();
    MeshesToBe(const MeshesToBe&) = delete;
    MeshesToBe& operator=(const MeshesToBe&) = delete;
};

// The triangles of a mesh as an object places them, relative to the camera's eye: transformed in double, rounded once.
std::vector<Triangle<float>> placed_triangles(const SceneMesh& mesh, const Placement& placement);

// Bounding box of a triangle; exact, since corners and boxes are both in single precision.
Box box_round(const Triangle<float>& triangle);
// Bounding box of a mesh as an object places it, rounded outward.
Box box_round(const SceneMesh& mesh, const Placement& placement);

// Whether a point in the mesh's own space lies inside the closed mesh, by a ray cast from the point.
bool is_inside(const SceneMesh& mesh, const Vec3d& point);

}  // namespace pt
