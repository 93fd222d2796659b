// Keywords of Wavefront OBJ files, and the kind of line that each begins.
#pragma once

#include <string>
#include <string_view>

namespace pt {

inline constexpr std::string_view obj_white = " \t\v\f\r";

enum class ObjLine {
    vertex,
    normal,
    texture,
    face,
    material,
    group,
    library,
    image,  // line that names a texture image of faces, in very old OBJ files
    no_shape,
    points_or_lines,
    curve_or_surface,
    file,
    level,
    unknown,
};

// The kind of OBJ line that a first word begins.
ObjLine obj_line_of(std::string_view word);

// The first word of an OBJ line; empty for an empty line.
std::string_view first_obj_word(std::string_view line);

// Warning for an OBJ line of a kind that the reader skips; empty if skipping it changes nothing.
std::string obj_remark(ObjLine line, std::string_view word);

// Whether an OBJ line's argument is a name up to the line's end; names may contain spaces, # and backslashes.
bool is_obj_name(ObjLine line);

// Whether an OBJ line ends in a backslash that joins the next line to it. A backslash in a comment or at the end of a
// folder's name does not.
bool joins_next_line(std::string_view line);

}  // namespace pt
