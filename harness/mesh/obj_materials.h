// Splits Wavefront OBJ files by material (Advanced Visualizer manual, appendix B1) and parses their MTL libraries
// (Ramey, Rose and Tyerman, "MTL material format", 1995) into words.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "harness/mesh/mesh.h"

namespace pt {

// Material and group of an OBJ face, named by the last usemtl and the last g (or o) before the face; either may be
// empty. A name that contains # may end in a comment: look up the whole name first, then `without_comment`.
struct ObjPart {
    std::string material, group;
};

struct ObjParts {
    Mesh mesh;                           // all triangles of the OBJ file, unchecked and without normals
    std::vector<ObjPart> parts;          // parts (material and group) in the order of their first faces
    std::vector<std::uint32_t> part_of;  // index in `parts` of each triangle's part
    std::vector<std::string> libraries;  // names of MTL libraries, as mtllib lines give them
};

// Parses an OBJ file into parts by material. Throws InputError of one line for a broken file, like `parse_obj`.
ObjParts parse_obj_parts(std::string_view content, const std::string& file);

// A mesh of only the triangles whose entry of `is_in` is true, and of the vertices that they use.
Mesh part_of_mesh(const Mesh& mesh, const std::vector<bool>& is_in);

// Strips the comment from a name in an OBJ or MTL file: a word that begins with #, except the first, and all after it.
std::string without_comment(const std::string& name);

struct MtlLine {
    std::size_t number = 0;          // line number in the MTL file, from 1
    std::vector<std::string> words;  // keyword and values of an MTL line
    std::string text() const;
};

struct MtlMaterial {
    std::string name;
    std::size_t line = 0;                  // number of the material's line newmtl in the MTL file
    std::map<std::string, MtlLine> lines;  // MTL lines by keyword in lower case; of several with one keyword the last
    std::vector<MtlLine> overruled;        // earlier MTL lines that share a keyword with one in `lines` but differ
};

// Parses an MTL material library. Throws InputError of one line if the file is none.
std::vector<MtlMaterial> parse_mtl(std::string_view content, const std::string& file);

}  // namespace pt
