// Generates bumpy spheres: a repeatedly divided icosahedron, and a grid in latitude and longitude.
#include <cmath>

#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

namespace {

// A triangle mesh on the sphere that stores edges, so that each edge's midpoint is created once without a search.
struct DividedSphere {
    std::vector<glm::dvec3> vertices;
    std::vector<std::array<std::uint32_t, 2>> edges;      // indices of an edge's two end vertices
    std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of a triangle's three vertices
    std::vector<std::array<std::uint32_t, 3>> sides;      // edges of a triangle: edge i goes from corner i to the next
};

DividedSphere icosahedron() {
    const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
    DividedSphere sphere;
    for (int axis = 0; axis < 3; ++axis) {  // an icosahedron's corners are those of three golden rectangles
        for (const auto& [a, b] : {std::pair{-1.0, -golden}, {1.0, -golden}, {-1.0, golden}, {1.0, golden}}) {
            glm::dvec3 corner(0.0);
            corner[axis] = a;
            corner[(axis + 1) % 3] = b;
            sphere.vertices.push_back(glm::normalize(corner));
        }
    }
    const auto near = [&](std::uint32_t a, std::uint32_t b) {  // vertices' cosine: 1/sqrt(5) along an edge, else < 0
        return glm::dot(sphere.vertices[a], sphere.vertices[b]) > 0.4;
    };
    std::uint32_t edge_of[12][12] = {};
    for (std::uint32_t a = 0; a < 12; ++a) {
        for (std::uint32_t b = a + 1; b < 12; ++b) {
            if (near(a, b)) {
                edge_of[a][b] = edge_of[b][a] = static_cast<std::uint32_t>(sphere.edges.size());
                sphere.edges.push_back({a, b});
            }
        }
    }
    for (std::uint32_t a = 0; a < 12; ++a) {
        for (std::uint32_t b = a + 1; b < 12; ++b) {
            for (std::uint32_t c = a + 1; c < 12; ++c) {
                const glm::dvec3 normal = glm::cross(sphere.vertices[b], sphere.vertices[c]);
                if (near(a, b) && near(b, c) && near(c, a) && glm::dot(normal, sphere.vertices[a]) > 0.0) {
                    sphere.triangles.push_back({a, b, c});
                    sphere.sides.push_back({edge_of[a][b], edge_of[b][c], edge_of[c][a]});
                }
            }
        }
    }
    return sphere;
}

// Splits each triangle into four. Edge e becomes edges 2 e (at its first end) and 2 e + 1, with midpoint vertex V + e.
// Inside triangle t, the new edge that cuts off corner i is 2 E + 3 t + i (V vertices, E edges before).
DividedSphere divided(const DividedSphere& old) {
    const auto vertices = static_cast<std::uint32_t>(old.vertices.size());
    const auto edges = static_cast<std::uint32_t>(old.edges.size());
    DividedSphere sphere;
    sphere.vertices = old.vertices;
    sphere.edges.resize(2 * old.edges.size() + 3 * old.triangles.size());
    sphere.triangles.reserve(4 * old.triangles.size());
    sphere.sides.reserve(4 * old.triangles.size());
    for (std::uint32_t e = 0; e < edges; ++e) {
        const auto [a, b] = old.edges[e];
        sphere.vertices.push_back(glm::normalize(old.vertices[a] + old.vertices[b]));
        const std::size_t halves = 2 * std::size_t{e};
        sphere.edges[halves] = {a, vertices + e};
        sphere.edges[halves + 1] = {vertices + e, b};
    }
    for (std::uint32_t t = 0; t < old.triangles.size(); ++t) {
        const std::uint32_t inner = 2 * edges + 3 * t;
        std::array<std::uint32_t, 3> middles;
        for (std::uint32_t i = 0; i < 3; ++i) {
            middles[i] = vertices + old.sides[t][i];
        }
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t corner = old.triangles[t][i], next = old.sides[t][i], last = old.sides[t][(i + 2) % 3];
            const auto half = [&](std::uint32_t edge) { return 2 * edge + (old.edges[edge][0] == corner ? 0u : 1u); };
            sphere.edges[inner + i] = {middles[i], middles[(i + 2) % 3]};
            sphere.triangles.push_back({corner, middles[i], middles[(i + 2) % 3]});
            sphere.sides.push_back({half(next), inner + i, half(last)});
        }
        sphere.triangles.push_back(middles);
        sphere.sides.push_back({inner + 1, inner + 2, inner});
    }
    return sphere;
}

}  // namespace

Mesh make_icosphere(std::uint32_t level) {
    DividedSphere sphere = icosahedron();
    for (std::uint32_t i = 0; i < level; ++i) {
        sphere = divided(sphere);
    }
    Mesh mesh;
    mesh.vertices.reserve(sphere.vertices.size());
    for (const glm::dvec3& point : sphere.vertices) {
        constexpr double height = 0.1, waves = 5.0;
        const double bump = exact_sine_cosine(waves * point.x).sine * exact_sine_cosine(waves * point.y).sine *
                            exact_sine_cosine(waves * point.z).sine;
        mesh.vertices.push_back(in_single((1.0 + height * bump) * point));
    }
    mesh.triangles = std::move(sphere.triangles);
    return mesh;
}

Mesh make_grid_sphere(std::uint32_t n, double bump, std::uint32_t frequency) {
    const double theta_step = exact_pi / n, phi_step = 2.0 * exact_pi / (2.0 * n);
    Mesh mesh;
    mesh.vertices.push_back({0.0f, 1.0f, 0.0f});
    for (std::uint32_t i = 1; i < n; ++i) {
        const SineCosine theta = exact_sine_cosine(i * theta_step);
        const double wave = exact_sine_cosine(frequency * (i * theta_step)).sine;
        for (std::uint32_t j = 0; j < 2 * n; ++j) {
            const SineCosine phi = exact_sine_cosine(j * phi_step);
            const double radius = 1.0 + bump * wave * exact_sine_cosine(frequency * (j * phi_step)).cosine;
            mesh.vertices.push_back(
                in_single({radius * theta.sine * phi.cosine, radius * theta.cosine, radius * theta.sine * phi.sine}));
        }
    }
    mesh.vertices.push_back({0.0f, -1.0f, 0.0f});
    const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
        return i == 0   ? 0
               : i == n ? static_cast<std::uint32_t>(mesh.vertices.size() - 1)
                        : 1 + (i - 1) * 2 * n + j % (2 * n);
    };
    for (std::uint32_t half = 0; half < 2; ++half) {  // OptiX probe's triangle order: one of each quad, then the rest
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = 0; j < 2 * n; ++j) {
                const std::uint32_t a = vertex(i, j), b = vertex(i, j + 1), c = vertex(i + 1, j),
                                    d = vertex(i + 1, j + 1);
                if (half == 0 ? i > 0 : i + 1 < n) {
                    mesh.triangles.push_back(half == 0 ? std::array{a, b, c} : std::array{b, d, c});
                } else {
                    ++mesh.degenerate_left_out;  // two corners of the triangle are a pole of the sphere
                }
            }
        }
    }
    return mesh;
}

Mesh make_probe_sphere(std::uint32_t n) { return make_grid_sphere(n, 0.05, n <= 256 ? 40 : n <= 724 ? 90 : 150); }

}  // namespace pt
