// Parts of the scene file that an importer builds, and their validation, which reports problems at lines of the source.
#pragma once

#include <string>
#include <vector>

#include "harness/interchange/import_findings.h"
#include "harness/interchange/import_lines.h"
#include "harness/interchange/import_result.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

// A key and its value in a JSON object of the scene file under construction.
struct SceneMember {
    std::string key, value;            // the member's value as JSON text
    const Cis565Line* line = nullptr;  // source line that the member's value comes from
    std::string stand_in = "";         // valid value to replace a faulty one in further checks; empty: none needed
    bool is_of_view = false;           // whether the member is eye, look_at or up, which are replaced together
};

struct ScenePart {
    std::string place;                 // JSON path of the part in the scene file, such as "$.camera"
    std::string name = "";             // name of the material that the part describes; empty for other parts
    const Cis565Line* head = nullptr;  // first source line of the section that the part comes from
    bool is_whole = true;              // false: the part lacks a member whose source line was unreadable
    std::vector<SceneMember> members;

    void add(const std::string& key, const std::string& value, const Cis565Line* line,
             const std::string& stand_in = "") {
        members.push_back({.key = key, .value = value, .line = line, .stand_in = stand_in});
    }
    // Members of a part of the scene file as JSON, "KEY": VALUE, .., joined by a separator.
    std::string members_json(const std::string& separator) const;
    // A part of the scene file as the text of a JSON object.
    std::string json() const;
};

struct SceneParts {
    ScenePart root;  // members at the top level of the scene file
    ScenePart camera;
    std::vector<ScenePart> materials, objects;

    std::string json() const;
};

// Makes a text fit for a name in a scene file: keeps letters, digits, '_' and '-', at most 64 of them.
std::string plain_part_of(const std::string& text);
std::string json_of(double value);
std::string json_of(const Vec3d& v);
std::string json_of(const std::string& text);
// Makes the JSON value of a colour that is a texture, by the texture's file name; and tests for such a value.
std::string image_in_scene(const std::string& name);
bool is_image_in_scene(const std::string& value);
// Adds a mesh to be written beside the scene file, under a name made from the scene file's; returns the mesh's name.
std::string add_imported_mesh(ImportResult& result, const ImportSource& source, Mesh mesh);
// The meshes of an import, by the paths of the files to which they will be written.
MeshesToBe::Meshes imported_meshes(const ImportResult& result, const std::string& scene_file);
// Repeats a mesh file's own warnings as the import's, once per file, at the source line that names the file first.
void warn_of_mesh(ImportResult& result, std::size_t line, const std::filesystem::path& file,
                  const std::vector<std::string>& warnings);
// Name of a material in the scene file: its name in the source, or material_LABEL.
std::string material_name(const Cis565Section& section);

// Validates the parts of a scene file and reports each fault as a problem of its source line. `file`: path of the scene
// file, to which names of meshes are relative.
void check_parts(const SceneParts& parts, const std::string& file, ImportFindings& problems);

}  // namespace pt
