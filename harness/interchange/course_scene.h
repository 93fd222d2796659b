// Builds the parts of a scene file from the sections of a CIS 565 scene (rules: harness/interchange/import_cis565.h).
#pragma once

#include <deque>
#include <map>
#include <set>
#include <utility>

#include "harness/interchange/course_mesh.h"
#include "harness/interchange/import_parts.h"

namespace pt {

// The first source line that makes an object move, so that the shutter opens, and whether shutter times are "late".
struct CourseMotion {
    const Cis565Line* first = nullptr;
    bool is_late = false;
};

// A part of a mesh, the triangles of one material: names of its mesh file and of the material in the scene file.
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
    // For meshes with materials from MTL libraries: the parts of each mesh, by mesh file; and the names of MTL
    // materials in the scene file, by library and MTL name.
    std::map<std::string, std::vector<OwnPart>> own_parts = {};
    std::map<std::pair<std::string, std::string>, std::string> own_names = {};
    std::deque<Cis565Line> places = {};  // lines of MTL libraries that messages refer to
};

// Converts the material of a MATERIAL section. An unreadable line is replaced by a valid value, so that the others can
// be checked. Lossy conversions are warnings.
ScenePart import_material(CourseImport& import, std::size_t index);
// Converts an OBJECT section and adds it to the scene's objects, as one or as one per material of the mesh's own file.
void import_object(CourseImport& import, std::size_t index);
ScenePart import_camera(const CourseImport& import);

// Path of the scene file to be written, to which names of meshes are relative.
std::string course_scene_file(const ImportSource& source);

// The file name in a line of a CIS 565 scene, behind the keyword if there is one. Names may contain spaces.
std::string course_file_name(const Cis565Line& line);

// The path of a file as a scene file names it: relative to the scene's folder if that exists, otherwise absolute.
std::string name_beside(const std::filesystem::path& scene, const std::filesystem::path& file);

// Converts all sections of a CIS 565 scene into a scene file, or lists the problems.
void import_course(const Cis565File& sections, const ImportSource& source, ImportResult& result);

}  // namespace pt
