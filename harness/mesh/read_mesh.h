// Reads triangle meshes from Wavefront .obj, Stanford .ply (ascii and both binary formats) and glTF 2 files (.glb, or
// .gltf with data files beside it). Faces of more than three corners are triangulated (triangulate.h). Texture
// coordinates are kept if every corner has them. Materials and colours are skipped; other visible content that is
// skipped or ambiguous becomes a warning of the mesh.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/mesh/mesh.h"

namespace pt {

inline constexpr std::uint64_t largest_mesh_file = std::uint64_t{1} << 33;

// Reads a mesh in the format that the file's extension names. Degenerate triangles are left out and counted, which the
// caller reports. Throws InputError of one line for a file that is missing, of another kind, too large or broken, and
// for a mesh that `check_mesh` refuses.
Mesh read_mesh(const std::filesystem::path& path);

// Parsers of one mesh format each, from the content of a file; `file` is the name that error messages show.
Mesh parse_ply(std::string_view content, const std::string& file);
Mesh parse_obj(std::string_view content, const std::string& file);
Mesh parse_glb(std::string_view content, const std::string& file);
// Parses a glTF JSON text, and reads the data files that it names from the folder of `file`.
Mesh parse_gltf(std::string_view content, const std::string& file);

// Whether the build has tinygltf, which reads .glb. Without it `parse_glb` throws an InputError that says so.
bool reads_glb();

}  // namespace pt
