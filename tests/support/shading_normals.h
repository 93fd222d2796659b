// What the tests of shading normals share: materials, meshes with normals of their vertices, texels of normal maps.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "harness/mesh/generators.h"
#include "tests/support/scenes.h"

namespace pt::test {

inline const std::vector<Vec3d> bumpy_texels{{0.5, 0.1, 0.8}, {-0.4, 0.3, 0.9}, {0, 0, 1}, {0.2, -0.6, 0.7}};

// The normal (0, 0, 1) of tangent space, turned towards u by an angle.
inline Vec3d tilted(double degrees) {
    const double angle = degrees * (pi<double> / 180);
    return {std::sin(angle), 0, std::cos(angle)};
}

// The mesh with three vertices for each triangle, whose normals are the triangle's: it is shaded flat.
inline Mesh with_normals_of_faces(const Mesh& mesh) {
    Mesh apart;
    for (const auto& triangle : mesh.triangles) {
        Vec3d corners[3];
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& vertex = mesh.vertices[triangle[i]];
            apart.vertices.push_back(vertex);
            corners[i] = {vertex[0], vertex[1], vertex[2]};
        }
        const Vec3<float> normal(normalize(cross(corners[1] - corners[0], corners[2] - corners[0])) * 3.0);
        apart.normals.insert(apart.normals.end(), 3, {normal.x, normal.y, normal.z});
        const auto first = static_cast<std::uint32_t>(apart.vertices.size()) - 3;
        apart.triangles.push_back({first, first + 1, first + 2});
    }
    return apart;
}

// A ball of radius 1, whose vertices are its normals.
inline Mesh ball_mesh(std::uint32_t rows) {
    Mesh mesh = make_grid_sphere(rows, 0, 1);
    mesh.normals = mesh.vertices;
    return mesh;
}

// A material that tests of shading normals go through, and how it is added to a scene.
struct Kind {
    const char* name;
    std::function<std::uint32_t(SceneBuilder&)> make;
};
inline const std::vector<Kind> kinds{
    {"diffuse",
     [](auto& b) {
         return b.diffuse({0.75, 0.5, 0.25}, {0.125, 0, 0});
     }},
    {"mirror", [](auto& b) { return b.mirror(Vec3d(0.9)); }},
    {"mix",
     [](auto& b) {
         return b.mix({0.75, 0.5, 0.25}, Vec3d(0.9), 0.4);
     }},
    {"dielectric", [](auto& b) { return b.dielectric(1.5, Vec3d(0.2, 0.1, 0)); }},
    {"conductor",
     [](auto& b) {
         return b.rough_conductor({0.75, 0.5, 0.25}, 0.4);
     }},
    {"conductor of multiple scattering",
     [](auto& b) {
         return b.rough_conductor({0.75, 0.5, 0.25}, 0.8, Vec3d(0.0), true);
     }},
    {"rough glass", [](auto& b) { return b.rough_dielectric(1.5, 0.3); }},
    {"plastic",
     [](auto& b) {
         return b.principled({0.75, 0.5, 0.25}, 0.25, 0.3);
     }},
    {"principled glass",
     [](auto& b) {
         return b.principled({0.75, 0.5, 0.25}, 0, 0.4, 0.75);
     }},
};

}  // namespace pt::test
