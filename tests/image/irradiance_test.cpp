// Irradiance of a diffuse surface by one light, seen as radiance rho E / pi: numerics.md S6, S8, S10. By chance (the
// BSDF finds the light, depth 2) and by connection (final bounce, depth 1).
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

constexpr double albedo = 0.75;

// E / Le of a rectangle a x b, one corner straight above the point at height h, parallel to the receiver.
double rectangle(double a, double b, double h) {
    const double x = a / h, y = b / h;
    return 0.5 * (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                  y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y)));
}

// E / Le of a sphere of radius R at distance d from the point, its centre w off the normal.
double sphere(double radius, double distance, double w) {
    const double cosine = std::cos(w), h = distance / radius;
    if (cosine > 1 / h) {
        return pi<double> * cosine / (h * h);  // wholly above the horizon
    }
    const double k2 = 1 - h * h * cosine * cosine;
    return (cosine * std::acos(-cosine * std::sqrt((h * h - 1) / (1 - cosine * cosine))) -
            std::sqrt(k2 * (h * h - 1))) /
               (h * h) +
           std::atan(std::sqrt(k2 / (h * h - 1)));
}

// The camera sees the receiver's centre, the origin, from the side (-x, -z); the lights stay clear of that line. `size`
// of the receiver: small where a light reaches below its horizon.
Scene lit(double size, const std::function<void(SceneBuilder&)>& add_lights) {
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0});
    builder.quad(builder.diffuse(Vec3d(albedo)), {0, 0, 0}, size, size);
    add_lights(builder);
    return builder.scene;
}

template <class Real>
class IrradianceTest : public testing::Test {
protected:
    // Expects the radiance that a floor reflects. `irradiance`: E / Le, of a lamp of radiance Le.
    static void expect(const Scene& scene, double irradiance, const std::string& what) {
        const double exact = albedo * irradiance / pi<double>;
        const auto by_chance = test::mean_radiance<Real>(scene, {.samples = 60000, .depth = 2});
        const auto connected = test::mean_radiance<Real>(scene, {.samples = 20000, .depth = 1, .final_bounce = true});
        for (int i = 0; i < 3; ++i) {
            const test::Mean& a = by_chance.channel[i];
            const test::Mean& b = connected.channel[i];
            EXPECT_NEAR(a.value(), exact, test::tolerated_errors * a.standard_error()) << what;
            // A connection can be exact to rounding (a patch seen under one angle): 1e-6 of the value.
            EXPECT_NEAR(b.value(), exact, test::tolerated_errors * b.standard_error() + 2e-6 * exact) << what;
            // A test that cannot see an error of 5 % is none.
            EXPECT_LT(a.standard_error(), 0.05 * exact) << what;
            EXPECT_LT(b.standard_error(), 0.03 * exact) << what;
        }
    }
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(IrradianceTest, Reals);

TEST(IrradianceFormulaTest, FormulasGiveThePagesNumbers) {
    EXPECT_NEAR(rectangle(1, 1, 1), .4352098756835515, 1e-14);
    EXPECT_NEAR(rectangle(2, 1, .5), .693593356403909, 1e-14);
    EXPECT_NEAR(4 * rectangle(1, 1, 1), 1.740839502734206, 1e-14);
    EXPECT_NEAR(sphere(1, 2, 0), .785398163, 1e-9);
    EXPECT_NEAR(sphere(1, 2, pi<double> / 2 - .2), .185688407, 1e-9);
    EXPECT_NEAR(sphere(1, 2, pi<double> / 2), .0905860737, 1e-9);
    EXPECT_NEAR(sphere(1, 2, pi<double> / 2 + .3), .0122832533, 1e-9);
}

TYPED_TEST(IrradianceTest, RectangleAboveTheCorner) {
    struct Case {
        double a, b, h;
    };
    for (const Case& c : {Case{1, 1, 1}, Case{2, 1, 0.5}, Case{0.5, 0.5, 1}}) {
        this->expect(lit(10,
                         [&](auto& b) {
                             b.quad(b.emitter(Vec3d(1.0)), {c.a / 2, c.h, c.b / 2}, c.a, c.b);
                         }),
                     rectangle(c.a, c.b, c.h), "from above");
        // Two-sided: its back shines as well.
        this->expect(lit(10,
                         [&](auto& b) {
                             b.quad(b.emitter(Vec3d(1.0)), {c.a / 2, c.h, c.b / 2}, c.a, c.b, {180, 0, 0});
                         }),
                     rectangle(c.a, c.b, c.h), "the other side");
    }
}

TYPED_TEST(IrradianceTest, RectangleAboveTheCentre) {
    this->expect(lit(10, [](auto& b) { b.quad(b.emitter(Vec3d(1.0)), {0, 1, 0}, 2, 2); }), 1.740839502734206, "quad");
    // A box straight above shows only its face below.
    this->expect(lit(10,
                     [](auto& b) {
                         b.box(b.emitter(Vec3d(1.0)), {0, 1.25, 0}, {2, 0.5, 2});
                     }),
                 1.740839502734206, "box");
    // Turned about y, and by a hair to take the oriented formula.
    this->expect(lit(10,
                     [](auto& b) {
                         b.box(b.emitter(Vec3d(1.0)), {0, 1.25, 0}, {2, 0.5, 2}, {0, 30, 0});
                     }),
                 1.740839502734206, "oriented box");
}

TYPED_TEST(IrradianceTest, ReceiverIsTwoSided) {
    // Light and camera below a quad that faces up.
    SceneBuilder builder;
    builder.camera({-3, -0.5, -3}, {0, 0, 0});
    builder.quad(builder.diffuse(Vec3d(albedo)), {0, 0, 0}, 10, 10);
    builder.quad(builder.emitter(Vec3d(1.0)), {0.5, -1, 0.5}, 1, 1);
    this->expect(builder.scene, rectangle(1, 1, 1), "below");
}

TYPED_TEST(IrradianceTest, LightBehindTheReceiverDoesNotShineThrough) {
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0});
    builder.quad(builder.diffuse(Vec3d(albedo)), {0, 0, 0}, 10, 10);
    builder.quad(builder.emitter(Vec3d(1.0)), {0.5, -1, 0.5}, 1, 1);
    EXPECT_EQ(test::mean_radiance<TypeParam>(builder.scene, {.samples = 1000, .depth = 2}).channel[0].value(), 0);
    EXPECT_EQ(test::mean_radiance<TypeParam>(builder.scene, {.samples = 1000, .depth = 1, .final_bounce = true})
                  .channel[0]
                  .value(),
              0);
}

