// Glass and absorbing bodies with closed forms: numerics.md S24, S25, S26, S27, S32.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::mean_radiance;
using test::SceneBuilder;
using test::tolerated_errors;

template <class Real>
class DielectricTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(DielectricTest, Reals);

double reflectance(double n, double cosine) {
    const double sine = std::sqrt(1 - cosine * cosine) / n;
    const double transmitted = std::sqrt(1 - sine * sine);
    const double s = (cosine - n * transmitted) / (cosine + n * transmitted);
    const double p = (n * cosine - transmitted) / (n * cosine + transmitted);
    return (s * s + p * p) / 2;
}

// One ray along +z that passes the origin at distance `offset`, in an environment of radiance 1.
SceneBuilder ray_at(double offset, std::uint32_t depth) {
    SceneBuilder builder;
    builder.camera({offset, 0, -5}, {offset, 0, 1}).depth(depth).environment(1);
    return builder;
}

TYPED_TEST(DielectricTest, ClearGlassInAnEvenEnvironmentIsInvisible) {
    // Every path leaves in the end, with weight exactly 1; 10^5 segments are more than any path here takes.
    for (int shape = 0; shape < 4; ++shape) {
        SceneBuilder builder;
        builder.camera({0, 0, -3}, {0, 0, 0}).image(16, 16, 50, true).depth(100000).environment(1);
        const std::uint32_t glass = builder.dielectric(1.5);
        if (shape == 0) {
            builder.sphere(glass, {0, 0, 0}, 2);
        } else if (shape == 1) {
            builder.ellipsoid(glass, {0, 0, 0}, {2, 1, 1.5}, {10, 20, 30});
        } else {
            builder.box(glass, {0, 0, 0}, {1.5, 1, 2}, shape == 2 ? Vec3d(0.0) : Vec3d(10, 20, 30));
        }
        const Film film = test::render<TypeParam>(builder.scene, {.samples = 16});
        for (std::uint32_t i = 0; i < 256; ++i) {
            ASSERT_EQ(film.pixel(i), Vec3d(1.0)) << "shape " << shape << " pixel " << i;
        }
    }
}

TYPED_TEST(DielectricTest, CutOffPathsLoseExactlyTheirShare) {
    // k hits from within allowed: L = 1 - (1 - R) R^k. A path that leaves at hit k has k + 2 segments.
    EXPECT_NEAR(reflectance(1.5, std::sqrt(1 - 0.99 * 0.99)) * (1 - reflectance(1.5, std::sqrt(1 - 0.99 * 0.99))),
                1 - 0.75166,
                1e-5);  // the page's k = 1
    for (const double b : {0.0, 0.5, 0.9, 0.99}) {
        const double r = reflectance(1.5, std::sqrt(1 - b * b));
        for (const std::uint32_t k : {0u, 1u, 2u, 4u}) {
            SceneBuilder builder = ray_at(b, k + 2);
            builder.sphere(builder.dielectric(1.5), {0, 0, 0}, 2);
            const auto mean = mean_radiance<TypeParam>(builder.scene, {.samples = 40000}).channel[0];
            const double exact = 1 - (1 - r) * std::pow(r, k);
            // Where nothing at all may be lost in so many samples, the error that they show is that of a few of them.
            const double error = std::max(mean.standard_error(), std::sqrt(exact * (1 - exact) / 40000));
            EXPECT_NEAR(mean.value(), exact, tolerated_errors * error + 1e-6) << "b " << b << " k " << k;
        }
    }
}

TYPED_TEST(DielectricTest, AbsorbingGlassSphereSumsItsInternalReflections) {
    // L = R + (1 - R)^2 a / (1 - R a), a = exp(-2 sigma r cos_t)
    for (const auto& [b, page] : {std::pair{0.3, 0.2762662}, std::pair{0.9, 0.3800924}}) {
        SceneBuilder builder = ray_at(b, 1000);
        builder.sphere(builder.dielectric(1.5, Vec3d(0.7)), {0, 0, 0}, 2);
        const double r = reflectance(1.5, std::sqrt(1 - b * b));
        const double a = std::exp(-2 * 0.7 * std::sqrt(1 - b * b / 2.25));
        const double exact = r + (1 - r) * (1 - r) * a / (1 - r * a);
        EXPECT_NEAR(exact, page, 1e-7);
        const auto mean = mean_radiance<TypeParam>(builder.scene, {.samples = 100000}).channel[0];
        EXPECT_NEAR(mean.value(), exact, tolerated_errors * mean.standard_error() + 1e-6) << b;
    }
}

TYPED_TEST(DielectricTest, TintActsOnEachTransmissionAndOnNothingElse) {
    // Reflected outside: 1. Through: two transmissions, whatever lies between. L = R + (1 - R) tint^2.
    const double b = 0.9, r = reflectance(1.5, std::sqrt(1 - b * b));
    const Vec3d tint(0.5, 0.75, 1);
    SceneBuilder builder = ray_at(b, 1000);
    builder.sphere(builder.dielectric(1.5, Vec3d(0.0), tint), {0, 0, 0}, 2);
    const auto mean = mean_radiance<TypeParam>(builder.scene, {.samples = 50000});
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(mean.channel[i].value(), r + (1 - r) * tint[i] * tint[i],
                    tolerated_errors * mean.channel[i].standard_error() + 1e-7);
    }
}

