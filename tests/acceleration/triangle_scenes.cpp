#include "tests/acceleration/triangle_scenes.h"

#include <algorithm>
#include <cmath>

#include "tests/support/random_vectors.h"
#include "tests/support/statistics.h"
#include "variants/bvh/box.h"
#include "variants/bvh/primitive_boxes.h"

namespace pt::test {

using V = Vec3<float>;

Triangles random_soup(std::uint32_t count, float size, std::uint64_t seed) {
    Random random(seed);
    Triangles triangles(count);
    for (Triangle<float>& triangle : triangles) {
        const V at = random_in_cube<float>(random, 1);
        triangle = {at + random_in_cube<float>(random, size), at + random_in_cube<float>(random, size),
                    at + random_in_cube<float>(random, size)};
    }
    return triangles;
}

Triangles needles(std::uint32_t count, float aspect, std::uint64_t seed) {
    Random random(seed);
    Triangles triangles(count);
    for (Triangle<float>& triangle : triangles) {
        const V from = random_in_cube<float>(random, 1);
        triangle = {from, from + random_in_cube<float>(random, 0.6),
                    from + random_in_cube<float>(random, 0.6) * (1 / aspect)};
    }
    return triangles;
}

Triangles needle_bundle(std::uint32_t count, float width, std::uint64_t seed) {
    Random random(seed);
    Triangles triangles(count);
    for (Triangle<float>& triangle : triangles) {
        const V a = random_in_cube<float>(random, 1) * V{1e-3f, 1e-3f, 1};
        const V b{a.x + static_cast<float>(random.uniform(-1e-5, 1e-5)), a.y,
                  static_cast<float>(random.uniform(-1, 1))};
        triangle = {a, b, b + random_in_cube<float>(random, width)};
    }
    return triangles;
}

Triangles sticks_in_soup(std::uint32_t small, std::uint32_t sticks, std::uint64_t seed) {
    Random random(seed);
    Triangles triangles = random_soup(small, 0.02f, seed + 1);
    for (std::uint32_t i = 0; i < sticks; ++i) {
        const V middle = random_in_cube<float>(random, 1), half{1, 1, 0.2f};
        triangles.push_back({middle - half, middle + half, middle + half + random_in_cube<float>(random, 0.01)});
    }
    return triangles;
}

Triangles grid_sphere(std::uint32_t rings, std::uint32_t sectors, V centre, float radius) {
    const auto vertex = [&](std::uint32_t ring, std::uint32_t sector) {
        if (ring == 0 || ring == rings) {
            return centre + V{0, 0, ring == 0 ? radius : -radius};
        }
        const double theta = pi<double> * ring / rings, phi = 2 * pi<double> * (sector % sectors) / sectors;
        return centre + radius * V{static_cast<float>(std::sin(theta) * std::cos(phi)),
                                   static_cast<float>(std::sin(theta) * std::sin(phi)),
                                   static_cast<float>(std::cos(theta))};
    };
    Triangles triangles;
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        for (std::uint32_t sector = 0; sector < sectors; ++sector) {
            const V a = vertex(ring, sector), b = vertex(ring + 1, sector), c = vertex(ring + 1, sector + 1),
                    d = vertex(ring, sector + 1);
            if (ring + 1 < rings) {
                triangles.push_back({a, b, c});
            }
            if (ring > 0) {
                triangles.push_back({a, c, d});
            }
        }
    }
    return triangles;
}

namespace {

void add_box(Triangles& triangles, V low, V high) {
    const auto corner = [&](int bits) {
        return V{(bits & 1) != 0 ? high.x : low.x, (bits & 2) != 0 ? high.y : low.y, (bits & 4) != 0 ? high.z : low.z};
    };
    constexpr int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces) {
        triangles.push_back({corner(face[0]), corner(face[1]), corner(face[2])});
        triangles.push_back({corner(face[0]), corner(face[2]), corner(face[3])});
    }
}

