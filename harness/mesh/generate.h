// Meshes that anyone can make: by name and size, with exact counts and the same bits on every machine (exact_math.h).
// All are about the size of the unit sphere or cube, y up, but for what the table says otherwise.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "harness/mesh/mesh.h"

namespace pt {

struct Generator {
    std::string_view name, what;
    std::string_view size, formula;  // what N counts, and how many triangles there are of N, in words
    std::uint32_t least_size, most_size;
    std::uint64_t (*triangles)(std::uint32_t size);  // that generate_mesh returns
    std::uint64_t (*left_out)(std::uint32_t size);   // without area, at poles: not among them
    bool closed;     // every edge is shared by two triangles, in opposite directions, and the volume inside is positive
    bool is_smooth;  // what it approximates has no edges, so that normals of its vertices mean something
    Mesh (*make)(std::uint32_t size);
};

// All generators, in the order in which people are told of them.
std::span<const Generator> generators();
// Finds a generator; nullptr where there is none of that name.
const Generator* find_generator(std::string_view name);

// Generates a mesh. Throws InputError for a name that is no generator's, or a size out of its range.
Mesh generate_mesh(std::string_view name, std::uint32_t size);

}  // namespace pt
