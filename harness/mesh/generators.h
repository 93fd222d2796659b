// The functions behind the table in generate.cpp, a file for each kind, for those who need other numbers than its
// sizes.
#pragma once

#include <cstdint>

#include "harness/mesh/mesh.h"

namespace pt {

// The icosahedron's faces, each in four, `level` times, then every vertex moved along its radius by a smooth bump.
Mesh make_icosphere(std::uint32_t level);

// n rows of latitude by 2 n of longitude; radius 1 + bump sin(frequency theta) cos(frequency phi). The vertices of
// grid_sphere in the probe that OptiX was measured with (issue 19), but for its poles, which are one vertex each here,
// and its direction of corners, which has the normals inside there.
Mesh make_grid_sphere(std::uint32_t n, double bump, std::uint32_t frequency);
// With the probe's bump, 0.05, and its frequencies: 40 up to n = 256, 90 up to 724, 150 beyond.
Mesh make_probe_sphere(std::uint32_t n);

}  // namespace pt
