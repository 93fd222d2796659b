#include "stability/oracles/stiff_meshes.h"

#include <cmath>
#include <map>
#include <numeric>

#include "harness/mesh/check_mesh.h"
#include "harness/mesh/exact_math.h"

namespace pt::stability {

namespace {

using Corner = std::array<float, 3>;

// Adds vertices to a mesh by position, so that triangles with a corner at the same place share its vertex.
class SharedVertices {
public:
    explicit SharedVertices(Mesh& mesh) : mesh_(mesh) {}

    std::uint32_t at(double x, double y, double z) {
        const Corner corner = in_single({x, y, z});
        const auto [known, is_new] = numbers_.try_emplace(corner, static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (is_new) {
            mesh_.vertices.push_back(corner);
        }
        return known->second;
    }
    std::uint32_t at(const std::array<double, 3>& p) { return at(p[0], p[1], p[2]); }

private:
    Mesh& mesh_;
    std::map<Corner, std::uint32_t> numbers_;
};

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

// Adds a ring of n vertices with a radius and a height z, and returns their numbers.
std::vector<std::uint32_t> ring(SharedVertices& vertices, std::uint32_t n, double radius, double z) {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < n; ++i) {
        const SineCosine angle = exact_sine_cosine(2 * exact_pi * i / n);
        numbers.push_back(vertices.at(radius * angle.cosine, radius * angle.sine, z));
    }
    return numbers;
}

}  // namespace

Mesh grid_room(std::uint32_t n) {
    Mesh mesh;
    SharedVertices vertices(mesh);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const auto corner = [&](std::uint32_t i, std::uint32_t j) {
                std::array<double, 3> p{};
                p[static_cast<std::size_t>(axis)] = side;
                p[static_cast<std::size_t>((axis + 1) % 3)] = side * (2.0 * i / n - 1);
                p[static_cast<std::size_t>((axis + 2) % 3)] = 2.0 * j / n - 1;
                return vertices.at(p);
            };
            for (std::uint32_t i = 0; i < n; ++i) {
                for (std::uint32_t j = 0; j < n; ++j) {
                    add_quad(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
                }
            }
        }
    }
    return mesh;
}

Mesh spindle(std::uint32_t n) {
    Mesh mesh;
    SharedVertices vertices(mesh);
    const std::uint32_t top = vertices.at(0, 0, 1), bottom = vertices.at(0, 0, -1);
    const std::vector<std::uint32_t> around = ring(vertices, n, 1, 0);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = around[(i + 1) % n];
        mesh.triangles.push_back({top, around[i], next});
        mesh.triangles.push_back({bottom, next, around[i]});
    }
    return mesh;
}

Mesh book(std::uint32_t n) {
    Mesh mesh = spindle(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        mesh.triangles.push_back({0, 1, 2 + i});
    }
    return mesh;
}

Mesh striped_room(std::uint32_t k) {
    Mesh mesh;
    SharedVertices vertices(mesh);
    std::vector<double> cuts{-1};
    for (int i = -8; i <= 8; ++i) {
        cuts.push_back(std::ldexp(i, -static_cast<int>(k)));
    }
    cuts.push_back(1);
    constexpr double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const auto corner = [&](std::size_t cut, std::size_t i) {
        return vertices.at(cuts[cut], square[i % 4][0], square[i % 4][1]);
    };
    for (std::size_t cut = 0; cut + 1 < cuts.size(); ++cut) {
        for (std::size_t i = 0; i < 4; ++i) {
            add_quad(mesh, corner(cut, i), corner(cut + 1, i), corner(cut + 1, i + 1), corner(cut, i + 1));
        }
    }
    const std::size_t last = cuts.size() - 1;
    add_quad(mesh, corner(0, 0), corner(0, 1), corner(0, 2), corner(0, 3));
    add_quad(mesh, corner(last, 0), corner(last, 3), corner(last, 2), corner(last, 1));
    return mesh;
}

