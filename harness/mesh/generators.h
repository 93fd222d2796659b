// The functions behind the table of mesh generators in generate.cpp, one file per kind of mesh. Called directly by code
// that needs parameters beyond the table's sizes.
#pragma once

#include <cstdint>

#include "harness/mesh/mesh.h"

namespace pt {

// An icosahedron of which each face is split into four, `level` times over; a smooth bump then moves vertices radially.
Mesh make_icosphere(std::uint32_t level);

// A sphere with n rows of latitude by 2 n of longitude and radius 1 + bump sin(frequency theta) cos(frequency phi). The
// vertices are those of `grid_sphere` in the OptiX probe (issue 19), except that each pole is one vertex. The winding
// is opposite to the probe's, whose normals point inward.
Mesh make_grid_sphere(std::uint32_t n, double bump, std::uint32_t frequency);
// The OptiX probe's grid sphere: bump 0.05, and frequency 40 for n up to 256, 90 for n up to 724, 150 beyond.
Mesh make_probe_sphere(std::uint32_t n);

// A Menger sponge: a cube bored through `level` times over. Each face between solid and empty cells is two triangles.
// Vertices are shared, and no edge has more than two faces.
Mesh make_menger_sponge(std::uint32_t level);

// The Utah teapot: Newell's 32 bicubic patches of n x n x 2 triangles each, in his units: 6.525 long, 3.15 high,
// standing on y = 0. Patches share no vertices, but where two meet, their vertices have equal positions.
Mesh make_teapot(std::uint32_t n);
// The teapot in a stadium: it stands on a quad whose side is 10^5 times the teapot's length.
Mesh make_stadium(std::uint32_t n);

// A tube along the torus knot (2, 3): 8 n rings with n corners each.
Mesh make_trefoil(std::uint32_t n);
// Randomly placed tori of 64 x 32 quads, distributed as in the OptiX probe but with other random numbers: R = 1, r =
// 0.3, rotated uniformly, scaled by 0.08 to 0.18, centres uniform in [-1, 1)^3.
Mesh make_tori(std::uint32_t count);
// A hairball: bent tubes of 24 pieces with 6 sides and open ends, which run outward from near the centre.
Mesh make_hairball(std::uint32_t strands);

// Needles: single triangles 0.2 to 0.6 long, 2^7 to 2^13 times longer than wide, uniformly in [-1, 1)^3.
Mesh make_needles(std::uint32_t count);
// One triangle `count` times over: all copies have the same three corners.
Mesh make_equal_triangles(std::uint32_t count);

// A terrain: value noise of `level` octaves on a grid of 2^level x 2^level cells over [-1, 1] x [-1, 1], normals up.
Mesh make_terrain(std::uint32_t level);

// The Cornell box of scenes/cornell_open.json as a mesh without its lamp: walls open at the front and the two blocks
// without undersides, 15 quads of n x n x 2 triangles, seen from inside the room.
Mesh make_cornell_box(std::uint32_t n);

}  // namespace pt
