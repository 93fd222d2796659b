// The words of the CIS 565 scene formats: those of the course, and what students' dialects of the text and of the JSON
// format add to them or call them. Case and underscores do not count: LENS_RADIUS is LENSRADIUS.
#pragma once

#include <string>
#include <vector>

namespace pt {

// What a word is for, besides its value.
enum class CourseUse {
    value,        // it has a place in a scene file
    environment,  // an image that lights the scene from all round
    background,   // one radiance from all round
    remark,       // it changes nothing in the picture
    run,          // it belongs to a run of the program, not to the scene
    lost,         // it changes the picture, and a scene file has no place for it: a warning
    image,        // a file's name; off is as if it were not there
    texture,      // the rest have none either, and without them it would be another scene: a problem
    procedural,
    scattering,
    lights,
};

struct CourseWord {
    std::string key;  // the course's own word for it
    CourseUse use = CourseUse::value;
};

// Finds a word of the format; null where it is not known. `section`: MATERIAL, CAMERA, OBJECT or SETTINGS; of the JSON
// format also ROOT.
const CourseWord* find_course_word(const std::string& section, const std::string& word);

// The words that have a place in scene files, for messages.
const std::vector<std::string>& course_keys(const std::string& section);

// What is wrong with a word of this use, as in "TEXTURE a.png: ..".
std::string missing_for(CourseUse use);

// The spelling by which words are compared: in capitals, without '_' and '-'.
std::string course_spelling(const std::string& word);

// Whether values say that what they belong to is off: none, 0, NULL, OFF.
bool is_course_off(const std::string& key, const std::vector<std::string>& values);

}  // namespace pt
