// Generates the Cornell box (Goral, Torrance, Greenberg, Battaile 1984): the room of scenes/cornell_open.json, and two
// blocks with the dimensions published by Cornell's graphics programme.
#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

namespace {

// Adds a quad as n x n x 2 triangles. Its corners a, b, c, d are counter-clockwise as seen from the side of its normal.
void add_quad(Mesh& mesh, std::uint32_t n, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
              const glm::dvec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
            mesh.vertices.push_back(in_single((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c)));
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t corner = first + i * (n + 1) + j, along = corner + n + 1;
            mesh.triangles.push_back({corner, along, along + 1});
            mesh.triangles.push_back({corner, along + 1, corner + 1});
        }
    }
}

// A block of the Cornell box as measured, in millimetres: x to the left, z into the room, whose corner is the origin.
struct Block {
    double height;
    double x[4], z[4];  // corners of the block's base, in order round its border
};
constexpr Block short_block{165, {130, 82, 240, 290}, {65, 225, 272, 114}};
constexpr Block tall_block{330, {423, 265, 314, 472}, {247, 296, 456, 406}};

void add_block(Mesh& mesh, std::uint32_t n, const Block& block) {
    constexpr double measured_side = 555.0, side = 10.0;
    glm::dvec3 foot[4], top[4];
    for (int i = 0; i < 4; ++i) {
        const double x = side / 2 - side / measured_side * block.x[i], z = side / 2 - side / measured_side * block.z[i];
        foot[i] = {x, 0.0, z};
        top[i] = {x, side / measured_side * block.height, z};
    }
    add_quad(mesh, n, top[0], top[1], top[2], top[3]);
    for (int i = 0; i < 4; ++i) {
        const int next = (i + 1) % 4;
        add_quad(mesh, n, foot[i], foot[next], top[next], top[i]);
    }
}

}  // namespace

Mesh make_cornell_box(std::uint32_t n) {
    constexpr double low = -5.0, high = 5.0, ceiling = 10.0;
    const glm::dvec3 a(low, 0, low), b(high, 0, low), c(high, 0, high), d(low, 0, high), up(0, ceiling, 0);
    Mesh mesh;
    add_quad(mesh, n, d, c, b, a);                      // floor of the Cornell box
    add_quad(mesh, n, a + up, b + up, c + up, d + up);  // ceiling of the Cornell box
    add_quad(mesh, n, a, b, b + up, a + up);            // back wall of the Cornell box
    add_quad(mesh, n, d, a, a + up, d + up);            // left wall of the Cornell box
    add_quad(mesh, n, b, c, c + up, b + up);            // right wall of the Cornell box
    add_block(mesh, n, short_block);
    add_block(mesh, n, tall_block);
    return mesh;
}

}  // namespace pt
