// Builds the parts of a scene file from the sections of a CIS 565 scene (rules: harness/interchange/import_cis565.h).
#pragma once

#include <deque>
#include <map>
#include <set>
#include <utility>

#include "harness/interchange/course_mesh.h"
#include "harness/interchange/import_parts.h"

namespace pt {

// The first line of a CIS 565 scene that makes an object move, and whether shutter times have the density "late".
struct CourseMotion {
    const Cis565Line* first = nullptr;
    bool is_late = false;
};

// The triangles of one MTL material of a mesh: names in the scene file of the mesh made of them and of the material.
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
    // For meshes with MTL materials: by path of a mesh file, the parts that the mesh was split into; and by MTL library
    // and material name, the name of the material in the scene file.
    std::map<std::string, std::vector<OwnPart>> own_parts = {};
    std::map<std::pair<std::string, std::string>, std::string> own_names = {};
    std::deque<Cis565Line> places = {};  // MTL library lines, kept for messages that quote them
};

// Converts the material of a MATERIAL section. An unreadable line is replaced by a valid value, so that the section's
// other lines can be checked. Lossy conversions are warnings.
ScenePart import_material(CourseImport& import, std::size_t index);
// Converts an OBJECT section and adds it to the scene as one object, or as one for each material of the mesh's file.
void import_object(CourseImport& import, std::size_t index);
ScenePart import_camera(const CourseImport& import);

// Path of the scene file to be written, to which names of meshes are relative.
std::string course_scene_file(const ImportSource& source);

// The file name in a line of a CIS 565 scene, behind the keyword if there is one. Names may contain spaces.
std::string course_file_name(const Cis565Line& line);

// The path of a file as a scene file names it: relative to the scene's folder if the folder exists, else absolute.
std::string name_beside(const std::filesystem::path& scene, const std::filesystem::path& file);

// Converts all sections of a CIS 565 scene into a scene file, or lists the problems.
void import_course(const Cis565File& sections, const ImportSource& source, ImportResult& result);

}  // namespace pt