TYPED_TEST(IrradianceTest, SphereAtEveryAngle) {
    const double quarter = pi<double> / 2;
    for (const double w : {0.0, 0.7, quarter - 0.2, quarter, quarter + 0.3}) {
        const Scene scene = lit(0.05, [&](auto& b) {
            b.sphere(b.emitter(Vec3d(1.0)),
                     {2 * std::sin(w) * std::sqrt(0.5), 2 * std::cos(w), 2 * std::sin(w) * std::sqrt(0.5)}, 2);
        });
        if (w < quarter) {
            this->expect(scene, sphere(1, 2, w), "sphere");
        } else {
            // Mostly below the horizon: rarely found by chance, and the connections vary. Seen to a few per cent.
            const double exact = albedo * sphere(1, 2, w) / pi<double>;
            const auto a = test::mean_radiance<TypeParam>(scene, {.samples = 200000, .depth = 2}).channel[0];
            const auto b =
                test::mean_radiance<TypeParam>(scene, {.samples = 60000, .depth = 1, .final_bounce = true}).channel[0];
            EXPECT_NEAR(a.value(), exact, test::tolerated_errors * a.standard_error()) << w;
            EXPECT_NEAR(b.value(), exact, test::tolerated_errors * b.standard_error()) << w;
            EXPECT_LT(b.standard_error(), 0.03 * exact);
        }
    }
}

TYPED_TEST(IrradianceTest, LightsAddUp) {
    const Scene scene = lit(10, [](auto& b) {
        b.quad(b.emitter(Vec3d(1.0)), {0.5, 1, 0.5}, 1, 1);
        b.quad(b.emitter(Vec3d(0.5)), {-0.5, 1, 0.5}, 1, 1);
        b.sphere(b.emitter(Vec3d(2.0)), {1, 1.8, -1.4}, 0.5);
    });
    const double distance = std::sqrt(1 + 1.8 * 1.8 + 1.4 * 1.4);
    this->expect(scene, 1.5 * rectangle(1, 1, 1) + 2 * sphere(0.25, distance, std::acos(1.8 / distance)),
                 "three lights");
}

TYPED_TEST(IrradianceTest, EvenEnvironmentLightsFully) {
    // E = pi: L = rho, with no variance at all.
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0}).environment(1);
    builder.quad(builder.diffuse(Vec3d(albedo)), {0, 0, 0}, 10, 10);
    const auto off = test::mean_radiance<TypeParam>(builder.scene, {.samples = 100, .depth = 2}).channel[0];
    const auto on =
        test::mean_radiance<TypeParam>(builder.scene, {.samples = 100, .depth = 1, .final_bounce = true}).channel[0];
    EXPECT_EQ(off.value(), albedo);
    EXPECT_EQ(off.variance(), 0);
    EXPECT_EQ(on.value(), albedo);
    EXPECT_EQ(on.variance(), 0);
}

TYPED_TEST(IrradianceTest, GlowingReceiverAddsItsOwnLight) {
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0}).environment(1);
    builder.quad(builder.diffuse(Vec3d(albedo), Vec3d(0.125)), {0, 0, 0}, 10, 10);
    EXPECT_EQ(test::mean_radiance<TypeParam>(builder.scene, {.samples = 10, .depth = 2}).channel[0].value(),
              albedo + 0.125);
}

}  // namespace
}  // namespace pt
