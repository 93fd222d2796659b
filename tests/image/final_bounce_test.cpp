// A final bounce at depth D has the mean of plain paths of depth D + 1: by channel, over the image and over its blocks
// of 16 x 16 pixels.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/stage.h"

namespace pt {
namespace {

using test::block_means;
using test::expect_equal_means;
using test::lamp;
using test::SceneBuilder;
using test::side;
using test::stage;

template <class Real>
void expect_same_mean(const Scene& scene, std::uint32_t depth, const std::string& what, std::uint32_t samples_off = 400,
                      std::uint32_t samples_on = 200) {
    const auto off = block_means<Real>(scene, {.samples = samples_off, .depth = depth + 1, .seed = 21});
    const auto on = block_means<Real>(scene, {.samples = samples_on, .depth = depth, .seed = 22, .final_bounce = true});
    expect_equal_means(off, on, what + " depth " + std::to_string(depth));
}

template <class Real>
class FinalBounceTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(FinalBounceTest, Reals);

TYPED_TEST(FinalBounceTest, SphereLight) {
    for (const std::uint32_t depth : {1u, 2u, 4u}) {
        expect_same_mean<TypeParam>(stage(lamp), depth, "sphere");
    }
}

TYPED_TEST(FinalBounceTest, BoxLights) {
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2});
                                }),
                                1, "axis box");
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2}, {20, 30, 40});
                                }),
                                2, "oriented box");
}

TYPED_TEST(FinalBounceTest, EllipsoidLight) {
    for (const std::uint32_t depth : {1u, 2u}) {
        expect_same_mean<TypeParam>(stage([](auto& b) {
                                        b.ellipsoid(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {2.5, 0.4, 1}, {20, 30, 40});
                                    }),
                                    depth, "ellipsoid");
    }
}

TYPED_TEST(FinalBounceTest, QuadLight) {
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.quad(b.emitter({4, 5, 6}), {0.5, 3, -1}, 1.5, 1, {160, 10, 0});
                                }),
                                1, "quad");
    // Free in the room: both of its sides shine.
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.quad(b.emitter({4, 5, 6}), {-1.2, 1.5, -0.5}, 1.5, 1, {80, 50, 0});
                                }),
                                2, "upright quad");
}

TYPED_TEST(FinalBounceTest, SeveralLightsAndAnEnvironment) {
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    lamp(b);
                                    b.box(b.emitter({6, 1, 1}), {-2, 2, -1}, Vec3d(0.8));
                                    b.quad(b.emitter({1, 1, 6}), {2, 2.5, -1}, 1, 1, {0, 0, 150});
                                    b.environment(0.5);
                                }),
                                2, "several");
}

TYPED_TEST(FinalBounceTest, EnvironmentAlone) {
    expect_same_mean<TypeParam>(stage([](auto& b) { b.environment(0.5); }), 1, "environment");
    expect_same_mean<TypeParam>(stage([](auto& b) { b.environment(0.5); }), 3, "environment");
}

TYPED_TEST(FinalBounceTest, MovingLightAndMovingShade) {
    for (const bool late : {false, true}) {
        Scene scene = stage([](auto& b) {
            b.sphere(b.emitter({4, 5, 6}), {-1.5, 3, -1}, 1.2).velocity = {3, 0, 0};
            b.box(b.diffuse(Vec3d(0.5)), {-1, 2, -0.5}, {0.8, 0.1, 0.8}).velocity = {0, -1, 0.5};
        });
        scene.camera.shutter_close = 1;
        scene.camera.shutter_late = late;
        expect_same_mean<TypeParam>(scene, 2, "moving", 600, 300);
    }
}

TYPED_TEST(FinalBounceTest, GlowingDiffuseAndMixLights) {
    // Lights that reflect: they are met on the way and connected to at its end, also from their own inside.
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.sphere(b.diffuse(Vec3d(0.5), {4, 5, 6}), {0.5, 3, -1}, 1.2);
                                }),
                                2, "diffuse lamp");
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.sphere(b.mix(Vec3d(0.5), Vec3d(0.75), 0.5, {4, 5, 6}), {0.5, 3, -1}, 1.2);
                                }),
                                2, "mix lamp");
    SceneBuilder inside;
    inside.camera({0.2, 0.1, 0}, {0, 0, 1}).image(side, side, 90, true);
    inside.box(inside.diffuse({0.75, 0.5, 0.25}, {0.5, 0.25, 1}), {0, 0, 0}, {2, 3, 4});
    inside.sphere(inside.diffuse(Vec3d(0.5)), {0, 0, 1}, 0.5);
    expect_same_mean<TypeParam>(inside.scene, 2, "inside a glowing box");
}

TYPED_TEST(FinalBounceTest, MirrorGlassMixAndRoughMaterialsAtTheLastVertex) {
    const std::function<std::uint32_t(SceneBuilder&)> balls[] = {
        [](auto& b) {
            return b.mirror({0.9, 0.8, 0.7});
        },
        [](auto& b) {
            return b.dielectric(1.5, {0.2, 0.1, 0.4});
        },
        [](auto& b) {
            return b.mix({0.75, 0.5, 0.25}, {0.9, 0.8, 0.7}, 0.4);
        },
        [](auto& b) {
            return b.rough_conductor({0.9, 0.8, 0.7}, 0.4);
        },
        [](auto& b) {
            return b.rough_dielectric(1.5, 0.4, {0.2, 0.1, 0.4});
        },
        [](auto& b) {
            return b.principled({0.9, 0.8, 0.7}, 0.2, 0.4, 0.5);
        },
    };
    for (const auto& ball : balls) {
        for (const std::uint32_t depth : {1u, 2u, 3u}) {
            expect_same_mean<TypeParam>(stage(lamp, ball), depth, "specular");
        }
    }
}

TYPED_TEST(FinalBounceTest, SubsurfaceAtTheLastVertex) {
    expect_same_mean<TypeParam>(stage(lamp,
                                      [](auto& b) {
                                          return b.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}, 0, 1.3);
                                      }),
                                2, "subsurface", 400, 250);
}

TYPED_TEST(FinalBounceTest, LampInsideAbsorbingGlass) {
    // The connection of a diffuse ball inside the glass runs through the medium.
    SceneBuilder builder;
    builder.camera({0, 0, -4}, {0, 0, 0}).image(side, side, 40, true);
    builder.box(builder.dielectric(1.2, {0.5, 0.25, 1}), {0, 0, 0}, {2.4, 2.4, 2.4});
    builder.sphere(builder.diffuse(Vec3d(0.75)), {-0.4, -0.2, 0}, 0.9);
    builder.sphere(builder.emitter({8, 6, 4}), {0.6, 0.6, -0.4}, 0.6);
    expect_same_mean<TypeParam>(builder.scene, 2, "in glass");
    expect_same_mean<TypeParam>(builder.scene, 3, "in glass");
}

TYPED_TEST(FinalBounceTest, BlackSceneStaysBlack) {
    const Film film = test::render<TypeParam>(stage([](auto&) {}), {.samples = 4, .depth = 3, .final_bounce = true});
    EXPECT_EQ(film.mean(), Vec3d(0.0));
}

}  // namespace
}  // namespace pt
