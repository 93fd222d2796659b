// Reads triangle meshes from files: Wavefront .obj, Stanford .ply (ascii and both binary formats), glTF 2, binary
// (.glb) or as JSON with its data in files beside it (.gltf). Faces of more than three corners are cut into triangles
// (triangulate.h). Texture coordinates are kept where every corner has some. Materials and colours are passed over;
// what else a file has that would show, or is read with a doubt, is among the mesh's warnings.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/mesh/mesh.h"

namespace pt {

inline constexpr std::uint64_t largest_mesh_file = std::uint64_t{1} << 33;

// Reads a mesh in the format of the file's ending. Triangles without area are left out and counted: who calls says so.
// Throws InputError of one line for a file that is missing, of another kind, too large or broken, and for whatever
// check_mesh refuses.
Mesh read_mesh(const std::filesystem::path& path);

// These read a file's content as read_mesh does; `file` is for the messages.
Mesh parse_ply(std::string_view content, const std::string& file);
Mesh parse_obj(std::string_view content, const std::string& file);
Mesh parse_glb(std::string_view content, const std::string& file);
// Reads a glTF text, and the files of data that it names, from the folder of `file`.
Mesh parse_gltf(std::string_view content, const std::string& file);

// Whether the build found what reads .glb (tinygltf); without it parse_glb throws InputError that says so.
bool reads_glb();

}  // namespace pt
