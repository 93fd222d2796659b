// Writes meshes for other programs as .ply (binary, little-endian) or .obj. `read_mesh` reads both back bit for bit. A
// vertex with several texture coordinates is written once for each.
#pragma once

#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

std::string ply_of(const Mesh& mesh);
std::string obj_of(const Mesh& mesh);
// Encodes a mesh as the content of a .ply or .obj file, depending on the extension of `file`.
std::string mesh_file_of(const Mesh& mesh, const std::string& file);

// Throws InputError, naming the option `flag`, if `write_mesh` would refuse the file name.
void check_mesh_name(const std::string& file, const std::string& flag = "--out");

// Writes a mesh in the format that the file's extension names, whole or not at all. Throws InputError for another
// extension, MachineError if writing fails.
void write_mesh(const Mesh& mesh, const std::string& file);

}  // namespace pt
