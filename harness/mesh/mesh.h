// A triangle mesh as it is made or read, before any scene or accelerator sees it: plain arrays on the host.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/mesh/mesh_warnings.h"

namespace pt {

// Bounds on a mesh, below which indices of triangles and vertices stay; a scene of several meshes still counts its
// triangles in 32 bits.
inline constexpr std::uint64_t most_triangles = std::uint64_t{1} << 27;
inline constexpr std::uint64_t most_vertices = std::uint64_t{1} << 28;

struct Mesh {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise, seen from outside
    std::vector<std::array<float, 3>> normals;            // empty, or one a vertex; of any length, as they were given
    // Texture coordinates of each triangle's corners: u to the right and v up, (0, 0) the lower left corner of an
    // image. Empty, or one entry a triangle.
    std::vector<std::array<std::array<float, 2>, 3>> coordinates;
    std::uint32_t degenerate_left_out = 0;  // faces without area that were met and are not in `triangles`
    MeshWarnings warnings;                  // of the file that it was read from
};

// The places in an image of the corners of triangles whose indices go into `places`; empty where one is not there.
std::vector<std::array<std::array<float, 2>, 3>> places_of_corners(
    std::span<const std::array<std::uint32_t, 3>> triangles, std::span<const std::array<float, 2>> places);

// FNV-1a of vertices, triangles and normals, without texture coordinates, a word at a time as Film::hash has it: 16 hex
// digits. The sign of a zero counts; what was left out does not.
std::string content_hash(const Mesh& mesh);

}  // namespace pt