Mesh thin_tube(std::uint32_t n, std::uint32_t k) {
    Mesh mesh;
    SharedVertices vertices(mesh);
    const double radius = std::ldexp(1, -static_cast<int>(k));
    const std::vector<std::uint32_t> low = ring(vertices, n, radius, -1), high = ring(vertices, n, radius, 1);
    const std::uint32_t bottom = vertices.at(0, 0, -1), top = vertices.at(0, 0, 1);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = (i + 1) % n;
        add_quad(mesh, low[i], low[next], high[next], high[i]);
        mesh.triangles.push_back({bottom, low[next], low[i]});
        mesh.triangles.push_back({top, high[i], high[next]});
    }
    return mesh;
}

Mesh nested_squares(int k) {
    Mesh mesh;
    SharedVertices vertices(mesh);
    constexpr double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const auto corner = [&](int exponent, std::size_t i) {
        return vertices.at(std::ldexp(square[i % 4][0], exponent), std::ldexp(square[i % 4][1], exponent), 1);
    };
    add_quad(mesh, corner(-k, 0), corner(-k, 1), corner(-k, 2), corner(-k, 3));
    for (int exponent = -k; exponent < k; ++exponent) {
        for (std::size_t i = 0; i < 4; ++i) {
            add_quad(mesh, corner(exponent, i), corner(exponent + 1, i), corner(exponent + 1, i + 1),
                     corner(exponent, i + 1));
        }
    }
    const std::uint32_t point = vertices.at(0, 0, -std::ldexp(1, k));
    for (std::size_t i = 0; i < 4; ++i) {
        mesh.triangles.push_back({point, corner(k, i + 1), corner(k, i)});
    }
    return mesh;
}

Mesh shuffled(const Mesh& mesh, std::uint64_t seed) {
    MeshRandom random(seed);
    // Fisher-Yates shuffle, written out since std::shuffle gives another order in each standard library.
    const auto order = [&](std::size_t count) {
        std::vector<std::uint32_t> numbers(count);
        std::iota(numbers.begin(), numbers.end(), 0u);
        for (std::size_t i = count; i > 1; --i) {
            std::swap(numbers[i - 1], numbers[random.bits() % i]);
        }
        return numbers;
    };
    Mesh other = mesh;
    const std::vector<std::uint32_t> place = order(mesh.vertices.size()), turn = order(mesh.triangles.size());
    for (std::size_t i = 0; i < place.size(); ++i) {
        other.vertices[place[i]] = mesh.vertices[i];
    }
    for (std::size_t i = 0; i < turn.size(); ++i) {
        const auto& triangle = mesh.triangles[turn[i]];
        const std::size_t first = random.bits() % 3;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            other.triangles[i][corner] = place[triangle[(first + corner) % 3]];
        }
    }
    return other;
}

Mesh doubled(const Mesh& mesh) {
    Mesh twice = mesh;
    twice.triangles.insert(twice.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    return twice;
}

Mesh with_flat_ones(const Mesh& mesh) {
    Mesh more = mesh;
    more.triangles.clear();
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto& p = mesh.vertices[a];
        const auto first = static_cast<std::uint32_t>(more.vertices.size());
        more.vertices.push_back(p);
        // The two added vertices differ from the corner p in z only, so all three are exactly collinear for any p.
        more.vertices.push_back({p[0], p[1], p[2] + 0.5f});
        more.vertices.push_back({p[0], p[1], p[2] - 0.25f});
        more.triangles.push_back({a, b, b});
        more.triangles.push_back({a, b, c});
        more.triangles.push_back({a, c, first});
        more.triangles.push_back({first, first + 1, first + 2});
    }
    return more;
}

Mesh moved_by(Mesh mesh, double x, double y, double z) {
    for (auto& v : mesh.vertices) {
        v = in_single({v[0] + x, v[1] + y, v[2] + z});
    }
    return mesh;
}

}  // namespace pt::stability
