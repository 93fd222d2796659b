// What a material's TYPE in a scene of CIS 565 says: the course's own Diffuse, Emitting and Specular, and students'.
#pragma once

#include "harness/interchange/import_lines.h"

namespace pt {

enum class CourseType {
    by_values,  // nothing beyond the other lines
    emitter,
    diffuse,
    specular,  // a mirror or a metal
    glass,
    layered,  // metallic-roughness, by METALLIC and ROUGHNESS
    subsurface,
};

// Whether a word is a TYPE of the course's, be it one that scene files have nothing for.
bool is_course_type(const std::string& word);

// Reads a TYPE line. What is no type, or one that scene files have nothing for, is a problem of the line.
CourseType read_course_type(Cis565SectionReader& reader, const Cis565Line& line);

}  // namespace pt
