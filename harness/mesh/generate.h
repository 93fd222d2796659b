// Mesh generators: triangle meshes by name and size, with exact triangle counts and the same bits on every machine
// (exact_math.h). Unless the table says otherwise a mesh has about the size of the unit sphere or cube, y up.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "harness/mesh/mesh.h"

namespace pt {

struct Generator {
    std::string_view name, what;
    std::string_view size, formula;  // what a mesh's size N counts, and its triangle count as a formula of N, in words
    std::uint32_t least_size, most_size;
    std::uint64_t (*triangles)(std::uint32_t size);  // triangle count of the generated mesh
    std::uint64_t (*left_out)(std::uint32_t size);   // number of triangles left out since they are degenerate, at poles
    bool closed;     // whether meshes have two triangles at each edge, in opposite directions, and a positive volume
    bool is_smooth;  // whether the mesh approximates a smooth surface, so that vertex normals are useful
    Mesh (*make)(std::uint32_t size);
};

// All mesh generators, in the order in which they are listed to users.
std::span<const Generator> generators();
// Finds a mesh generator by name; nullptr if there is none.
const Generator* find_generator(std::string_view name);

// Generates a mesh. Throws InputError for an unknown generator or a size out of its range.
Mesh generate_mesh(std::string_view name, std::uint32_t size);

}  // namespace pt
