// How a point of a triangle is kept off its edges must not depend on the unit of length.
#include <cmath>

#include <gtest/gtest.h>

#include "kernels/shapes/mesh.h"

namespace pt {
namespace {

template <class Real>
Triangle<Real> scaled(const Triangle<Real>& t, int k) {
    const Real factor = std::ldexp(Real(1), k);
    return {t.a * factor, t.b * factor, t.c * factor};
}

template <class Real>
void expect_same_weights(int lowest, int highest) {
    const Triangle<Real> triangle{{Real(0.7), Real(-0.3), Real(0.2)}, {1, Real(0.1), Real(0.3)}, {Real(0.8), 1, 0}};
    const Vec3<Real> corner(0, Real(1e-20), 1);
    const KeptWeights<Real> expected = off_the_edges(corner, triangle);
    EXPECT_GT(expected.weights.x, corner.x);
    EXPECT_GT(expected.reach, 0);
    for (int k = lowest; k <= highest; ++k) {
        const KeptWeights<Real> kept = off_the_edges(corner, scaled(triangle, k));
        EXPECT_TRUE(kept.weights.x == expected.weights.x && kept.weights.y == expected.weights.y &&
                    kept.weights.z == expected.weights.z)
            << "2^" << k;
        EXPECT_EQ(kept.reach, std::ldexp(expected.reach, k)) << "2^" << k;
    }
}

TEST(OffTheEdgesTest, APowerOfTwoChangesNoBit) {
    expect_same_weights<float>(-60, 60);
    expect_same_weights<double>(-60, 60);
}

// A point of a triangle lies before its plane, on the side that the ray comes from, exactly told.
TEST(OffTheEdgesTest, AStartLiesOnTheRaysSideOfThePlane) {
    const Triangle<float> triangle{{0.7f, -0.3f, 5.1f}, {1, 0.1f, 5.3f}, {0.8f, 1, 5}};
    MeshInstance<float> mesh{};
    mesh.geometry.triangles = &triangle;
    mesh.is_placed = 1;
    const Vec3<long double> a(triangle.a), ab = Vec3<long double>(triangle.b) - a,
                                           ac = Vec3<long double>(triangle.c) - a, normal = cross(ab, ac);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
        const float u = static_cast<float>(i % 32) / 32, v = (1 - u) * static_cast<float>(i / 32) / 32;
        const Vec3<float> target = triangle.a + (triangle.b - triangle.a) * u + (triangle.c - triangle.a) * v;
        for (const Vec3<float>& origin : {Vec3<float>(0, 0, 0), Vec3<float>(1, 0.5f, 20)}) {
            const Vec3<float> direction = target - origin;
            if (!intersect(triangle, origin, ShearedDirection<float>::of(direction)).hits) {
                continue;  // beside an edge by a rounding
            }
            ++hits;
            const auto point = surface_point(MeshTriangle<float>{mesh, 0}, origin, direction, 0.0f);
            const bool starts_before = dot(normal, Vec3<long double>(point.position) - a) > 0;
            EXPECT_EQ(starts_before, dot(normal, Vec3<long double>(origin) - a) > 0) << i;
        }
    }
    EXPECT_GT(hits, 1900);
}

}  // namespace
}  // namespace pt
