// Small sets of triangles and rays for tests of accelerators, seeded; each has a difficulty of its own.
#pragma once

#include <string>
#include <vector>

#include "kernels/triangle.h"

namespace pt::test {

using Triangles = std::vector<Triangle<float>>;

struct TriangleScene {
    std::string name;
    Triangles triangles;
};

struct TestRay {
    Vec3<float> origin, direction;
};

Triangles random_soup(std::uint32_t count, float size, std::uint64_t seed);
// Long thin triangles in all directions: length 1, width 1 / aspect.
Triangles needles(std::uint32_t count, float aspect, std::uint64_t seed);
// Needles side by side along the z axis: their weights are differences of almost equal products, their boxes thin.
Triangles needle_bundle(std::uint32_t count, float width, std::uint64_t seed);
// Small triangles with long ones across them, aslant: what spatial splits are for.
Triangles sticks_in_soup(std::uint32_t small, std::uint32_t sticks, std::uint64_t seed);
// A closed sphere of rings x sectors quads, in pairs of triangles; its poles fans.
Triangles grid_sphere(std::uint32_t rings, std::uint32_t sectors, Vec3<float> centre, float radius);
// The cubes of a Menger sponge, side 3^level at the origin, faces between cubes kept: exact ties everywhere.
Triangles menger(std::uint32_t level);
Triangles equal_triangles(std::uint32_t count);
// Triangles without extent: points, segments, and proper ones in axis planes.
Triangles flat_triangles(std::uint32_t count, std::uint64_t seed);
// A floor of two triangles, `size` long, under a few small boxes near the middle: far vertices, near hits.
Triangles large_floor(float size);
// Triangles that halve in size towards a corner: trees want to be deep.
Triangles geometric_progression(std::uint32_t count);

Triangles moved(Triangles triangles, Vec3<float> by);
// The triangles scaled by 2^exponent, which is exact.
Triangles scaled(Triangles triangles, int exponent);

// One scene of each kind, of moderate size.
std::vector<TriangleScene> triangle_scenes();

// Rays through the scene's box: from outside and inside in random directions, along axes and in axis planes (with +0
// and -0), from vertices and from points on triangles, along edges, towards vertices and edges.
std::vector<TestRay> rays_for(const Triangles& triangles, std::uint32_t count, std::uint64_t seed);

}  // namespace pt::test
