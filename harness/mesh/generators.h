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
// The grid sphere with the probe's bump, 0.05, and its frequencies: 40 up to n = 256, 90 up to 724, 150 beyond.
Mesh make_probe_sphere(std::uint32_t n);

// The cube with its middles bored through, `level` times over: the faces between what is left and what is not, each in
// two. Vertices are shared, and no edge has more than two faces.
Mesh make_menger_sponge(std::uint32_t level);

// Newell's 32 bicubic patches, each n x n x 2 triangles, in his units: 6.525 long, 3.15 high, standing on y = 0.
// Patches do not share vertices, but where two meet, theirs are at the same places.
Mesh make_teapot(std::uint32_t n);
// The teapot on a quad whose side is 10^5 times its length.
Mesh make_stadium(std::uint32_t n);

// A tube of 8 n rings with n corners each along the torus knot (2, 3).
Mesh make_trefoil(std::uint32_t n);
// Tori of 64 x 32 quads as in the probe: R = 1, r = 0.3, turned evenly, times 0.08 to 0.18, centres evenly in
// [-1, 1)^3. Other random numbers than the probe's, from the same distributions.
Mesh make_tori(std::uint32_t count);
// Bent tubes of 24 pieces with 6 sides, without ends, outward from near the centre.
Mesh make_hairball(std::uint32_t strands);

// A triangle each, 0.2 to 0.6 long, and 2^7 to 2^13 times longer than wide, everywhere in [-1, 1)^3.
Mesh make_needles(std::uint32_t count);
// One triangle `count` times over: all have the same three corners.
Mesh make_equal_triangles(std::uint32_t count);

// Value noise of `level` octaves over 2^level x 2^level cells, on [-1, 1] x [-1, 1], normals up.
Mesh make_terrain(std::uint32_t level);

// The walls of scenes/cornell_open.json, open at the front, and Cornell's two blocks without their undersides: 15 quads
// of n x n x 2 triangles, seen from inside the room. The lamp is not among them.
Mesh make_cornell_box(std::uint32_t n);

}  // namespace pt
