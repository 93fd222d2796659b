// Closed meshes that are hard to intersect without gaps: vertices and edges shared by many triangles, needles, sizes
// from 2^-20 to 2^20. Neighbouring triangles share vertices, whose coordinates are single precision numbers.
#pragma once

#include "harness/mesh/mesh.h"

namespace pt::stability {

// A cube [-1, 1]^3 whose walls are grids of n x n squares of two triangles each: 12 n^2 triangles.
Mesh grid_room(std::uint32_t n);
// A double cone: two apexes at z = +-1 over a ring of n vertices of radius 1, so that n triangles share each apex.
Mesh spindle(std::uint32_t n);
// A spindle with n triangles inside ("pages") from the axis to the ring, so that n triangles share the axis as an edge.
Mesh book(std::uint32_t n);
// A box [-1, 1]^3 whose walls along x are cut into strips: 16 of width 2^-k in the middle and a wide one beside them.
Mesh striped_room(std::uint32_t k);
// A tube with n sides and radius 2^-k along z from -1 to 1, closed by two lids.
Mesh thin_tube(std::uint32_t n, std::uint32_t k);
// A pyramid with its apex at (0, 0, -2^k) and its base in the plane z = 1, made of nested squares with half sides from
// 2^-k to 2^k, each twice as large as the one within.
Mesh nested_squares(int k);

// Returns the mesh with its vertices, its triangles and each triangle's first corner in a random order given by `seed`.
Mesh shuffled(const Mesh& mesh, std::uint64_t seed);
// Returns the mesh with every triangle twice.
Mesh doubled(const Mesh& mesh);
// Returns the mesh with degenerate triangles added after each triangle: one with two equal corners, one with two
// corners in one place and one with collinear corners.
Mesh with_flat_ones(const Mesh& mesh);
// Returns the mesh with every vertex moved and rounded to single precision.
Mesh moved_by(Mesh mesh, double x, double y, double z);

}  // namespace pt::stability
