// Lens, shutter and pixel against closed forms: numerics.md S46 to S48; and the image's orientation.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::mean_radiance;
using test::SceneBuilder;

template <class Real>
class CameraTest : public testing::Test {
protected:
    // A Bernoulli mean: the light is seen or not.
    static void expect_coverage(const Scene& scene, double exact, std::uint32_t samples, double where) {
        const test::Mean mean = mean_radiance<Real>(scene, {.samples = samples}).channel[0];
        EXPECT_NEAR(mean.value(), exact, test::tolerated_errors * std::sqrt(exact * (1 - exact) / samples) + 1e-9)
            << where;
    }
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(CameraTest, Reals);

// A wall of light at depth z that covers x <= edge.
void half_wall(SceneBuilder& builder, double edge, double z) {
    builder.quad(builder.emitter(Vec3d(1.0)), {edge - 2, 0, z}, 4, 4, {90, 0, 0});
}

TYPED_TEST(CameraTest, EdgeOutOfFocusIsBlurredByTheDisc) {
    for (const auto& [s, page] :
         {std::pair{-.075, .195501}, std::pair{-.025, .394390}, std::pair{.025, .605610}, std::pair{.075, .804499}}) {
        const double x = s / 0.15;
        const double exact = 1 - (std::acos(x) - x * std::sqrt(1 - x * x)) / pi<double>;
        EXPECT_NEAR(exact, page, 1e-6);
        SceneBuilder builder;
        builder.scene.camera.aperture_radius = 0.1;
        builder.scene.camera.focus_distance = 2;
        half_wall(builder, s, 5);
        this->expect_coverage(builder.scene, exact, 100000, s);
    }
}

TYPED_TEST(CameraTest, EdgeInFocusIsSharp) {
    for (const double s : {-1e-4, 1e-4}) {
        SceneBuilder builder;
        builder.scene.camera.aperture_radius = 0.25;
        builder.scene.camera.focus_distance = 4;
        half_wall(builder, s, 4);
        this->expect_coverage(builder.scene, s > 0 ? 1 : 0, 2000, s);
    }
}

TYPED_TEST(CameraTest, FocusIsAPlaneNotASphere) {
    // A pixel far off the axis: in focus at the same distance along the axis.
    SceneBuilder builder;
    builder.image(5, 1, 20, false);
    builder.scene.camera.aperture_radius = 0.25;
    builder.scene.camera.focus_distance = 4;
    builder.depth(1);
    // The leftmost pixel's centre: two pixels off, to the camera's left, which is +x.
    const double x = 4 * 2 * 2 * std::tan(10 * pi<double> / 180);
    for (const double offset : {-1e-4, 1e-4}) {
        SceneBuilder scene = builder;
        half_wall(scene, x + offset, 4);
        const Film film = test::render<TypeParam>(scene.scene, {.samples = 500});
        EXPECT_EQ(film.pixel(0), Vec3d(offset > 0 ? 1.0 : 0.0)) << offset;
    }
}

TYPED_TEST(CameraTest, ShutterCoverageFollowsItsDensity) {
    struct Case {
        double v, x;
    };
    for (const bool late : {true, false}) {
        for (const Case& c : {Case{4, .5}, Case{4, 2}, Case{4, 3.5}, Case{4, 4.5}, Case{100, 24}, Case{100, 74}}) {
            // A box [0, 1] that moves at v covers x while v t <= x <= v t + 1.
            const double from = std::max(0.0, (c.x - 1) / c.v), to = std::min(1.0, c.x / c.v);
            const double exact = late ? to * to - from * from : to - from;
            SceneBuilder builder;
            builder.camera({c.x, 0, 0}, {c.x, 0, 1});
            builder.scene.camera.shutter_close = 1;
            builder.scene.camera.shutter_late = late;
            builder.box(builder.emitter(Vec3d(1.0)), {0.5, 0, 5}, Vec3d(1.0)).velocity = {c.v, 0, 0};
            this->expect_coverage(builder.scene, exact, 200000, c.x);
        }
    }
    // The page's number: v = 100, x = 24: 4.7e-3.
    EXPECT_NEAR(.24 * .24 - .23 * .23, 4.7e-3, 1e-9);
}

TYPED_TEST(CameraTest, EveryKindOfObjectMoves) {
    // The body covers the ray for t in [1/4, 1/2] of a uniform shutter from 1 to 2: the object's place at t = 1 is its
    // own place and one velocity on.
    for (int kind = 0; kind < 5; ++kind) {
        SceneBuilder builder;
        builder.scene.camera.shutter_open = 1;
        builder.scene.camera.shutter_close = 2;
        const std::uint32_t light = builder.emitter(Vec3d(1.0));
        const double width = 2;           // crosses x = 0 in 1/4 second at 8 a second
        const Vec3d start(-3 - 8, 0, 5);  // leading edge at -2 when the shutter opens
        SceneObject& object = kind == 0   ? builder.sphere(light, start, width)
                              : kind == 1 ? builder.ellipsoid(light, start, {width, 1, 3})
                              : kind == 2 ? builder.box(light, start, {width, 1, 1})
                              : kind == 3 ? builder.box(light, start, {1, width, 1}, {0, 0, 90 + 1e-10})
                                          : builder.quad(light, start, width, 1, {90, 0, 0});
        object.velocity = {8, 0, 0};
        this->expect_coverage(builder.scene, 0.25, 40000, kind);
    }
}

TYPED_TEST(CameraTest, VelocityZeroIsTheStaticSceneBitForBit) {
    SceneBuilder builder;
    builder.camera({0, 1, -4}, {0, 0, 0}).image(16, 16, 60, true).depth(4).environment(0.5);
    builder.sphere(builder.mirror(Vec3d(0.75)), {0, 0, 0}, 1.5);
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, -0.75, 0}, 8, 8);
    Scene shutter = builder.scene;
    shutter.camera.shutter_close = 1;
    EXPECT_EQ(test::render<TypeParam>(builder.scene, {.samples = 4}).sums(),
              test::render<TypeParam>(shutter, {.samples = 4}).sums());
}