void add_menger(Triangles& triangles, V low, std::uint32_t level) {
    if (level == 0) {
        add_box(triangles, low, low + V{1, 1, 1});
        return;
    }
    const auto side = static_cast<float>(std::lround(std::pow(3, level - 1)));
    for (int cell = 0; cell < 27; ++cell) {
        const int x = cell % 3, y = cell / 3 % 3, z = cell / 9;
        if ((x == 1) + (y == 1) + (z == 1) < 2) {
            add_menger(triangles, low + side * V{x, y, z}, level - 1);
        }
    }
}

}  // namespace

Triangles menger(std::uint32_t level) {
    Triangles triangles;
    add_menger(triangles, {0, 0, 0}, level);
    return triangles;
}

Triangles equal_triangles(std::uint32_t count) { return Triangles(count, {{0, 0, 0}, {1, 0, 0.25f}, {0, 1, 0.5f}}); }

Triangles flat_triangles(std::uint32_t count, std::uint64_t seed) {
    Random random(seed);
    Triangles triangles(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const V a = random_in_cube<float>(random, 1), b = random_in_cube<float>(random, 1);
        V c = random_in_cube<float>(random, 1), d = b;
        const auto axis = static_cast<int>(i % 3);
        c[axis] = d[axis] = a[axis];
        triangles[i] = i % 4 == 0   ? Triangle<float>{a, a, a}
                       : i % 4 == 1 ? Triangle<float>{a, a + 0.5f * (b - a), b}
                                    : Triangle<float>{a, d, c};
    }
    return triangles;
}

Triangles large_floor(float size) {
    Triangles triangles;
    triangles.push_back({{-size, -1, -size}, {size, -1, -size}, {size, -1, size}});
    triangles.push_back({{-size, -1, -size}, {size, -1, size}, {-size, -1, size}});
    for (const Triangle<float>& triangle : random_soup(400, 0.1f, 41)) {
        triangles.push_back(triangle);
    }
    return triangles;
}

Triangles geometric_progression(std::uint32_t count) {
    Triangles triangles;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float side = std::ldexp(1.0f, -static_cast<int>(i % 120));
        triangles.push_back({{side, side, 0}, {2 * side, side, 0.5f * side}, {side, 2 * side, side}});
    }
    return triangles;
}

Triangles moved(Triangles triangles, V by) {
    for (Triangle<float>& t : triangles) {
        t = {t.a + by, t.b + by, t.c + by};
    }
    return triangles;
}

Triangles scaled(Triangles triangles, int exponent) {
    const float factor = std::ldexp(1.0f, exponent);
    for (Triangle<float>& t : triangles) {
        t = {t.a * factor, t.b * factor, t.c * factor};
    }
    return triangles;
}

std::vector<TriangleScene> triangle_scenes() {
    return {{"one", random_soup(1, 1, 1)},
            {"two", random_soup(2, 1, 2)},
            {"five", random_soup(5, 1, 3)},
            {"soup", random_soup(2000, 0.1f, 4)},
            {"large_soup", random_soup(300, 1, 5)},
            {"sphere", grid_sphere(24, 40, {0, 0, 0}, 1)},
            {"menger", menger(2)},
            {"equal", equal_triangles(500)},
            {"flat", flat_triangles(600, 6)},
            {"needles", needles(600, 1e3f, 7)},
            {"bundle", needle_bundle(300, 1e-5f, 11)},
            {"thick_bundle", needle_bundle(300, 1e-3f, 12)},
            {"sticks", sticks_in_soup(1500, 100, 10)},
            {"floor", large_floor(1000)},
            {"progression", geometric_progression(240)},
            {"sphere_far_away", moved(grid_sphere(24, 40, {0, 0, 0}, 1), {3e5f, -2e5f, 1e5f})},
            {"menger_far_away", moved(menger(2), {1 << 20, -(1 << 21), 1 << 19})},
            {"soup_tiny", scaled(random_soup(600, 0.1f, 8), -40)},
            {"soup_huge", scaled(random_soup(600, 0.1f, 9), 40)}};
}

