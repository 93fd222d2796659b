#include "harness/mesh/vertex_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pt {

namespace {

// Maps each vertex of a mesh to the first vertex of equal position.
std::vector<std::uint32_t> first_at_place(const Mesh& mesh) {
    const auto at = [&](std::uint32_t vertex) {
        // Adding +0 turns -0 into +0, so that equal vertex positions compare equal.
        const auto& [x, y, z] = mesh.vertices[vertex];
        return std::array{x + 0.0f, y + 0.0f, z + 0.0f};
    };
    std::vector<std::uint32_t> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto place_a = at(a), place_b = at(b);
        return place_a < place_b || (place_a == place_b && a < b);
    });
    std::vector<std::uint32_t> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool is_there = i > 0 && at(order[i]) == at(order[i - 1]);
        first[order[i]] = is_there ? first[order[i - 1]] : order[i];
    }
    return first;
}

}  // namespace

void give_vertex_normals(Mesh& mesh) {
    const std::vector<std::uint32_t> first = first_at_place(mesh);
    const auto place = [&](std::uint32_t vertex) {
        const auto& [x, y, z] = mesh.vertices[vertex];
        return glm::dvec3(x, y, z);
    };
    std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0.0));
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 here = place(triangle[i]);
            const glm::dvec3 next = place(triangle[(i + 1) % 3]) - here, last = place(triangle[(i + 2) % 3]) - here;
            sums[first[triangle[i]]] += glm::cross(next, last) / (glm::dot(next, next) * glm::dot(last, last));
        }
    }
    mesh.normals.clear();
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::dvec3& sum = sums[first[i]];
        const double length = std::sqrt(glm::dot(sum, sum));
        const glm::dvec3 normal = length > 0 ? sum / length : glm::dvec3(0.0);
        mesh.normals.push_back(
            {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)});
    }
}

}  // namespace pt
