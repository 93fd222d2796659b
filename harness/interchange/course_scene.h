// What the sections of a scene of CIS 565 become: harness/interchange/import_cis565.h says it in words.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <utility>

#include "harness/interchange/course_mesh.h"
#include "harness/interchange/import_parts.h"

namespace pt {

// The line that has the shutter open, and how.
struct CourseMotion {
    const Cis565Line* first = nullptr;
    bool is_late = false;
};

// Triangles of one material: a mesh file and a material, by the names that the scene has for them.
struct OwnPart {
    std::string file, material;
};

struct CourseImport {
    const Cis565File* sections = nullptr;
    const ImportSource* source = nullptr;
    ImportResult* result = nullptr;
    CourseFileFinder files;
    CourseMotion motion = {};
    std::set<std::size_t> used_materials = {};
    std::vector<ScenePart> materials = {}, objects = {};
    // Parts of meshes with the materials of their own files, by the mesh file, and the names of these materials, by
    // library and name.
    std::map<std::string, std::vector<OwnPart>> own_parts = {};
    std::map<std::pair<std::string, std::string>, std::string> own_names = {};
    std::deque<Cis565Line> places = {};  // in those files, for messages
};

// Reads the material of a MATERIAL section. Where a line cannot be read, a value that is right stands for it, so that
// the others can be checked. Readings that lose something are warnings.
ScenePart import_material(CourseImport& import, std::size_t index);
// Adds to `objects`: one, or one for each material of its mesh's own file.
void import_object(CourseImport& import, std::size_t index);
ScenePart import_camera(const CourseImport& import);

// The scene file that names of meshes are relative to.
std::string course_scene_file(const ImportSource& source);

// The words of a line behind its key, or alone, as a file's name: names may have spaces.
std::string course_file_name(const Cis565Line& line);

// A file as a scene file names it: relative to its folder, or where that is not there yet the whole path.
std::string name_beside(const std::filesystem::path& scene, const std::filesystem::path& file);

// The whole scene file, or the problems that it has.
void import_course(const Cis565File& sections, const ImportSource& source, ImportResult& result);

}  // namespace pt