TYPED_TEST(CameraTest, PixelIsABoxFilter) {
    // One pixel of 90 degrees spans [-1, 1] at distance 1. The camera's right is -x.
    for (const double share : {0.1, 0.5, 0.875}) {
        SceneBuilder builder;
        builder.image(1, 1, 90, true);
        half_wall(builder, 2 * share - 1, 1);
        this->expect_coverage(builder.scene, share, 40000, share);
        SceneBuilder upright;
        upright.image(1, 1, 90, true);
        upright.quad(upright.emitter(Vec3d(1.0)), {0, 2 * share - 1 - 2, 1}, 4, 4, {90, 0, 0});  // y <= 2 share - 1
        this->expect_coverage(upright.scene, share, 40000, share);
    }
}

TYPED_TEST(CameraTest, WithoutJitterEverySampleIsThePixelsCentre) {
    SceneBuilder builder;
    builder.image(4, 4, 90, false);
    half_wall(builder, 0.2, 1);  // pixel centres at -.75, -.25, .25, .75
    const Film film = test::render<TypeParam>(builder.scene, {.samples = 8});
    for (std::uint32_t row = 0; row < 4; ++row) {
        // Column 0 is the camera's left: +x.
        EXPECT_EQ(film.pixel(4 * row + 0), Vec3d(0.0));
        EXPECT_EQ(film.pixel(4 * row + 1), Vec3d(0.0));
        EXPECT_EQ(film.pixel(4 * row + 2), Vec3d(1.0));
        EXPECT_EQ(film.pixel(4 * row + 3), Vec3d(1.0));
    }
}

TYPED_TEST(CameraTest, TheImageIsUprightAndNotMirrored) {
    // A usual camera: looks along -z, y up, x to the right.
    SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, -1}).image(4, 2, 90, false);
    builder.sphere(builder.emitter({1, 0, 0}), {3, 1, -2}, 0.5);    // right and up
    builder.sphere(builder.emitter({0, 1, 0}), {-3, -1, -2}, 0.5);  // left and down
    const Film film = test::render<TypeParam>(builder.scene, {});
    EXPECT_EQ(film.pixel(3), Vec3d(1, 0, 0));
    EXPECT_EQ(film.pixel(4), Vec3d(0, 1, 0));
    EXPECT_EQ(film.mean(), Vec3d(0.125, 0.125, 0));
}

TYPED_TEST(CameraTest, FieldOfViewIsTheVerticalOne) {
    // 60 degrees: the upper edge at tan 30 of the distance. Light just inside and just outside the top row's upper
    // edge.
    for (const double share : {0.995, 1.005}) {
        SceneBuilder builder;
        builder.camera({0, 0, 0}, {0, 0, -1}).image(3, 200, 60, false);
        const double y = std::tan(30 * pi<double> / 180);
        builder.quad(builder.emitter(Vec3d(1.0)), {0, (share - 0.0025) * y + 1, -1}, 4, 2, {90, 0, 0});
        const Film film = test::render<TypeParam>(builder.scene, {});
        EXPECT_EQ(film.pixel(1), Vec3d(share < 1 ? 1.0 : 0.0)) << share;
    }
}

TYPED_TEST(CameraTest, EmissiveSphereCoversItsDisc) {
    // numerics.md S14, at a moderate distance: the share of the image that a sphere covers, its limb at sin = r / d.
    SceneBuilder builder;
    builder.image(64, 64, 20, true);
    builder.sphere(builder.emitter(Vec3d(1.0)), {0, 0, 100}, 20);
    const double limb = std::tan(std::asin(0.1)), half = std::tan(10 * pi<double> / 180);
    const double exact = pi<double> * limb * limb / (4 * half * half);
    const test::Mean mean = mean_radiance<TypeParam>(builder.scene, {.samples = 16}).channel[0];
    EXPECT_NEAR(mean.value(), exact, test::tolerated_errors * mean.standard_error());
}

}  // namespace
}  // namespace pt