namespace {

V point_on(const Triangle<float>& t, float u, float v) { return t.a + u * (t.b - t.a) + v * (t.c - t.a); }

V axis_direction(std::uint32_t which) {
    const float zero = (which & 1) != 0 ? -0.0f : 0.0f, one = (which & 2) != 0 ? -1.0f : 1.0f;
    V direction{zero, zero, zero};
    direction[static_cast<int>(which / 4 % 3)] = one;
    return direction;
}

}  // namespace

std::vector<TestRay> rays_for(const Triangles& triangles, std::uint32_t count, std::uint64_t seed) {
    Random random(seed);
    Box box;
    for (const Triangle<float>& triangle : triangles) {
        join(box, box_of(triangle));
    }
    const V low{box.low[0], box.low[1], box.low[2]}, extent = V{box.high[0], box.high[1], box.high[2]} - low;
    const auto inside = [&] {
        const V weight = random_in_cube<float>(random, 0.5) + V{0.5f, 0.5f, 0.5f};
        return low + weight * extent;
    };
    std::vector<TestRay> rays;
    for (std::uint32_t turn = 0; rays.size() < count; ++turn) {
        const Triangle<float>& t = triangles[random.word() % triangles.size()];
        const Triangle<float>& other = triangles[random.word() % triangles.size()];
        const auto u = static_cast<float>(random.uniform()), v = static_cast<float>(random.uniform(0, 1 - u));
        const V somewhere = inside() + 1.5f * (inside() - inside());
        V flat = random_in_cube<float>(random, 1);
        flat[static_cast<int>(random.word() % 3)] = (random.word() & 1) != 0 ? 0.0f : -0.0f;
        TestRay ray{somewhere, random_in_cube<float>(random, 1)};
        switch (turn % 13) {
            case 0:
                break;
            case 1:
                ray.direction = point_on(t, u, v) - somewhere;
                break;
            case 2:
                ray.direction = axis_direction(random.word() >> 8);
                break;
            case 3:
                ray.direction = flat;
                break;
            case 4:  // along an axis from a vertex's own planes
                ray = {t.a - 2.0f * axis_direction(random.word() >> 8) * extent, axis_direction(random.word() >> 8)};
                break;
            case 5:
                ray.direction = t.a - somewhere;
                break;
            case 6:
                ray.direction = point_on(t, u, 0) - somewhere;
                break;
            case 7:
                ray = {point_on(t, u, v), point_on(other, u, v) - point_on(t, u, v)};
                break;
            case 8:
                ray.origin = t.b;
                break;
            case 9:  // along an edge
                ray = {t.a, t.b - t.a};
                break;
            case 10: {  // from afar, at a small angle to what is long
                V from = low + 0.5f * extent;
                from[longest_axis(box)] += 3 * extent[longest_axis(box)];
                ray = {from + 0.1f * extent[longest_axis(box)] * random_in_cube<float>(random, 1), {0, 0, 0}};
                ray.direction = point_on(t, u, v) - ray.origin;
                break;
            }
            case 11:
                ray = {t.a - 0.5f * (t.c - t.a), t.c - t.a};
                break;
            default:
                ray = {point_on(t, u, v), axis_direction(random.word() >> 8)};
        }
        const float longest =
            std::max({std::fabs(ray.direction.x), std::fabs(ray.direction.y), std::fabs(ray.direction.z)});
        if (longest > 0) {
            const bool as_it_is = random.word() % 2 == 0;  // directions need not be unit vectors
            ray.direction = as_it_is ? ray.direction : ray.direction / longest;
            rays.push_back(ray);
        }
    }
    return rays;
}

}  // namespace pt::test
