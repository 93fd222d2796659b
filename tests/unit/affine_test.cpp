// Affine maps: what they do, and that taking one apart gives its numbers back to the last bit.
#include "harness/interchange/affine.h"

#include <random>

#include <gtest/gtest.h>

namespace pt {
namespace {

Affine map_of(const Vec3d& translate, const Vec3d& degrees, const Vec3d& scale) {
    const Rotation rotation = rotation_of(degrees);
    Affine map;
    for (int i = 0; i < 3; ++i) {
        map.column[i] = rotation.column[i] * scale[i];
    }
    map.origin = translate;
    return map;
}

TEST(AffineTest, ProductsGoFromRightToLeft) {
    const Affine map = translation({1, 2, 3}) * rotation_about({0, 0, 2}, 90) * scaling({2, 1, 1});
    EXPECT_EQ(map.point({1, 0, 0}), Vec3d(1, 4, 3));
    EXPECT_EQ(map.point({0, 1, 0}), Vec3d(0, 2, 3));
    EXPECT_EQ(map.direction({0, 0, 1}), Vec3d(0, 0, 1));
    EXPECT_EQ(determinant(map), 2);
}

TEST(AffineTest, ARotationAboutAnyAxisTurnsCounterClockwise) {
    const Affine map = rotation_about({1, 1, 1}, 120);  // x to y to z
    for (int i = 0; i < 3; ++i) {
        Vec3d axis(0.0), next(0.0);
        axis[i] = next[(i + 1) % 3] = 1;
        const Vec3d off = map.direction(axis) - next;
        EXPECT_LT(dot(off, off), 1e-30);
    }
    EXPECT_EQ(rotation_about({-3, 0, 0}, 90).direction({0, 1, 0}), Vec3d(0, 0, -1));
}

TEST(AffineTest, DecimalsComeBackExactly) {
    std::mt19937 random(1);
    const auto decimal = [&](int digits, double parts_of_one) {
        const int most = static_cast<int>(std::pow(10.0, digits));
        return std::uniform_int_distribution<int>(1, most - 1)(random) / parts_of_one;
    };
    for (int i = 0; i < 2000; ++i) {
        const int turned = i % 8;
        // Beyond 90 degrees about y, the same rotation has other angles.
        const Vec3d degrees{turned & 1 ? decimal(4, 100) : 0, turned & 2 ? decimal(3, 20) : 0,
                            turned & 4 ? decimal(3, 10) : 0};
        const Vec3d scale{decimal(3, 100), decimal(4, 1000), decimal(2, 1)};
        const Affine map = map_of({decimal(3, 10), -decimal(4, 100), 0}, degrees, scale);
        const TranslateRotateScale parts = take_apart(map);
        const Affine again = map_of(parts.translate, parts.rotate_degrees, parts.scale);
        EXPECT_TRUE(parts.is_exact) << degrees.x << " " << degrees.y << " " << degrees.z;
        EXPECT_EQ(again.origin, map.origin);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(again.column[axis], map.column[axis]) << degrees.x << " " << degrees.y << " " << degrees.z;
        }
    }
}

TEST(AffineTest, QuarterTurnsAndTheirNeighboursAreExact) {
    for (const Vec3d& degrees : {Vec3d(90, 0, 0), Vec3d(0, 90, 0), Vec3d(0, 0, -90), Vec3d(180, 0, 90),
                                 Vec3d(0, 180, 0), Vec3d(90, 90, 90), Vec3d(30, 90, 0)}) {
        const Affine map = map_of({0, 0, 0}, degrees, {1, 2, 3});
        const TranslateRotateScale parts = take_apart(map);
        const Affine again = map_of(parts.translate, parts.rotate_degrees, parts.scale);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(again.column[axis], map.column[axis]) << degrees.x << " " << degrees.y << " " << degrees.z;
        }
    }
    // The map is a quarter turn about y as single precision writes it.
    Affine rounded = map_of({0, 0, 0}, {0, 90, 0}, {1, 1, 1});
    rounded.column[0].x = rounded.column[2].z = -4.37114e-8;
    const TranslateRotateScale parts = take_apart(rounded);
    EXPECT_TRUE(parts.is_straightened);
    EXPECT_EQ(parts.rotate_degrees, Vec3d(0, 90, 0));
}

TEST(AffineTest, AMirrorLosesItsLastColumnsSign) {
    const Affine map = scaling({1, 2, -3});
    EXPECT_EQ(determinant(map), -6);
    EXPECT_EQ(take_apart(map).scale, Vec3d(1, 2, 3));
    EXPECT_EQ(take_apart(map).rotate_degrees, Vec3d(0, 0, 0));
}

TEST(AffineTest, ShearIsTheGreatestCosine) {
    EXPECT_EQ(shear_of(scaling({1, 2, 3})), 0);
    Affine map;
    map.column[1] = {1, 1, 0};
    EXPECT_NEAR(shear_of(map), std::sqrt(0.5), 1e-15);
}

TEST(AffineTest, TheShortestDecimalWithin) {
    EXPECT_EQ(shortest_within(0.1 + 0.2, 1e-15), 0.3);
    EXPECT_EQ(shortest_within(0.1 + 0.2, 0), 0.1 + 0.2);
    EXPECT_EQ(shortest_within(-1234.5, 1), -1234);
}

}  // namespace
}  // namespace pt
