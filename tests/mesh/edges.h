// What a mesh encloses: whether its triangles close it, and the volume inside.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "harness/mesh/mesh.h"

namespace pt::test {

struct EdgeCounts {
    std::uint64_t matched = 0;   // passed once in either direction
    std::uint64_t touching = 0;  // passed several times, as often in either direction: where a body touches itself
    std::uint64_t open = 0;      // passed more often in one direction
};

// The edges of a mesh between vertices by number, counted by how triangles pass them.
inline EdgeCounts edge_counts(const Mesh& mesh) {
    std::vector<std::pair<std::uint64_t, int>> passed;  // the ends, the lower first, and which way
    for (const auto& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint64_t from = triangle[i], to = triangle[(i + 1) % 3];
            passed.emplace_back(std::min(from, to) << 32 | std::max(from, to), from < to ? 1 : -1);
        }
    }
    std::sort(passed.begin(), passed.end());
    EdgeCounts counts;
    for (std::size_t i = 0; i < passed.size();) {
        std::size_t times = 0;
        int balance = 0;
        for (const std::uint64_t edge = passed[i].first; i < passed.size() && passed[i].first == edge; ++i) {
            ++times;
            balance += passed[i].second;
        }
        ++(balance != 0 ? counts.open : times == 2 ? counts.matched : counts.touching);
    }
    return counts;
}

// The volume of a closed mesh by the divergence theorem; positive where corners go counter-clockwise, seen from
// outside.
inline double signed_volume(const Mesh& mesh) {
    double volume = 0.0;
    for (const auto& [ia, ib, ic] : mesh.triangles) {
        const auto &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
        volume += a[0] * (double(b[1]) * c[2] - double(b[2]) * c[1]) +
                  a[1] * (double(b[2]) * c[0] - double(b[0]) * c[2]) +
                  a[2] * (double(b[0]) * c[1] - double(b[1]) * c[0]);
    }
    return volume / 6.0;
}

}  // namespace pt::test
