#include "harness/mesh/check_mesh.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "harness/counted.h"
#include "harness/failure.h"

namespace pt {

namespace {

glm::dvec3 in_double(const std::array<float, 3>& point) { return {point[0], point[1], point[2]}; }

void check_finite(const std::vector<std::array<float, 3>>& triples, const std::string& what, const std::string& file) {
    for (std::size_t i = 0; i < triples.size(); ++i) {
        const auto& [x, y, z] = triples[i];
        if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
            throw InputError(file, fmt::format("{} {}", what, i), fmt::format("({}, {}, {})", x, y, z),
                             "finite numbers in single precision");
        }
    }
}

void check_indices(const Mesh& mesh, const std::string& file) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t largest = *std::max_element(mesh.triangles[i].begin(), mesh.triangles[i].end());
        if (largest >= mesh.vertices.size()) {
            throw InputError(file, fmt::format("triangle {}", i), fmt::format("vertex {}", largest),
                             mesh.vertices.empty() ? "none: there are no vertices"
                                                   : fmt::format("0 to {}", mesh.vertices.size() - 1));
        }
    }
}

void check_counts(const Mesh& mesh, const std::string& file) {
    if (mesh.vertices.size() > most_vertices || mesh.triangles.size() > most_triangles) {
        throw InputError(file, "mesh",
                         fmt::format("{} vertices and {} triangles", mesh.vertices.size(), mesh.triangles.size()),
                         fmt::format("at most {} and {}", most_vertices, most_triangles));
    }
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.vertices.size()) {
        throw InputError(file, "mesh", fmt::format("{} normals", mesh.normals.size()),
                         fmt::format("none, or one for each of the {} vertices", mesh.vertices.size()));
    }
}

bool are_finite(const Mesh& mesh) {
    return std::all_of(mesh.coordinates.begin(), mesh.coordinates.end(), [](const auto& corners) {
        return std::all_of(corners.begin(), corners.end(),
                           [](const auto& at) { return std::isfinite(at[0]) && std::isfinite(at[1]); });
    });
}

}  // namespace

bool is_degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    const auto [a, b, c] = triangle;
    if (a == b || b == c || c == a) {
        return true;
    }
    const glm::dvec3 corner = in_double(mesh.vertices[a]);
    return glm::cross(in_double(mesh.vertices[b]) - corner, in_double(mesh.vertices[c]) - corner) == glm::dvec3(0.0);
}

void leave_out_degenerate(Mesh& mesh) {
    const std::size_t before = mesh.triangles.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < before; ++i) {
        if (is_degenerate(mesh, mesh.triangles[i])) {
            continue;
        }
        mesh.triangles[kept] = mesh.triangles[i];
        if (!mesh.coordinates.empty()) {
            mesh.coordinates[kept] = mesh.coordinates[i];
        }
        ++kept;
    }
    mesh.triangles.resize(kept);
    mesh.coordinates.resize(mesh.coordinates.empty() ? 0 : kept);
    mesh.degenerate_left_out += static_cast<std::uint32_t>(before - kept);
}

void check_mesh(Mesh& mesh, const std::string& file) {
    check_counts(mesh, file);
    check_finite(mesh.vertices, "vertex", file);
    check_finite(mesh.normals, "normal of vertex", file);
    check_indices(mesh, file);
    if (mesh.coordinates.size() != mesh.triangles.size() || !are_finite(mesh)) {
        mesh.coordinates.clear();
    }
    leave_out_degenerate(mesh);
    if (mesh.triangles.empty()) {
        throw InputError(file, "mesh",
                         mesh.degenerate_left_out > 0
                             ? counted(mesh.degenerate_left_out, "triangle") + " without area and no other"
                             : "no triangles",
                         "at least one triangle that has an area");
    }
}

}  // namespace pt
