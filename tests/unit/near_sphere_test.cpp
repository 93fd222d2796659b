// Spheres that the eye is near (NearSphere in kernels/shapes/sphere.h), as a ground of ten million units below it,
// against long double from the scene's own numbers.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "harness/scene/scene_buffers.h"
#include "kernels/intersect.h"
#include "tests/support/random_vectors.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::Random;
using test::random_in_cube;
using test::SceneBuilder;
using Wide = Vec3<long double>;

template <class Real>
class NearSphereTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(NearSphereTest, Reals);

template <class Real>
constexpr long double round_off = std::numeric_limits<Real>::epsilon() / 2;

// No number of it has few digits.
constexpr double height = 1.3;

Scene ground(double radius) {
    SceneBuilder builder;
    builder.camera({0, height, 0}, {0, height, 1});
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, -radius, 0}, 2 * radius);
    return builder.scene;
}

// |o - c|^2 - R^2 of a point relative to the eye, without the cancellation: the ground's pole is at y = -height.
long double exact_power(const Wide& point, long double radius) {
    const long double above = point.y + static_cast<long double>(height);
    return point.x * point.x + point.z * point.z + above * (above + 2 * radius);
}

// From the eye, and from points around it that have a height of their own of a quarter unit or more. An error of the
// height is one of the distance; that of a point's power in square radii is a few roundings of |o| / R.
TYPED_TEST(NearSphereTest, DistancesKeepTheirDigits) {
    using Real = TypeParam;
    using Kernel = Config<Real, Feature::sphere | Feature::near_sphere>;
    Random random(13);
    for (const double radius : {10.0, 1e3, 1e5, 1e7}) {
        const Scene scene = ground(radius);
        ASSERT_TRUE(contains(features_of(scene), Feature::near_sphere));
        const SceneBuffers<Real> buffers(scene, default_settings(scene));
        int met = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3<Real> origin = i % 2 == 0 ? Vec3<Real>(Real(0)) : random_in_cube<Real>(random, 1);
            Vec3<Real> direction = normalize(random_in_cube<Real>(random, 1));
            direction.y = -std::abs(direction.y);
            const Wide o(origin), d(direction);
            const long double a = dot(d, d), power = exact_power(o, radius);
            const long double b = -(dot(o, d) + (static_cast<long double>(height) + radius) * d.y);
            const long double root = sqrtl(b * b - a * power);
            const long double above = static_cast<long double>(height) + o.y;
            const long double cosine = root / static_cast<long double>(radius);
            if (!(above > 0.25L && cosine > 0.05L)) {
                continue;
            }
            const long double exact = power / (b + root);
            const Hit<Real> hit = closest_hit<Kernel>(buffers.view(), {origin, direction, Real(0), {}});
            ASSERT_TRUE(hit.side.exists());
            ASSERT_FALSE(hit.side.inside());
            const long double allowed = round_off<Real> * (16 * sqrtl(dot(o, o)) / above + 8 / cosine);
            ASSERT_LE(std::abs(static_cast<long double>(hit.t) / exact - 1), allowed) << radius << " " << i;
            ++met;
            const SurfacePoint<Real> point = surface_at<Kernel>(buffers.view(), {origin, direction, Real(0), {}}, hit);
            const Wide p(point.position);
            const long double off = exact_power(p, radius) / (2 * static_cast<long double>(radius));
            ASSERT_LE(std::abs(off), 8 * round_off<Real> * (1 + sqrtl(dot(p, p)))) << radius << " " << i;
        }
        EXPECT_GT(met, 5000);
    }
}

// With an eye inside, near the wall: the way to the wall ahead, and to the one behind.
TYPED_TEST(NearSphereTest, FromWithinToo) {
    using Real = TypeParam;
    using Kernel = Config<Real, Feature::sphere | Feature::near_sphere>;
    Random random(14);
    SceneBuilder builder;
    const double radius = 1e6;
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, radius - height, 0}, 2 * radius);
    ASSERT_TRUE(contains(features_of(builder.scene), Feature::near_sphere));
    const SceneBuffers<Real> buffers(builder.scene, default_settings(builder.scene));
    const Wide centre(Vec3<double>(0, radius - height, 0));
    const long double inside = static_cast<long double>(radius) - centre.y;  // the height, as the scene has it
    for (int i = 0; i < 20000; ++i) {
        const Vec3<Real> direction = normalize(random_in_cube<Real>(random, 1));
        const Wide d(direction);
        const long double a = dot(d, d), b = dot(centre, d);
        const long double power = -inside * (2 * static_cast<long double>(radius) - inside);
        const long double root = sqrtl(b * b - a * power);
        const long double cosine = root / static_cast<long double>(radius);
        const long double exact = b > 0 ? (b + root) / a : -power / (root - b);
        const Hit<Real> hit = closest_hit<Kernel>(buffers.view(), {Vec3<Real>(Real(0)), direction, Real(0), {}});
        ASSERT_TRUE(hit.side.exists());
        ASSERT_TRUE(hit.side.inside());
        ASSERT_LE(std::abs(static_cast<long double>(hit.t) / exact - 1), 8 * round_off<Real> / cosine) << i;
    }
}

