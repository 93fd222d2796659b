#include "harness/mesh/mesh.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace pt {

namespace {

void add_word(std::uint64_t& hash, std::uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3ull;
    hash ^= hash >> 32;
}

template <class T>
void add_triples(std::uint64_t& hash, const std::vector<std::array<T, 3>>& triples) {
    add_word(hash, triples.size());
    for (const std::array<T, 3>& triple : triples) {
        const std::uint64_t first = std::bit_cast<std::uint32_t>(triple[0]);
        add_word(hash, first << 32 | std::bit_cast<std::uint32_t>(triple[1]));
        add_word(hash, std::bit_cast<std::uint32_t>(triple[2]));
    }
}

}  // namespace

std::vector<std::array<std::array<float, 2>, 3>> places_of_corners(
    std::span<const std::array<std::uint32_t, 3>> triangles, std::span<const std::array<float, 2>> places) {
    std::vector<std::array<std::array<float, 2>, 3>> corners;
    corners.reserve(triangles.size());
    for (const std::array<std::uint32_t, 3>& triangle : triangles) {
        if (*std::max_element(triangle.begin(), triangle.end()) >= places.size()) {
            return {};
        }
        corners.push_back({places[triangle[0]], places[triangle[1]], places[triangle[2]]});
    }
    return corners;
}

std::string content_hash(const Mesh& mesh) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    add_triples(hash, mesh.vertices);
    add_triples(hash, mesh.triangles);
    add_triples(hash, mesh.normals);
    return fmt::format("{:016x}", hash);
}

}  // namespace pt
