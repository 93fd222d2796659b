// Closed meshes that are hard to meet without a gap: vertices and edges that many triangles share, needles, sizes from
// 2^-20 to 2^20. All share their vertices, with coordinates that are numbers of single precision.
#pragma once

#include "harness/mesh/mesh.h"

namespace pt::stability {

// The cube [-1, 1]^3 with walls of n x n squares, in two triangles each: 12 n^2.
Mesh grid_room(std::uint32_t n);
// Two points at z = +-1 over a ring of n vertices of radius 1: each point is shared by n triangles.
Mesh spindle(std::uint32_t n);
// A spindle with n pages within: triangles from the axis to the ring. The axis is an edge that n triangles share.
Mesh book(std::uint32_t n);
// A box [-1, 1]^3 whose walls along x are strips: 16 of width 2^-k in the middle, two wide ones beside them.
Mesh striped_room(std::uint32_t k);
// A tube along z from -1 to 1 of n sides and radius 2^-k, with two lids.
Mesh thin_tube(std::uint32_t n, std::uint32_t k);
// A pyramid over the plane z = 1 whose base is made of squares round its middle, of half sides 2^-k to 2^k, each twice
// the one within; its point is (0, 0, -2^k).
Mesh nested_squares(int k);

// The mesh with its triangles, their first corners and its vertices in an order of the seed's.
Mesh shuffled(const Mesh& mesh, std::uint64_t seed);
// The mesh with every triangle twice.
Mesh doubled(const Mesh& mesh);
// The mesh with triangles without area among the others: corners that are one, twins in one place and points in one
// line. Adds one of each for every triangle.
Mesh with_flat_ones(const Mesh& mesh);
// The mesh with every vertex moved and rounded.
Mesh moved_by(Mesh mesh, double x, double y, double z);

}  // namespace pt::stability
