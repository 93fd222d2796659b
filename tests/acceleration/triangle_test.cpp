// The watertight triangle test itself: closed meshes have no gaps, scaling by powers of two is exact, and what it must
// not hit it does not. Where single precision ends is stated too: see WeaknessTest.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/acceleration/triangle_scenes.h"
#include "tests/support/random_vectors.h"
#include "tests/support/statistics.h"

namespace pt::test {
namespace {

using V = Vec3<float>;

TriangleHit<float> meet(const Triangle<float>& triangle, const TestRay& ray) {
    return intersect(triangle, ray.origin, ShearedDirection<float>::of(ray.direction));
}

int hits(const Triangles& triangles, const TestRay& ray) {
    const auto sheared = ShearedDirection<float>::of(ray.direction);
    int count = 0;
    for (const Triangle<float>& triangle : triangles) {
        count += intersect(triangle, ray.origin, sheared).hits ? 1 : 0;
    }
    return count;
}

V point_in(const Triangle<float>& t, Random& random) {
    const auto u = static_cast<float>(random.uniform()), v = static_cast<float>(random.uniform(0, 1 - u));
    return t.a + u * (t.b - t.a) + v * (t.c - t.a);
}

// A sphere's grid with every vertex moved along its radius, at random but alike in all its triangles: still closed, and
// star-shaped round the centre.
Triangles crumpled_sphere(std::uint32_t rings, std::uint32_t sectors, V centre, std::uint64_t seed) {
    Triangles triangles = grid_sphere(rings, sectors, {0, 0, 0}, 1);
    const auto crumple = [&](const V& vertex) {
        const auto word = [&](int axis) {
            return static_cast<std::uint64_t>(static_cast<std::uint32_t>(bits_of(vertex[axis])));
        };
        Random random(seed ^ word(0) ^ word(1) << 20 ^ word(2) << 40);
        return centre + static_cast<float>(random.uniform(0.6, 1.4)) * vertex;
    };
    for (Triangle<float>& t : triangles) {
        t = {crumple(t.a), crumple(t.b), crumple(t.c)};
    }
    return triangles;
}

std::vector<TriangleScene> closed_meshes() {
    return {{"sphere", grid_sphere(12, 20, {0, 0, 0}, 1)},
            {"crumpled", crumpled_sphere(12, 20, {0, 0, 0}, 3)},
            {"crumpled_aside", crumpled_sphere(12, 20, {100, -50, 30}, 4)},
            {"crumpled_far_away", crumpled_sphere(6, 10, {1e6f, -2e6f, 5e5f}, 5)},
            {"crumpled_small", scaled(crumpled_sphere(12, 20, {0, 0, 0}, 6), -40)},
            {"crumpled_large", scaled(crumpled_sphere(12, 20, {0, 0, 0}, 7), 40)}};
}

class ClosedMeshTest : public testing::TestWithParam<TriangleScene> {
protected:
    static V centre() {
        V sum{0, 0, 0};
        for (const Triangle<float>& t : GetParam().triangles) {
            sum += (t.a + t.b + t.c) / (3.0f * static_cast<float>(GetParam().triangles.size()));
        }
        return sum;
    }
};

// From within, a ray has to come out, whatever vertex or edge it is aimed at. Rounded, it may pass beside what it is
// aimed at, but not between.
TEST_P(ClosedMeshTest, NoRayLeavesThroughEdgesAndVertices) {
    const Triangles& triangles = GetParam().triangles;
    Random random(11);
    const V inside = centre();
    for (int turn = 0; turn < 30; ++turn) {
        const V size = triangles[0].a - inside;
        const float reach = 0.3f * std::max({std::fabs(size.x), std::fabs(size.y), std::fabs(size.z)});
        const V origin = inside + random_in_cube<float>(random, reach) * 0.5f;
        for (const Triangle<float>& t : triangles) {
            const auto s = static_cast<float>(random.uniform());
            for (const V& target :
                 {t.a, t.b, t.c, t.a + s * (t.b - t.a), t.b + s * (t.c - t.b), t.c + s * (t.a - t.c)}) {
                ASSERT_GE(hits(triangles, {origin, target - origin}), 1) << turn;
            }
        }
    }
}

// A ray along an axis, from outside: its sheared coordinates are differences alone, and vertices lie exactly on it.
TEST_P(ClosedMeshTest, AxisParallelRaysThroughVerticesMeetTheMesh) {
    const Triangles& triangles = GetParam().triangles;
    for (const Triangle<float>& t : triangles) {
        for (int axis = 0; axis < 3; ++axis) {
            V origin = t.a, direction{0, 0, 0};
            direction[axis] = 1;
            float low = t.a[axis], high = t.a[axis];
            for (const Triangle<float>& other : triangles) {
                low = std::min({low, other.a[axis], other.b[axis], other.c[axis]});
                high = std::max({high, other.a[axis], other.b[axis], other.c[axis]});
            }
            origin[axis] = low - (high - low);
            EXPECT_GE(hits(triangles, {origin, direction}), 1);
        }
    }
}

// Through the interior of triangles, a line that starts outside crosses a closed mesh an even number of times, one that
// starts at the centre an odd number.
TEST_P(ClosedMeshTest, CrossingsAreEvenFromOutsideAndOddFromInside) {
    const Triangles& triangles = GetParam().triangles;
    Random random(12);
    const V inside = centre();
    int odd = 0, total = 0;
    for (int i = 0; i < 4000; ++i) {
        const V target = point_in(triangles[random.word() % triangles.size()], random);
        const V other = point_in(triangles[random.word() % triangles.size()], random);
        const V outside = inside + 20.0f * (other - inside);
        const TestRay in{outside, target - outside}, out{inside, target - inside};
        // A ray that meets an edge to the bit counts two triangles: such are told by u, v or w of zero, and left out.
        bool is_clear = true;
        for (const Triangle<float>& t : triangles) {
            for (const TestRay& ray : {in, out}) {
                const TriangleHit<float> hit = meet(t, ray);
                is_clear = is_clear && (!hit.hits || (hit.u != 0 && hit.v != 0 && hit.w != 0));
            }
        }
        if (is_clear) {
            total += 1;
            odd += hits(triangles, in) % 2;
            ASSERT_EQ(hits(triangles, out) % 2, 1) << i;
        }
    }
    EXPECT_EQ(odd, 0);
    EXPECT_GT(total, 3000);
}

INSTANTIATE_TEST_SUITE_P(Meshes, ClosedMeshTest, testing::ValuesIn(closed_meshes()),
                         [](const auto& mesh) { return mesh.param.name; });

// On the edge to the bit: both triangles that share it, never none. All sums below are exact.
TEST(TriangleTest, ExactEdgeAndVertexBelongToAllThatShareThem) {
    const Triangles fan = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                           {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
                           {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}},
                           {{0, 0, 0}, {0, -1, 0}, {1, 0, 0}}};
    for (const float z : {-1.0f, 1.0f}) {
        EXPECT_EQ(hits(fan, {{0, 0, z}, {0, 0, -z}}), 4);
        EXPECT_EQ(hits(fan, {{0.5f, 0, z}, {0, 0, -z}}), 2);
        EXPECT_EQ(hits(fan, {{0.25f, 0.25f, z}, {0, 0, -z}}), 1);
        EXPECT_EQ(hits(fan, {{0.5f, 0.5f, z}, {0, 0, -z}}), 1);
        EXPECT_EQ(hits(fan, {{1, 0, z}, {0, 0, -z}}), 2);
        EXPECT_EQ(hits(fan, {{std::nextafter(1.0f, 2.0f), 0, z}, {0, 0, -z}}), 0);
    }
}

TEST(TriangleTest, DistanceAndWeightsAreThoseOfAnExactCase) {
    const Triangle<float> t{{0, 0, 4}, {4, 0, 4}, {0, 4, 4}};
    for (const float length : {1.0f, 2.0f, 0.5f}) {
        const TriangleHit<float> hit = meet(t, {{1, 2, 0}, {0, 0, length}});
        ASSERT_TRUE(hit.hits);
        EXPECT_EQ(hit.t, 4 / length);
        EXPECT_EQ(hit.u / hit.det, 0.25f);
        EXPECT_EQ(hit.v / hit.det, 0.25f);
        EXPECT_EQ(hit.w / hit.det, 0.5f);
    }
}

// a, b, c go round anticlockwise seen from the side that the normal (b - a) x (c - a) points to.
TEST(TriangleTest, KnowsTheSideThatItIsMetFrom) {
    Random random(71);
    for (int i = 0; i < 2000; ++i) {
        const Triangle<float> t{random_in_cube<float>(random, 1), random_in_cube<float>(random, 1),
                                random_in_cube<float>(random, 1)};
        const V normal = cross(t.b - t.a, t.c - t.a), inside = (t.a + t.b + t.c) / 3.0f;
        const V along = random_in_cube<float>(random, 1);
        const float cosine = dot(normal, along);
        if (std::fabs(cosine) > 1e-2f) {
            const TriangleHit<float> hit = meet(t, {inside - along, along});
            ASSERT_TRUE(hit.hits);
            EXPECT_EQ(hit.from_behind, cosine > 0) << i;
        }
    }
}

TEST(TriangleTest, ScalingByPowersOfTwoChangesNothing) {
    const Triangles triangles = random_soup(200, 0.5f, 21);
    const std::vector<TestRay> rays = rays_for(triangles, 300, 22);
    for (const int exponent : {-30, -7, 5, 30}) {
        const Triangles others = scaled(triangles, exponent);
        const float factor = std::ldexp(1.0f, exponent);
        for (const TestRay& ray : rays) {
            for (std::size_t i = 0; i < triangles.size(); ++i) {
                const TriangleHit<float> hit = meet(triangles[i], ray);
                const TriangleHit<float> moved_on = meet(others[i], {ray.origin * factor, ray.direction});
                const TriangleHit<float> stretched = meet(others[i], {ray.origin * factor, ray.direction * factor});
                ASSERT_EQ(hit.hits, moved_on.hits);
                ASSERT_EQ(hit.hits, stretched.hits);
                if (hit.hits) {
                    EXPECT_EQ(hit.t * factor, moved_on.t);
                    EXPECT_EQ(hit.t, stretched.t);
                    EXPECT_EQ(hit.u * factor * factor, moved_on.u);
                }
            }
        }
    }
}

// Both sides, and whichever vertex comes first: a triangle is met or it is not.
TEST(TriangleTest, OrderOfVerticesDoesNotDecideWhetherItIsHit) {
    const Triangles triangles = random_soup(300, 0.5f, 31);
    const std::vector<TestRay> rays = rays_for(triangles, 300, 32);
    int met = 0;
    for (const TestRay& ray : rays) {
        for (const Triangle<float>& t : triangles) {
            const bool expected = meet(t, ray).det != 0;
            met += expected && meet(t, ray).hits ? 1 : 0;
            for (const Triangle<float>& same : {Triangle<float>{t.b, t.c, t.a}, Triangle<float>{t.c, t.a, t.b},
                                                Triangle<float>{t.a, t.c, t.b}, Triangle<float>{t.c, t.b, t.a}}) {
                if (meet(t, ray).t > 1e-3f) {  // behind or before a ray that starts on it is decided by rounding
                    ASSERT_EQ(meet(same, ray).hits, meet(t, ray).hits);
                }
            }
        }
    }
    EXPECT_GT(met, 100);
}

// Woop et al.: the sign of an edge function is exact for sheared vertices. A strip of needles of aspect 10^6 has no
// gap.
TEST(TriangleTest, StripOfNeedlesHasNoGap) {
    Random random(41);
    Triangles strip;
    constexpr int count = 400;
    constexpr float width = 1e-6f;
    for (int i = 0; i < count; ++i) {
        const float x = width * static_cast<float>(i), next = width * static_cast<float>(i + 1);
        strip.push_back({{x, -0.5f, 0.01f}, {next, -0.5f, 0.01f}, {next, 0.5f, -0.02f}});
        strip.push_back({{x, -0.5f, 0.01f}, {next, 0.5f, -0.02f}, {x, 0.5f, -0.02f}});
    }
    for (int i = 0; i < 4000; ++i) {
        const V target{static_cast<float>(random.uniform(0.01, 0.99)) * width * count,
                       static_cast<float>(random.uniform(-0.4, 0.4)), -0.005f};
        const V origin =
            target + V{static_cast<float>(random.uniform(-1e-5, 1e-5)), static_cast<float>(random.uniform(-1, 1)), 1};
        ASSERT_GE(hits(strip, {origin, target - origin}), 1) << i;
    }
}

TEST(TriangleTest, TrianglesWithoutAreaAreNeverHit) {
    Random random(51);
    for (int i = 0; i < 20000; ++i) {
        const V a = random_in_cube<float>(random, 1), b = random_in_cube<float>(random, 1);
        const V origin = random_in_cube<float>(random, 2);
        for (const Triangle<float>& t :
             {Triangle<float>{a, a, a}, Triangle<float>{a, b, b}, Triangle<float>{a, a, b}, Triangle<float>{b, a, b}}) {
            EXPECT_FALSE(meet(t, {origin, a - origin}).hits);
            EXPECT_FALSE(meet(t, {origin, 0.5f * (a + b) - origin}).hits);
            EXPECT_FALSE(meet(t, {a, b - a}).hits);
        }
    }
    // Three vertices on a line, on which the ray lies or which it crosses, where all is exact.
    const Triangle<float> line{{-1, 0, 0}, {0, 0, 0}, {2, 0, 0}};
    EXPECT_FALSE(meet(line, {{-2, 0, 0}, {1, 0, 0}}).hits);
    EXPECT_FALSE(meet(line, {{0.5f, 0, 1}, {0, 0, -1}}).hits);
    EXPECT_FALSE(meet(line, {{0, 1, 1}, {0, -1, -1}}).hits);
}

TEST(TriangleTest, EdgeOnAndBehindIsNotHit) {
    const Triangle<float> t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_FALSE(meet(t, {{-1, 0.25f, 0}, {1, 0, 0}}).hits);  // in its plane
    EXPECT_FALSE(meet(t, {{0.25f, 0.25f, 1}, {0, 0, 1}}).hits);
    EXPECT_FALSE(meet(t, {{0.25f, 0.25f, 0}, {0, 0, 1}}).hits);  // t == 0
    EXPECT_FALSE(meet(t, {{0, 0, 0}, {0.1f, 0.2f, 1}}).hits);
    EXPECT_TRUE(meet(t, {{0.25f, 0.25f, -0x1p-100f}, {0, 0, 1}}).hits);
}

// Two oracles in double: where the ray is clear of the edges by far more than rounding, they agree on hit and distance.
TEST(TriangleTest, AgreesWithDoublePrecisionAwayFromEdges) {
    const Triangles triangles = random_soup(300, 0.5f, 61);
    int compared = 0;
    for (const TestRay& ray : rays_for(triangles, 1000, 62)) {
        for (const Triangle<float>& t : triangles) {
            const Triangle<double> exact_triangle{Vec3<double>(t.a), Vec3<double>(t.b), Vec3<double>(t.c)};
            const TriangleHit<double> exact = intersect(exact_triangle, Vec3<double>(ray.origin),
                                                        ShearedDirection<double>::of(Vec3<double>(ray.direction)));
            const double least = std::min({std::fabs(exact.u), std::fabs(exact.v), std::fabs(exact.w)});
            if (least > 1e-4 && std::fabs(exact.t) > 1e-3) {
                const TriangleHit<float> hit = meet(t, ray);
                ASSERT_EQ(hit.hits, exact.hits);
                if (hit.hits) {
                    EXPECT_NEAR(hit.t, exact.t, 2e-2 * exact.t);
                    ++compared;
                }
            }
        }
    }
    EXPECT_GT(compared, 500);
}

}  // namespace
}  // namespace pt::test
