// Generates meshes of tubes along curves: a knot, tori and a hairball.
#include <cmath>

#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

namespace {

// Adds the triangles between consecutive rings of `corners` vertices each, stored from `first` on. The outside is where
// each ring's vertices are counter-clockwise as seen against the direction of the tube.
void join_rings(Mesh& mesh, std::uint32_t first, std::uint32_t rings, std::uint32_t corners, bool is_closed) {
    for (std::uint32_t i = 0; i + (is_closed ? 0 : 1) < rings; ++i) {
        for (std::uint32_t j = 0; j < corners; ++j) {
            const std::uint32_t ring = first + i * corners, next = first + (i + 1) % rings * corners;
            const std::uint32_t a = ring + j, b = ring + (j + 1) % corners;
            const std::uint32_t c = next + j, d = next + (j + 1) % corners;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({b, d, c});
        }
    }
}

// Adds a ring of vertices round `centre`; `forward`, `side` and their cross product form a right-handed frame.
void add_ring(Mesh& mesh, const glm::dvec3& centre, const glm::dvec3& forward, const glm::dvec3& side, double radius,
              std::uint32_t corners) {
    const glm::dvec3 other = glm::cross(forward, side);
    for (std::uint32_t j = 0; j < corners; ++j) {
        const SineCosine angle = exact_sine_cosine(2.0 * exact_pi * j / corners);
        mesh.vertices.push_back(in_single(centre + radius * (angle.cosine * side + angle.sine * other)));
    }
}

// The columns of a uniformly random rotation (Shoemake 1992).
struct Turn {
    glm::dvec3 x, y, z;
};
Turn draw_turn(MeshRandom& random) {
    const double share = random.uniform();
    const SineCosine one = exact_sine_cosine(2.0 * exact_pi * random.uniform());
    const SineCosine two = exact_sine_cosine(2.0 * exact_pi * random.uniform());
    const double x = std::sqrt(1.0 - share) * one.sine, y = std::sqrt(1.0 - share) * one.cosine;
    const double z = std::sqrt(share) * two.sine, w = std::sqrt(share) * two.cosine;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
            {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
            {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

constexpr std::uint32_t hair_pieces = 24, hair_sides = 6;

void add_hair(Mesh& mesh, MeshRandom& random) {
    constexpr double piece_length = 0.04, radius = 0.0015, bend = 0.35, root = 0.15;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    glm::dvec3 direction = random.direction(), forward = direction;
    glm::dvec3 at = root * direction;
    glm::dvec3 side = std::abs(direction.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    for (std::uint32_t i = 0; i <= hair_pieces; ++i) {
        side = glm::normalize(side - glm::dot(side, forward) * forward);  // keeps the tube of a hair from twisting
        add_ring(mesh, at, forward, side, radius, hair_sides);
        at += piece_length * direction;
        const glm::dvec3 next = glm::normalize(direction + bend * random.direction());
        forward = glm::normalize(direction + next);
        direction = next;
    }
    join_rings(mesh, first, hair_pieces + 1, hair_sides, false);
}

}  // namespace

Mesh make_trefoil(std::uint32_t n) {
    constexpr double tube = 0.4, scale = 1.0 / 3.4;
    const std::uint32_t rings = 8 * n;
    Mesh mesh;
    for (std::uint32_t i = 0; i < rings; ++i) {
        const double t = 2.0 * exact_pi * i / rings;
        const SineCosine two = exact_sine_cosine(2.0 * t), three = exact_sine_cosine(3.0 * t);
        // The knot winds on a torus of radii 2 and 1 about the y axis; `side` is the normal of that torus.
        const glm::dvec3 around(two.cosine, 0.0, -two.sine), along(-two.sine, 0.0, -two.cosine), up(0.0, 1.0, 0.0);
        const double distance = 2.0 + three.cosine;
        const glm::dvec3 side = three.cosine * around + three.sine * up;
        const glm::dvec3 forward = 2.0 * distance * along + 3.0 * (three.cosine * up - three.sine * around);
        add_ring(mesh, scale * (distance * around + three.sine * up), glm::normalize(forward), side, scale * tube, n);
    }
    join_rings(mesh, 0, rings, n, true);
    return mesh;
}

Mesh make_tori(std::uint32_t count) {
    constexpr std::uint32_t rings = 64, corners = 32;
    constexpr double radius = 1.0, tube = 0.3;
    Mesh mesh;
    mesh.vertices.reserve(std::size_t{count} * rings * corners);
    mesh.triangles.reserve(std::size_t{count} * rings * corners * 2);
    MeshRandom random(1);
    for (std::uint32_t k = 0; k < count; ++k) {
        const Turn turn = draw_turn(random);
        const double scale = random.uniform(0.08, 0.18);
        const glm::dvec3 centre = random.point(-1.0, 1.0);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::uint32_t i = 0; i < rings; ++i) {
            const SineCosine angle = exact_sine_cosine(2.0 * exact_pi * i / rings);
            const glm::dvec3 side = angle.cosine * turn.x + angle.sine * turn.z;
            const glm::dvec3 forward = angle.cosine * turn.z - angle.sine * turn.x;
            add_ring(mesh, centre + scale * radius * side, forward, side, scale * tube, corners);
        }
        join_rings(mesh, first, rings, corners, true);
    }
    return mesh;
}

Mesh make_hairball(std::uint32_t strands) {
    Mesh mesh;
    mesh.vertices.reserve(std::size_t{strands} * (hair_pieces + 1) * hair_sides);
    mesh.triangles.reserve(std::size_t{strands} * hair_pieces * hair_sides * 2);
    MeshRandom random(2);
    for (std::uint32_t i = 0; i < strands; ++i) {
        add_hair(mesh, random);
    }
    return mesh;
}

}  // namespace pt
