// Keywords of the CIS 565 scene formats: the course's, and those that students' dialects of the text and JSON formats
// add or spell differently. Case and underscores do not count: LENS_RADIUS is LENSRADIUS.
#pragma once

#include <string>
#include <vector>

namespace pt {

// How the importer treats a keyword of a CIS 565 scene.
enum class CourseUse {
    value,        // keyword that has a place in a scene file
    environment,  // keyword that names an environment map
    background,   // keyword for a constant environment radiance
    remark,       // keyword without effect on the picture
    run,          // keyword for a setting of a run, not of the scene
    lost,         // keyword that changes the picture but cannot be expressed: a warning
    image,        // keyword with a texture's file name; a value such as 0 or OFF means none
    texture,      // keyword of a surface map that scene files cannot express: a problem, as are the next three uses
    procedural,
    scattering,
    lights,
};

struct CourseWord {
    std::string key;  // keyword of CIS 565 scenes, in the course's own spelling
    CourseUse use = CourseUse::value;
};

// Finds a keyword of a CIS 565 section (MATERIAL, CAMERA, OBJECT, SETTINGS; in JSON also ROOT); null if unknown.
const CourseWord* find_course_word(const std::string& section, const std::string& word);

// Keywords of a CIS 565 section that have a place in scene files, to be listed in error messages.
const std::vector<std::string>& course_keys(const std::string& section);

// Why scene files cannot express keywords of this use (CourseUse); ends messages such as "TEXTURE a.png: ..".
std::string missing_for(CourseUse use);

// The spelling by which keywords are compared: in capitals, without '_' and '-'.
std::string course_spelling(const std::string& word);

// Whether a keyword's values switch its effect off: none, 0, NULL or OFF.
bool is_course_off(const std::string& key, const std::vector<std::string>& values);

}  // namespace pt
