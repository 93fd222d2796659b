#include "harness/rays/probe_meshes.h"

#include <array>
#include <cmath>

#include "harness/mesh/exact_math.h"

namespace pt::rays {
namespace {

using Point = std::array<double, 3>;

std::array<float, 3> rounded(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

void add_torus(MeshRandom& random, Mesh& mesh) {
    constexpr std::uint32_t n = 64, m = 32;
    // A uniformly random rotation as a quaternion from two random directions in the plane (Shoemake 1992).
    const double u = random.uniform(), a = random.uniform(0.0, 2.0 * exact_pi), b = random.uniform(0.0, 2.0 * exact_pi);
    const SineCosine sa = exact_sine_cosine(a), sb = exact_sine_cosine(b);
    const double w = std::sqrt(1.0 - u) * sa.sine, x = std::sqrt(1.0 - u) * sa.cosine;
    const double y = std::sqrt(u) * sb.sine, z = std::sqrt(u) * sb.cosine;
    const double size = 0.08 + 0.1 * random.uniform();
    const glm::dvec3 centre = random.point(-1.0, 1.0);
    const Point rows[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < m; ++j) {
            const SineCosine along = exact_sine_cosine(2.0 * exact_pi * i / n),
                             round = exact_sine_cosine(2.0 * exact_pi * j / m);
            const double reach = size * (1.0 + 0.3 * round.cosine);
            const Point p{reach * along.cosine, size * 0.3 * round.sine, reach * along.sine};
            Point q;
            for (int k = 0; k < 3; ++k) {
                q[k] = rows[k][0] * p[0] + rows[k][1] * p[1] + rows[k][2] * p[2] + centre[k];
            }
            mesh.vertices.push_back(rounded(q));
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < m; ++j) {
            const std::uint32_t i1 = (i + 1) % n, j1 = (j + 1) % m;
            const std::uint32_t p = first + i * m + j, q = first + i * m + j1, r = first + i1 * m + j,
                                t = first + i1 * m + j1;
            mesh.triangles.push_back({p, q, r});
            mesh.triangles.push_back({q, t, r});
        }
    }
}

const ProbeMesh probes[] = {
    {"sphere_262k", [] { return sphere_in_box(256, 40.0); }},
    {"sphere_2M", [] { return sphere_in_box(724, 90.0); }},
    {"sphere_8M", [] { return sphere_in_box(1448, 150.0); }},
    {"tori_262k", [] { return tori_in_box(64); }},
    {"tori_4M", [] { return tori_in_box(1000); }},
};

}  // namespace

std::span<const ProbeMesh> probe_meshes() { return probes; }

void add_box(Mesh& mesh, const std::array<float, 3>& centre, float half) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < 8; ++i) {
        mesh.vertices.push_back({centre[0] + ((i & 4u) != 0 ? half : -half), centre[1] + ((i & 2u) != 0 ? half : -half),
                                 centre[2] + ((i & 1u) != 0 ? half : -half)});
    }
    constexpr std::uint32_t quads[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                           {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& q : quads) {
        mesh.triangles.push_back({first + q[0], first + q[1], first + q[2]});
        mesh.triangles.push_back({first + q[0], first + q[2], first + q[3]});
    }
}

Mesh sphere_in_box(std::uint32_t n, double waves) {
    const std::uint32_t columns = 2 * n;
    Mesh mesh;
    mesh.vertices.reserve(static_cast<std::size_t>(n + 1) * columns);
    for (std::uint32_t i = 0; i <= n; ++i) {
        const double theta = exact_pi * i / n;
        const SineCosine polar = exact_sine_cosine(theta);
        const double swing = 0.05 * exact_sine_cosine(waves * theta).sine;
        for (std::uint32_t j = 0; j < columns; ++j) {
            const double phi = 2.0 * exact_pi * j / columns;
            const SineCosine round = exact_sine_cosine(phi);
            const double r = 1.0 + swing * exact_sine_cosine(waves * phi).cosine;
            mesh.vertices.push_back(
                rounded({r * polar.sine * round.cosine, r * polar.cosine, r * polar.sine * round.sine}));
        }
    }
    mesh.triangles.reserve(static_cast<std::size_t>(4) * n * n + 12);
    for (const bool lower : {false, true}) {
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = 0; j < columns; ++j) {
                const std::uint32_t a = i * columns + j, b = i * columns + (j + 1) % columns, c = a + columns,
                                    d = b + columns;
                mesh.triangles.push_back(lower ? std::array{b, c, d} : std::array{a, c, b});
            }
        }
    }
    add_box(mesh, {0.0f, 0.0f, 0.0f}, 2.0f);
    return mesh;
}

Mesh tori_in_box(std::uint32_t count) {
    MeshRandom random(1);
    Mesh mesh;
    mesh.triangles.reserve(static_cast<std::size_t>(4096) * count + 12);
    for (std::uint32_t i = 0; i < count; ++i) {
        add_torus(random, mesh);
    }
    add_box(mesh, {0.0f, 0.0f, 0.0f}, 2.0f);
    return mesh;
}

}  // namespace pt::rays
