// The TYPE of a material in a CIS 565 scene: the course's own Diffuse, Emitting and Specular, and those of students.
#pragma once

#include "harness/interchange/import_lines.h"

namespace pt {

enum class CourseType {
    by_values,  // no TYPE: the values of the material's other lines decide its kind
    emitter,
    diffuse,
    specular,  // material kind: a mirror or a metal
    glass,
    layered,  // material that becomes glass, metal or diffuse by METALLIC and ROUGHNESS, as in glTF
    subsurface,
};

// Whether a word is a material TYPE of CIS 565 scenes, even one that scene files cannot express.
bool is_course_type(const std::string& word);

// Reads a TYPE line. An unknown type, or one that scene files cannot express, is reported as a problem of the line.
CourseType read_course_type(Cis565SectionReader& reader, const Cis565Line& line);

}  // namespace pt
