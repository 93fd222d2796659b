// The materials of Wavefront's object files (Advanced Visualizer manual, appendix B1; of material libraries, Ramey,
// Rose and Tyerman, "MTL material format", 1995): which triangles have which, and what a library says of them, in
// words.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "harness/mesh/mesh.h"

namespace pt {

// What usemtl and g (or o) said last when a face came, to the line's end; either may be empty. Programs write names
// with # in them, and comments behind names: who looks for one tries it whole, then without_comment.
struct ObjPart {
    std::string material, group;
};

struct ObjParts {
    Mesh mesh;                           // all of it, unchecked and without normals
    std::vector<ObjPart> parts;          // in the order of their first faces
    std::vector<std::uint32_t> part_of;  // one a triangle: a number of `parts`
    std::vector<std::string> libraries;  // as mtllib names them, to the line's end
};

// Parses an OBJ file's parts by material. Throws InputError of one line, as parse_obj does.
ObjParts parse_obj_parts(std::string_view content, const std::string& file);

// The triangles whose entry of `is_in` is true, and their vertices alone.
Mesh part_of_mesh(const Mesh& mesh, const std::vector<bool>& is_in);

// A name without its comment: what stands before a # that begins a word other than the first.
std::string without_comment(const std::string& name);

struct MtlLine {
    std::size_t number = 0;          // from 1
    std::vector<std::string> words;  // the key and the values
    std::string text() const;
};

struct MtlMaterial {
    std::string name;
    std::size_t line = 0;                  // of its newmtl
    std::map<std::string, MtlLine> lines;  // by their keys in lower case; of two of one key the last
    std::vector<MtlLine> overruled;        // the other one, where it says something else
};

// Parses a library of materials. Throws InputError of one line for a file that is none.
std::vector<MtlMaterial> parse_mtl(std::string_view content, const std::string& file);

}  // namespace pt
