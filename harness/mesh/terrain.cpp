// Generates a height field of value noise: random heights on ever finer lattices, each half as high as the one before,
// interpolated by the cubic 3 t^2 - 2 t^3 (Perlin 1985).
#include <cmath>

#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

namespace {

double lattice_height(std::uint32_t octave, std::uint32_t i, std::uint32_t j) {
    MeshRandom random(std::uint64_t{octave} << 58 | std::uint64_t{i} << 29 | j);
    (void)random.bits();  // the first random number is dropped: it is correlated between adjacent seeds
    return random.uniform(-1.0, 1.0);
}

// Height of one octave of value noise, which has 2^octave cells per side. x and z count cells of the finest lattice,
// which has 2^level per side.
double octave_height(std::uint32_t octave, std::uint32_t level, std::uint32_t x, std::uint32_t z) {
    const std::uint32_t step = 1u << (level - octave), i = x / step, j = z / step;
    const double u = static_cast<double>(x % step) / step, v = static_cast<double>(z % step) / step;
    const double su = u * u * (3.0 - 2.0 * u), sv = v * v * (3.0 - 2.0 * v);
    const double near = lattice_height(octave, i, j) * (1.0 - su) + lattice_height(octave, i + 1, j) * su;
    const double far = lattice_height(octave, i, j + 1) * (1.0 - su) + lattice_height(octave, i + 1, j + 1) * su;
    return near * (1.0 - sv) + far * sv;
}

}  // namespace

Mesh make_terrain(std::uint32_t level) {
    constexpr double height = 0.4;
    const std::uint32_t cells = 1u << level, side = cells + 1;
    Mesh mesh;
    mesh.vertices.reserve(std::size_t{side} * side);
    mesh.triangles.reserve(std::size_t{cells} * cells * 2);
    for (std::uint32_t x = 0; x < side; ++x) {
        for (std::uint32_t z = 0; z < side; ++z) {
            double y = 0.0;
            for (std::uint32_t octave = 1; octave <= level; ++octave) {
                y += std::ldexp(height, -static_cast<int>(octave)) * octave_height(octave, level, x, z);
            }
            mesh.vertices.push_back(in_single({2.0 * x / cells - 1.0, y, 2.0 * z / cells - 1.0}));
        }
    }
    for (std::uint32_t x = 0; x < cells; ++x) {
        for (std::uint32_t z = 0; z < cells; ++z) {
            const std::uint32_t a = x * side + z, b = a + 1, c = a + side, d = c + 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({b, d, c});
        }
    }
    return mesh;
}

}  // namespace pt
