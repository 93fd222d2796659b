// The parts of the scene file that a text file's sections become, and where scene files do not allow what they hold.
#pragma once

#include <string>
#include <vector>

#include "harness/interchange/import_findings.h"
#include "harness/interchange/import_lines.h"
#include "harness/interchange/import_result.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

// A key of an object in the scene file.
struct SceneMember {
    std::string key, value;            // the value is JSON
    const Cis565Line* line = nullptr;  // that the value comes from
    std::string stand_in = "";         // a value that is allowed; empty: the value itself is
    bool is_of_view = false;           // its stand-in is allowed beside those of the other members of the view
};

struct ScenePart {
    std::string place;                 // e.g. "$.camera"
    std::string name = "";             // of a material
    const Cis565Line* head = nullptr;  // of its section
    bool is_whole = true;              // false: a line could not be read, and its member is not there
    std::vector<SceneMember> members;

    void add(const std::string& key, const std::string& value, const Cis565Line* line,
             const std::string& stand_in = "") {
        members.push_back({.key = key, .value = value, .line = line, .stand_in = stand_in});
    }
    // The part's members as JSON, "KEY": VALUE, .., with a separator between them.
    std::string members_json(const std::string& separator) const;
    // The part as a JSON object.
    std::string json() const;
};

struct SceneParts {
    ScenePart root;  // what is in no other part
    ScenePart camera;
    std::vector<ScenePart> materials, objects;

    std::string json() const;
};

// The letters, digits, '_' and '-' of a text, up to 64 of them: what a name in a scene file may have.
std::string plain_part_of(const std::string& text);
std::string json_of(double value);
std::string json_of(const Vec3d& v);
std::string json_of(const std::string& text);
// A colour that is an image, by the name that the scene file has for it; is_image_in_scene tells whether a
// member's value is one.
std::string image_in_scene(const std::string& name);
bool is_image_in_scene(const std::string& value);
// Adds a mesh that is to be written beside the scene file, and called after it; returns its name there.
std::string add_imported_mesh(ImportResult& result, const ImportSource& source, Mesh mesh);
// All meshes that are to be written, by the paths that they will have.
MeshesToBe::Meshes imported_meshes(const ImportResult& result, const std::string& scene_file);
// Warns of a mesh file, once of each file, at the line that names it first.
void warn_of_mesh(ImportResult& result, std::size_t line, const std::filesystem::path& file,
                  const std::vector<std::string>& warnings);
// The name that a material has in the scene file: its own, or material_LABEL.
std::string material_name(const Cis565Section& section);

// What scene files do not allow is a problem of the line that it comes from. `file`: the scene's, which names of meshes
// are relative to.
void check_parts(const SceneParts& parts, const std::string& file, ImportFindings& problems);

}  // namespace pt
