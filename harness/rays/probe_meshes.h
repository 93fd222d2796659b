// The meshes of the OptiX probe: displaced spheres on a grid of angles, and tori at random, in a box of 12 triangles.
#pragma once

#include "kernels/triangle.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pt::rays {

struct ProbeMesh {
    std::string name;
    std::vector<Triangle<float>> triangles;
};

// 4 n^2 triangles of a unit sphere whose radius swings by 5 %, `waves` times; then the box.
ProbeMesh sphere_in_box(const std::string& name, std::uint32_t n, double waves);
// `count` tori of 64 x 32 quads at random (as many, of the probe's sizes, not its very ones: those are numpy's draws).
ProbeMesh tori_in_box(const std::string& name, std::uint32_t count);

}  // namespace pt::rays
