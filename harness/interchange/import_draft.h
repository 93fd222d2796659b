// The draft of a scene that is imported from another program's file: its parts, each with its place in the source, and
// the meshes and images to be written beside it.
#pragma once

#include <deque>
#include <map>
#include <string>

#include "harness/interchange/affine.h"
#include "harness/interchange/import_parts.h"
#include "harness/interchange/import_result.h"
#include "harness/mesh/mesh.h"

namespace pt {

class ImportDraft {
public:
    ImportDraft(const ImportSource& source, ImportResult& result) : source_(source), result_(&result) {}

    ImportFindings& problems() { return result_->problems; }
    ImportFindings& warnings() { return result_->warnings; }
    ImportFindings& notes() { return result_->notes; }
    ImportResult& result() { return *result_; }
    const ImportSource& source() const { return source_; }
    SceneParts parts;

    // A place in the source file for messages: the line (0: unknown) and the text that stands there.
    const Cis565Line* place(std::size_t line, const std::string& text);
    void refuse(const Cis565Line& place, const std::string& allowed);

    // Sets the scene's name: the caller's, else `wanted` if it is valid as a name, else the file's name.
    void begin(const std::string& wanted, const Cis565Line* head);

    // Adds the camera's eye, look_at and up, which are accepted or rejected together.
    void add_view(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, const Cis565Line* at);

    // Adds a material to the draft under a unique name made from `name`. Returns the material's number.
    std::size_t add_material(ScenePart part, const std::string& name);
    const std::string& material_name_of(std::size_t material) const { return parts.materials[material].name; }

    // Adds an object of a shape in scene files' own units. Returns false, and reports a problem, if scene files cannot
    // express the placement.
    bool add_shape(const std::string& shape, const Affine& placed, std::size_t material, const Cis565Line* at);
    // Adds an object that shows a mesh file. If scene files cannot express the placement, the mesh is transformed and
    // kept as a new file. `has_normals`: the object is shaded with vertex normals.
    bool add_mesh(const std::string& file, const Affine& placed, std::size_t material, const Cis565Line* at,
                  bool has_normals = false);
    // Keeps a mesh that is to be written beside the scene, and returns its file name.
    std::string keep_mesh(const Mesh& mesh);
    // Keeps an image file's content that is to be written beside the scene, and returns its name in the scene. `ending`
    // is the file extension with its dot.
    std::string keep_image(const std::string& content, const std::string& ending);
    // Whether a material has a texture, so that its objects need texture coordinates.
    bool shows_image(std::size_t material) const;

    // Finds the path of a file that the source names, and the name by which the scene file refers to a path.
    std::string path_of(const std::string& named) const;
    std::string name_in_scene(const std::string& path) const;

    // Validates the draft of an imported scene. Returns the scene if it has no problems.
    std::optional<Scene> checked();
    void finish();

private:
    ScenePart object(const std::string& shape, std::size_t material, const Cis565Line* at) const;
    void add_placement(ScenePart& object, const TranslateRotateScale& parts, const Cis565Line* at);
    // Keeps a mesh transformed by an affine map as a file beside the scene, and returns its name. Returns nothing,
    // after reporting a problem, if no triangle is left.
    std::optional<std::string> keep_placed(const std::string& file, const Affine& placed, bool has_normals,
                                           const Cis565Line* at);

    const ImportSource& source_;
    ImportResult* result_;
    std::deque<Cis565Line> places_;
    std::map<std::string, Mesh> read_;  // meshes that were read to be transformed, by path of the source's mesh file
    std::map<std::string, int> names_;  // by material name, the number that makes its next use unique
};

}  // namespace pt