// `plates` wide plates across the z axis in front of a lamp; only what passes them all is seen.
Scene plate_scene(int plates, double ior, double thickness, double gap, double incidence_degrees = 0,
                  double sigma_a = 0) {
    SceneBuilder builder;
    const double angle = incidence_degrees * pi<double> / 180;
    builder.camera({0, 0, -1}, {0, std::sin(angle), -1 + std::cos(angle)}).depth(20000);
    const std::uint32_t glass = builder.dielectric(ior, Vec3d(sigma_a));
    for (int i = 0; i < plates; ++i) {
        builder.box(glass, {0, 0, i * (thickness + gap) + thickness / 2}, {1000, 1000, thickness});
    }
    builder.quad(builder.emitter(Vec3d(1.0)), {0, 0, 10}, 5000, 5000, {90, 0, 0});
    return builder.scene;
}

TYPED_TEST(DielectricTest, StackOfPlatesTransmitsItsSeries) {
    struct Case {
        int plates;
        double ior, thickness, gap, page;
    };
    for (const Case& c :
         {Case{1, 1.5, 0.1, 0.1, .923076923}, Case{4, 1.5, 0.1, 0.1, .75}, Case{16, 1.5, 0.1, 0.1, .428571429},
          Case{8, 2.4, 0.1, 0.1, .234375}, Case{4, 1.5, 0.1, 1e-6, .75}, Case{4, 1.5, 1e-6, 0.1, .75},
          Case{4, 1.5, 1e-5, 1e-5, .75}, Case{1, 1000, 0.1, 0.1, .001999998}}) {
        const double r = (c.ior - 1) * (c.ior - 1) / ((c.ior + 1) * (c.ior + 1));
        const double exact = (1 - r) / (1 + (2 * c.plates - 1) * r);
        EXPECT_NEAR(exact, c.page, 1e-9);
        const std::uint32_t samples = c.plates < 16 ? 30000 : 10000;
        const auto mean =
            mean_radiance<TypeParam>(plate_scene(c.plates, c.ior, c.thickness, c.gap), {.samples = samples}).channel[0];
        EXPECT_NEAR(mean.value(), exact, tolerated_errors * std::sqrt(exact * (1 - exact) / samples))
            << c.plates << " plates of " << c.ior << ", " << c.thickness << " thick, " << c.gap << " apart";
    }
}

TYPED_TEST(DielectricTest, ObliquePlateTransmitsItsSeries) {
    for (const auto& [degrees, page] :
         {std::pair{30.0, .92026553}, std::pair{60.0, .83623246}, std::pair{80.0, .44122918}}) {
        const double r = reflectance(1.5, std::cos(degrees * pi<double> / 180));
        const double exact = (1 - r) / (1 + r);
        EXPECT_NEAR(exact, page, 1e-8);
        const auto mean = mean_radiance<TypeParam>(plate_scene(1, 1.5, 0.1, 0, degrees), {.samples = 40000}).channel[0];
        EXPECT_NEAR(mean.value(), exact, tolerated_errors * mean.standard_error() + 1e-6) << degrees;
    }
}

TYPED_TEST(DielectricTest, AbsorbingPlateTransmitsItsSeries) {
    const double r = 0.04, a = std::exp(-0.3);
    const double exact = (1 - r) * (1 - r) * a / (1 - r * r * a * a);
    EXPECT_NEAR(exact, .68333811, 1e-8);
    const auto mean = mean_radiance<TypeParam>(plate_scene(1, 1.5, 0.5, 0, 0, 0.6), {.samples = 100000}).channel[0];
    EXPECT_NEAR(mean.value(), exact, tolerated_errors * mean.standard_error() + 1e-6);
}

TYPED_TEST(DielectricTest, TransmittedRaysBendTowardsTheNormal) {
    // A plate shifts an oblique ray by d (tan i - tan t) to the side of its entry, and leaves its direction alone.
    const double thickness = 1, angle = 60 * pi<double> / 180, inner = std::asin(std::sin(angle) / 1.5);
    const double exit_y = std::tan(angle) + thickness * std::tan(inner) + (3 - thickness) * std::tan(angle);
    for (const double edge : {exit_y - 1e-3, exit_y + 1e-3}) {
        SceneBuilder builder;
        builder.camera({0, 0, -1}, {0, std::sin(angle), -1 + std::cos(angle)}).depth(3);
        builder.box(builder.dielectric(1.5), {0, 0, 0.5}, {100, 100, thickness});
        builder.quad(builder.emitter(Vec3d(1.0)), {0, edge + 2, 3}, 4, 4, {90, 0, 0});  // shines from y = edge upwards
        const double r = reflectance(1.5, std::cos(angle));
        const auto mean = mean_radiance<TypeParam>(builder.scene, {.samples = 4000}).channel[0];
        const double exact = edge < exit_y ? (1 - r) * (1 - r) : 0;
        EXPECT_NEAR(mean.value(), exact, tolerated_errors * mean.standard_error()) << edge - exit_y;
    }
}

