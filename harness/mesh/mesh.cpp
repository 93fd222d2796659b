#include "harness/mesh/mesh.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "variants/fnv1a.h"

namespace pt {

namespace {

template <class T>
std::uint64_t with_triples(std::uint64_t hash, const std::vector<std::array<T, 3>>& triples) {
    hash = fnv1a_word(hash, triples.size());
    for (const std::array<T, 3>& triple : triples) {
        const std::uint64_t first = std::bit_cast<std::uint32_t>(triple[0]);
        hash = fnv1a_word(hash, first << 32 | std::bit_cast<std::uint32_t>(triple[1]));
        hash = fnv1a_word(hash, std::bit_cast<std::uint32_t>(triple[2]));
    }
    return hash;
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
    const std::uint64_t hash = with_triples(with_triples(fnv1a_start, mesh.vertices), mesh.triangles);
    return fmt::format("{:016x}", with_triples(hash, mesh.normals));
}

}  // namespace pt