// Within half a square radius, and the same whatever the scene's unit; no other kind of object.
TEST(NearEye, IsDecidedByThePower) {
    const auto is_near = [](double radius, double distance) {
        return is_near_eye(ground(radius).objects[0], {0, distance - radius, 0});
    };
    EXPECT_TRUE(is_near(1, 1));
    EXPECT_TRUE(is_near(1, 1.22));  // sqrt(1.5) = 1.2247
    EXPECT_FALSE(is_near(1, 1.23));
    EXPECT_TRUE(is_near(1, 0.71));  // sqrt(0.5) = 0.7071
    EXPECT_FALSE(is_near(1, 0.70));
    EXPECT_FALSE(is_near(1, 0));
    for (const double unit : {0x1p-500, 0x1p-20, 0x1p20, 0x1p500}) {
        EXPECT_TRUE(is_near(unit, 1.22 * unit));
        EXPECT_FALSE(is_near(unit, 1.23 * unit));
        const SceneObject one = ground(1e5).objects[0], other = ground(1e5 * unit).objects[0];
        EXPECT_EQ(eye_power(one, {0.25, height, 0.5}), eye_power(other, Vec3d(0.25, height, 0.5) * unit));
    }
    SceneObject ellipsoid = ground(1).objects[0];
    ellipsoid.scale.x = 1.5;
    EXPECT_FALSE(is_near_eye(ellipsoid, {0, 0.1, 0}));
}

// To a rounding of a double, though |f|^2 and R^2 share all of theirs but four bits.
TEST(NearEye, PowerIsExactToARounding) {
    for (const double radius : {1e5, 1e7, 1e12, 1e15}) {
        const auto h = static_cast<long double>(height), r = static_cast<long double>(radius);
        const double exact = static_cast<double>(h * (2 * r + h) / (r * r));
        EXPECT_NEAR(eye_power(ground(radius).objects[0], {0, height, 0}) / exact, 1, 0x1p-52) << radius;
    }
    // (2, 3, 6) / 7 is a unit vector: exactly on the sphere.
    SceneObject sphere;
    sphere.translate = {2, 3, 6};
    sphere.scale = Vec3d(14.0);
    EXPECT_EQ(eye_power(sphere, {0, 0, 0}), 0);
    EXPECT_EQ(eye_power(sphere, {4, 6, 12}), 0);
}

// Kernels without the feature are what the scenes get that do not need it, so those with it must agree bit for bit.
TEST(NearSphere, OthersKeepTheirBits) {
    SceneBuilder builder;
    const std::uint32_t grey = builder.diffuse(Vec3d(0.5));
    Random random(15);
    for (int i = 0; i < 6; ++i) {
        builder.sphere(grey, {random.uniform(-2, 2), random.uniform(-2, 2), 4}, random.uniform(0.5, 3));
    }
    ASSERT_FALSE(contains(features_of(builder.scene), Feature::near_sphere));
    const SceneBuffers<float> buffers(builder.scene, default_settings(builder.scene));
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        const Ray<float> ray{random_in_cube<float>(random, 6), normalize(random_in_cube<float>(random, 1)), 0, {}};
        const Hit<float> without = closest_hit<Config<float, no_features | Feature::sphere>>(buffers.view(), ray);
        const Hit<float> with = closest_hit<Config<float, Feature::sphere | Feature::near_sphere>>(buffers.view(), ray);
        ASSERT_EQ(bits_of(with.t), bits_of(without.t));
        ASSERT_EQ(with.side.code, without.side.code);
        met += with.side.exists() ? 1 : 0;
    }
    EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace pt
