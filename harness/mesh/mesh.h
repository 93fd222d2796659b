// A triangle mesh as generated or read from a file: plain arrays on the host, before any scene or accelerator uses it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/mesh/mesh_warnings.h"

namespace pt {

// Upper bounds on a mesh, with which the triangles of a scene of several meshes can still be counted in 32 bits.
inline constexpr std::uint64_t most_triangles = std::uint64_t{1} << 27;
inline constexpr std::uint64_t most_vertices = std::uint64_t{1} << 28;

struct Mesh {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // vertex indices, counter-clockwise seen from outside
    std::vector<std::array<float, 3>> normals;            // vertex normals: none, or one per vertex, of any length
    // Texture coordinates of each triangle's corners: u to the right and v up, (0, 0) the lower left corner of an
    // image. Empty, or one entry a triangle.
    std::vector<std::array<std::array<float, 2>, 3>> coordinates;
    std::uint32_t degenerate_left_out = 0;  // number of degenerate faces, which `triangles` leaves out
    MeshWarnings warnings;                  // warnings about the file that was read
};

// Texture coordinates by triangle corner, from indices (`triangles`) into `places`; empty if an index is out of range.
std::vector<std::array<std::array<float, 2>, 3>> places_of_corners(
    std::span<const std::array<std::uint32_t, 3>> triangles, std::span<const std::array<float, 2>> places);

// FNV-1a hash of vertices, triangles and normals, as 16 hex digits; it takes a word at a time like Film::hash. +0 and
// -0 differ. Texture coordinates and the count of degenerate triangles are not part of the hash.
std::string content_hash(const Mesh& mesh);

}  // namespace pt