TYPED_TEST(DielectricTest, MatchedAbsorberFollowsBeerAndLambertAlongEachRay) {
    for (const double sigma : {0.0005, 0.05, 0.5, 2.5, 10.0}) {
        for (const double b : {0.0, 0.25, 0.5, 0.75, 0.96875}) {
            SceneBuilder sphere = ray_at(b, 3), ellipsoid = ray_at(b, 3), box = ray_at(b, 3), turned = ray_at(0, 3);
            sphere.sphere(sphere.dielectric(1, Vec3d(sigma)), {0, 0, 0}, 2);
            ellipsoid.ellipsoid(ellipsoid.dielectric(1, Vec3d(sigma)), {0, 0, 0}, {2, 2, 1});
            box.box(box.dielectric(1, Vec3d(sigma)), {0, 0, 0}, {2, 2, 1.5});
            turned.box(turned.dielectric(1, Vec3d(sigma)), {0, 0, 0}, Vec3d(1.0), {0, 45, 0});
            const double chord = 2 * std::sqrt(1 - b * b);
            // The chord is right to a few roundings of the radius at distance 5, magnified by 1 / cos towards the limb.
            const double tolerance =
                32 * std::numeric_limits<TypeParam>::epsilon() * (1 + 5 * sigma / std::sqrt(1 - b * b));
            const auto expect = [&](const SceneBuilder& builder, double length) {
                const double value = mean_radiance<TypeParam>(builder.scene, {}).channel[0].value();
                EXPECT_NEAR(value / std::exp(-sigma * length), 1, tolerance) << "sigma " << sigma << " b " << b;
            };
            expect(sphere, chord);
            expect(ellipsoid, chord / 2);
            expect(box, 1.5);
            expect(turned, std::sqrt(2.0));
        }
    }
}

TYPED_TEST(DielectricTest, CameraInsideAnAbsorberStartsInIt) {
    SceneBuilder builder;
    builder.camera({0, 0, 0.5}, {0, 0, 1}).depth(2).environment(1);
    builder.sphere(builder.dielectric(1, {0.5, 1, 0}), {0, 0, 0}, 2);
    const auto mean = mean_radiance<TypeParam>(builder.scene, {});
    EXPECT_NEAR(mean.channel[0].value(), std::exp(-0.25), 1e-6);
    EXPECT_NEAR(mean.channel[1].value(), std::exp(-0.5), 1e-6);
    EXPECT_EQ(mean.channel[2].value(), 1);
}

// numerics.md S32: the mean over the disc, 2 (1 - (1 + t) e^-t) / t^2 with t = 2 sigma R, for parallel rays: the camera
// stands 10^5 radii away, in double.
TEST(DielectricTest, MatchedAbsorbingSphereHasItsDiscMean) {
    for (const auto& [t, page] : {std::pair{0.1, .93576803}, std::pair{1.0, .52848224}, std::pair{5.0, .07676579}}) {
        const double exact = 2 * (1 - (1 + t) * std::exp(-t)) / (t * t);
        EXPECT_NEAR(exact, page, 1e-8);
        SceneBuilder builder;
        const double distance = 1e5, half = 1.05;
        builder.camera({0, 0, -distance}, {0, 0, 0})
            .image(64, 64, 2 * std::atan(half / distance) * 180 / pi<double>, true);
        builder.depth(3).environment(1);
        builder.sphere(builder.dielectric(1, Vec3d(t / 2)), {0, 0, 0}, 2);
        const auto mean = mean_radiance<double>(builder.scene, {.samples = 32}).channel[0];
        // Outside the disc the environment is seen: mean = 1 - share (1 - disc mean).
        const double share = pi<double> / (4 * half * half);
        EXPECT_NEAR(mean.value(), 1 - share * (1 - exact), tolerated_errors * mean.standard_error()) << t;
    }
}

TYPED_TEST(DielectricTest, IndexOneIsInvisibleInFrontOfAPicture) {
    const auto scene = [](bool with_ball) {
        SceneBuilder builder;
        builder.camera({0, 0, -4}, {0, 0, 0}).image(64, 64, 40, false).depth(6);
        builder.quad(builder.emitter({1, 0.5, 0.25}), {0.3, 0.2, 2}, 1.5, 1, {90, 0, 20});
        builder.sphere(builder.emitter({0.25, 0.5, 1}), {-0.8, -0.3, 2}, 0.7);
        if (with_ball) {
            builder.sphere(builder.dielectric(1), {0, 0, 0}, 2);
        }
        return builder.scene;
    };
    const Film without = test::render<TypeParam>(scene(false), {}), with = test::render<TypeParam>(scene(true), {});
    int different = 0;
    for (std::uint32_t i = 0; i < 64 * 64; ++i) {
        different += without.pixel(i) == with.pixel(i) ? 0 : 1;
    }
    // Rays go on from rounded points: a pixel whose centre lies on an outline to 1e-6 may change sides.
    EXPECT_LE(different, 1);
}

}  // namespace
}  // namespace pt
