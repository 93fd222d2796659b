// Meshes of the OptiX probe program, inside a cube: displaced spheres on a latitude-longitude grid, and random tori.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "harness/mesh/mesh.h"

namespace pt::rays {

// A unit sphere of 4 n^2 triangles inside a cube. Its radius varies by 5 % in `waves` periods.
Mesh sphere_in_box(std::uint32_t n, double waves);
// `count` tori of 64 x 32 quads at random places inside a cube. Number and sizes are those of the OptiX probe, but not
// the places, which numpy draws there.
Mesh tori_in_box(std::uint32_t count);
// Appends the 12 triangles of a cube to a mesh.
void add_box(Mesh& mesh, const std::array<float, 3>& centre, float half);

struct ProbeMesh {
    const char* name;
    Mesh (*make)();
};
std::span<const ProbeMesh> probe_meshes();

}  // namespace pt::rays
