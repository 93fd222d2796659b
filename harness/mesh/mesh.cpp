#include "harness/mesh/mesh.h"

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

std::string content_hash(const Mesh& mesh) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    add_triples(hash, mesh.vertices);
    add_triples(hash, mesh.triangles);
    add_triples(hash, mesh.normals);
    return fmt::format("{:016x}", hash);
}

}  // namespace pt
