// A scene under way from another program's file: its parts, each with the place it comes from, and the meshes that are
// to be written beside it.
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

    // A place in the source for messages: a line (0: the file has none to tell) and what stands there.
    const Cis565Line* place(std::size_t line, const std::string& text);
    void refuse(const Cis565Line& place, const std::string& allowed);

    // The scene's name: the call's, else `wanted` if it can be one, else of the file.
    void begin(const std::string& wanted, const Cis565Line* head);

    // Adds the view of the camera, whose parts are allowed or not together.
    void add_view(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, const Cis565Line* at);

    // Adds a material under a name that no other one has. Returns the material's number.
    std::size_t add_material(ScenePart part, const std::string& name);
    const std::string& material_name_of(std::size_t material) const { return parts.materials[material].name; }

    // Adds an object of a shape whose own space is that of scene files. False, and a problem, where scene files have no
    // such placement.
    bool add_shape(const std::string& shape, const Affine& placed, std::size_t material, const Cis565Line* at);
    // Adds an object of a mesh in a file; a mesh that is placed in a way that scene files lack becomes a file of its
    // own. `has_normals`: it is shaded with those of its vertices.
    bool add_mesh(const std::string& file, const Affine& placed, std::size_t material, const Cis565Line* at,
                  bool has_normals = false);
    // Keeps a mesh that is to be written beside the scene; returns the name to add it by.
    std::string keep_mesh(const Mesh& mesh);
    // Keeps an image file's content that is to be written beside the scene; `ending` with its dot. Returns the name
    // that the scene has for it.
    std::string keep_image(const std::string& content, const std::string& ending);
    // Whether a material shows an image, and so needs texture coordinates.
    bool shows_image(std::size_t material) const;

    // The path of a file that the source names, and the name by which the scene has a file.
    std::string path_of(const std::string& named) const;
    std::string name_in_scene(const std::string& path) const;

    // Checks the parts; the scene where nothing is wrong with them.
    std::optional<Scene> checked();
    void finish();

private:
    ScenePart object(const std::string& shape, std::size_t material, const Cis565Line* at) const;
    void add_placement(ScenePart& object, const TranslateRotateScale& parts, const Cis565Line* at);
    // Keeps the mesh in the shape that a map gives it, as a file beside the scene, and returns its name there. Nothing,
    // and told, where that leaves no triangle.
    std::optional<std::string> keep_placed(const std::string& file, const Affine& placed, bool has_normals,
                                           const Cis565Line* at);

    const ImportSource& source_;
    ImportResult* result_;
    std::deque<Cis565Line> places_;
    std::map<std::string, Mesh> read_;  // meshes to place anew, by path
    std::map<std::string, int> names_;  // of materials, and which number comes next for a further one
};

}  // namespace pt
