// Generates the Menger sponge: a cube from which, level by level, the middle third is bored out along each axis.
#include "harness/mesh/generators.h"

namespace pt {

namespace {

// Whether a cell of the Menger sponge is solid: at no level do two of its ternary digits equal 1, the middle third.
bool is_left(std::array<std::uint32_t, 3> cell) {
    for (; cell[0] + cell[1] + cell[2] > 0; cell = {cell[0] / 3, cell[1] / 3, cell[2] / 3}) {
        if ((cell[0] % 3 == 1) + (cell[1] % 3 == 1) + (cell[2] % 3 == 1) >= 2) {
            return false;
        }
    }
    return true;
}

class Sponge {
public:
    explicit Sponge(std::uint32_t side) : side_(side) {
        constexpr std::uint32_t none = 0xffffffff;
        vertex_at_.assign(std::uint64_t{side + 1} * (side + 1) * (side + 1), none);
        for (std::uint32_t x = 0; x < side; ++x) {
            for (std::uint32_t y = 0; y < side; ++y) {
                for (std::uint32_t z = 0; z < side; ++z) {
                    if (is_left({x, y, z})) {
                        add_cell({x, y, z});
                    }
                }
            }
        }
    }

    Mesh mesh() { return std::move(mesh_); }

private:
    void add_cell(const std::array<std::uint32_t, 3>& cell) {
        for (int axis = 0; axis < 3; ++axis) {
            auto below = cell, above = cell;
            --below[axis];  // unsigned: a cell index below 0 wraps round to one beyond the sponge's cube
            ++above[axis];
            if (below[axis] >= side_ || !is_left(below)) {
                add_face(cell, (axis + 2) % 3, (axis + 1) % 3);
            }
            if (above[axis] >= side_ || !is_left(above)) {
                add_face(above, (axis + 1) % 3, (axis + 2) % 3);
            }
        }
    }

    // Adds a face of a cell of the sponge, whose normal points along the cross product of the axes u and v.
    void add_face(std::array<std::uint32_t, 3> corner, int u, int v) {
        const std::uint32_t a = vertex(corner);
        ++corner[u];
        const std::uint32_t b = vertex(corner);
        ++corner[v];
        const std::uint32_t c = vertex(corner);
        --corner[u];
        const std::uint32_t d = vertex(corner);
        mesh_.triangles.push_back({a, b, c});
        mesh_.triangles.push_back({a, c, d});
    }

    std::uint32_t vertex(const std::array<std::uint32_t, 3>& at) {
        std::uint32_t& index = vertex_at_[(std::uint64_t{at[0]} * (side_ + 1) + at[1]) * (side_ + 1) + at[2]];
        if (index == 0xffffffff) {
            index = static_cast<std::uint32_t>(mesh_.vertices.size());
            const auto place = [&](std::uint32_t i) { return static_cast<float>((2.0 * i - side_) / side_); };
            mesh_.vertices.push_back({place(at[0]), place(at[1]), place(at[2])});
        }
        return index;
    }

    std::uint32_t side_;
    std::vector<std::uint32_t> vertex_at_;  // vertex index at each point of the sponge's lattice
    Mesh mesh_;
};

}  // namespace

Mesh make_menger_sponge(std::uint32_t level) {
    std::uint32_t side = 1;
    for (std::uint32_t i = 0; i < level; ++i) {
        side *= 3;
    }
    return Sponge(side).mesh();
}

}  // namespace pt
