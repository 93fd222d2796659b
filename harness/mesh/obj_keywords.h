// The keywords of Wavefront's object files, and which lines they make.
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
    image,  // of a material, in the oldest files
    no_shape,
    points_or_lines,
    curve_or_surface,
    file,
    level,
    unknown,
};

// The kind of line that a line's first word begins.
ObjLine obj_line_of(std::string_view word);

// The first word of a line; empty for an empty line.
std::string_view first_obj_word(std::string_view line);

// The remark where such a line is passed over; empty: there is none.
std::string obj_remark(ObjLine line, std::string_view word);

// Whether what follows is a name, to the line's end: names have spaces, # and backslashes in them.
bool is_obj_name(ObjLine line);

// Whether a line ends in a backslash that joins the next to it. One in a comment does not, nor the end of a folder's
// name.
bool joins_next_line(std::string_view line);

}  // namespace pt
