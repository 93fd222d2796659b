// Generates triangles that are hard for a BVH: long thin ones in all directions, and many equal ones.
#include <cmath>

#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

Mesh make_needles(std::uint32_t count) {
    Mesh mesh;
    MeshRandom random(3);
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::dvec3 centre = random.point(-1.0, 1.0), direction = random.direction();
        const double length = random.uniform(0.2, 0.6);
        const double width = std::ldexp(length, -7 - static_cast<int>(random.bits() % 7));
        const glm::dvec3 across = glm::normalize(glm::cross(direction, random.direction()));
        const glm::dvec3 tip = centre + 0.5 * length * direction, foot = centre - 0.5 * length * direction;
        const std::uint32_t first = 3 * i;
        mesh.vertices.push_back(in_single(tip));
        mesh.vertices.push_back(in_single(foot + 0.5 * width * across));
        mesh.vertices.push_back(in_single(foot - 0.5 * width * across));
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

Mesh make_equal_triangles(std::uint32_t count) {
    Mesh mesh;
    mesh.vertices = {{-1.0f, -1.0f, 0.0f}, {1.0f, -1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
    mesh.triangles.assign(count, {0, 1, 2});
    return mesh;
}

}  // namespace pt
