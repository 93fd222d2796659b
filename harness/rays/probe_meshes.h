// The meshes of the OptiX probe: displaced spheres on a grid of angles, and tori at random, in a box of 12 triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "harness/mesh/mesh.h"

namespace pt::rays {

// A unit sphere of 4 n^2 triangles whose radius swings by 5 %, `waves` times, in a box.
Mesh sphere_in_box(std::uint32_t n, double waves);
// `count` tori of 64 x 32 quads at random places in a box (as many, of the probe's sizes, not its very ones: those are
// numpy's draws).
Mesh tori_in_box(std::uint32_t count);
// The 12 triangles of a cube, after those that are there.
void add_box(Mesh& mesh, const std::array<float, 3>& centre, float half);

struct ProbeMesh {
    const char* name;
    Mesh (*make)();
};
std::span<const ProbeMesh> probe_meshes();

}  // namespace pt::rays
