#include "harness/mesh/obj_keywords.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/mesh/text_numbers.h"

namespace pt {

namespace {

struct ObjKeyword {
    std::string_view word;
    ObjLine line;
};

constexpr ObjKeyword obj_keywords[] = {
    {"v", ObjLine::vertex},
    {"vn", ObjLine::normal},
    {"vt", ObjLine::texture},
    {"f", ObjLine::face},
    {"fo", ObjLine::face},  // face keyword up to version 2.11 of the OBJ format
    {"usemtl", ObjLine::material},
    {"g", ObjLine::group},
    {"o", ObjLine::group},
    {"mtllib", ObjLine::library},
    {"usemap", ObjLine::image},
    {"maplib", ObjLine::image},
    {"s", ObjLine::no_shape},
    {"mg", ObjLine::no_shape},
    {"bevel", ObjLine::no_shape},
    {"c_interp", ObjLine::no_shape},
    {"d_interp", ObjLine::no_shape},
    {"p", ObjLine::points_or_lines},
    {"l", ObjLine::points_or_lines},
    {"vp", ObjLine::curve_or_surface},
    {"cstype", ObjLine::curve_or_surface},
    {"deg", ObjLine::curve_or_surface},
    {"bmat", ObjLine::curve_or_surface},
    {"step", ObjLine::curve_or_surface},
    {"curv", ObjLine::curve_or_surface},
    {"curv2", ObjLine::curve_or_surface},
    {"surf", ObjLine::curve_or_surface},
    {"parm", ObjLine::curve_or_surface},
    {"trim", ObjLine::curve_or_surface},
    {"hole", ObjLine::curve_or_surface},
    {"scrv", ObjLine::curve_or_surface},
    {"sp", ObjLine::curve_or_surface},
    {"end", ObjLine::curve_or_surface},
    {"con", ObjLine::curve_or_surface},
    {"ctech", ObjLine::curve_or_surface},
    {"stech", ObjLine::curve_or_surface},
    {"bsp", ObjLine::curve_or_surface},
    {"bzp", ObjLine::curve_or_surface},
    {"cdc", ObjLine::curve_or_surface},
    {"cdp", ObjLine::curve_or_surface},
    {"res", ObjLine::curve_or_surface},
    {"call", ObjLine::file},
    {"csh", ObjLine::file},
    {"shadow_obj", ObjLine::file},
    {"trace_obj", ObjLine::file},
    {"lod", ObjLine::level},
};

}  // namespace

ObjLine obj_line_of(std::string_view word) {
    const auto* known = std::find_if(std::begin(obj_keywords), std::end(obj_keywords),
                                     [&](const ObjKeyword& keyword) { return keyword.word == word; });
    return known != std::end(obj_keywords) ? known->line : ObjLine::unknown;
}

std::string obj_remark(ObjLine line, std::string_view word) {
    switch (line) {
        case ObjLine::points_or_lines:
            return "p or l is passed over: points and lines have no area";
        case ObjLine::curve_or_surface:
            return "a curve or a surface is passed over (from a keyword such as cstype, curv, surf or parm on): only "
                   "faces are read";
        case ObjLine::file:
            return fmt::format("{} is passed over: what it names is not read", word);
        case ObjLine::level:
            return "lod is passed over: all levels of detail are read, one upon the other";
        case ObjLine::unknown:
            return fmt::format("{} is passed over: no keyword of the format", excerpt(word));
        default:
            return "";
    }
}

bool is_obj_name(ObjLine line) {
    return line == ObjLine::material || line == ObjLine::group || line == ObjLine::library || line == ObjLine::image ||
           line == ObjLine::file;
}

std::string_view first_obj_word(std::string_view line) {
    const std::size_t start = std::min(line.find_first_not_of(obj_white), line.size());
    return line.substr(start, line.find_first_of(obj_white, start) - start);
}

bool joins_next_line(std::string_view line) {
    if (!line.ends_with('\\') || line.find('#') != std::string_view::npos) {
        return false;
    }
    const std::string_view word = first_obj_word(line.substr(0, line.size() - 1));
    const ObjLine kind = obj_line_of(word);
    return kind != ObjLine::unknown && !is_obj_name(kind);
}

}  // namespace pt
