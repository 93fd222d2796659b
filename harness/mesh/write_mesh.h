// Writes a mesh for other programs: .ply (binary, little-endian) or .obj. read_mesh reads either back bit for bit;
// a vertex that lies at several places of an image is written once for each.
#pragma once

#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

std::string ply_of(const Mesh& mesh);
std::string obj_of(const Mesh& mesh);
// A mesh as the text of a file of that ending, .ply or .obj.
std::string mesh_file_of(const Mesh& mesh, const std::string& file);

// Throws InputError, naming the option `flag`, where write_mesh would refuse the name.
void check_mesh_name(const std::string& file, const std::string& flag = "--out");

// Writes a mesh in the format of the file's ending, whole or not at all; throws InputError for another ending,
// MachineError if it cannot be written.
void write_mesh(const Mesh& mesh, const std::string& file);

}  // namespace pt
