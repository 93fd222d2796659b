// Next-event estimation, with and without multiple importance sampling, and Russian roulette have the mean of plain
// paths of the same depth: by channel, over the image and over its blocks of 16 x 16 pixels, to some per cent (against
// closed forms, and more exactly: connection_closed_form_test.cpp). Where a light touches a surface their variance
// stays finite.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/russian_roulette.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::block_means;
using test::expect_equal_means;
using test::lamp;
using test::RenderOptions;
using test::SceneBuilder;
using test::side;
using test::stage;

template <class Real>
void expect_same_mean(const Scene& scene, std::uint32_t depth, const std::string& what, std::uint32_t samples_on = 80) {
    const auto off = block_means<Real>(scene, {.samples = 300, .depth = depth, .seed = 31});
    for (const std::uint32_t exponent : {0u, 1u, 2u}) {
        expect_equal_means(off,
                           block_means<Real>(scene, {.samples = samples_on,
                                                     .depth = depth,
                                                     .seed = 32 + exponent,
                                                     .next_event = true,
                                                     .mis_exponent = exponent}),
                           what + " depth " + std::to_string(depth) + " exponent " + std::to_string(exponent));
    }
}

struct WayToLight {
    const char* name;
    LightSampling sampling;
    std::uint16_t near_light;
};
constexpr WayToLight ways_to_light[] = {{"area", LightSampling::area, 0},
                                        {"projected", LightSampling::projected, 0},
                                        {"auto", LightSampling::automatic, 20},
                                        {"auto, mostly near", LightSampling::automatic, 400}};

template <class Real>
class NextEventTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(NextEventTest, Reals);

TYPED_TEST(NextEventTest, SphereLight) {
    for (const std::uint32_t depth : {2u, 4u}) {
        expect_same_mean<TypeParam>(stage(lamp), depth, "sphere");
    }
}

TYPED_TEST(NextEventTest, BoxEllipsoidAndQuadLights) {
    const std::function<void(SceneBuilder&)> lights[] = {
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2});
        },
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2}, {20, 30, 40});
        },
        [](auto& b) {
            b.ellipsoid(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {2.5, 0.4, 1}, {20, 30, 40});
        },
        [](auto& b) {
            b.quad(b.emitter({4, 5, 6}), {0.5, 3, -1}, 1.5, 1, {160, 10, 0});
        },
        // Free in the room: both of its sides shine.
        [](auto& b) {
            b.quad(b.emitter({4, 5, 6}), {-1.2, 1.5, -0.5}, 1.5, 1, {80, 50, 0});
        },
        // The box stands on the floor and against the wall.
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {1.5, 0.5, 1.75}, {1, 1, 0.5});
        },
    };
    for (std::size_t i = 0; i < std::size(lights); ++i) {
        expect_same_mean<TypeParam>(stage(lights[i]), 3, "light " + std::to_string(i));
    }
}

// Whichever light is drawn: the mean of light_selection=uniform, of which the tests above have that it is right. Lights
// of every shape, unlike in size, power and distance, one of them moving.
TYPED_TEST(NextEventTest, WaysToChooseALightHaveOneMean) {
    Scene scene = stage([](SceneBuilder& b) {
        b.sphere(b.emitter({40, 30, 20}), {0.5, 2.8, -1}, 0.3);
        b.ellipsoid(b.emitter({1, 2, 3}), {-1, 2.2, 0.5}, {0.9, 0.2, 0.4}, {20, 30, 40});
        b.box(b.emitter({4, 5, 6}), {1.5, 0.3, 1}, {0.5, 0.3, 0.5});
        b.box(b.emitter({3, 0.5, 0.1}), {-1.5, 0.7, 1}, {0.2, 0.9, 0.2}, {20, 30, 40});
        b.quad(b.emitter({4, 5, 6}), {-1.2, 1.5, -0.5}, 0.5, 0.4, {80, 50, 0});
        b.scene.objects.back().velocity = {0, 0.5, 0.2};
        b.scene.camera.shutter_close = 1;
    });
    const auto usual =
        block_means<TypeParam>(scene, {.samples = 150, .depth = 3, .seed = 41, .next_event = true, .mis_exponent = 2});
    for (const LightSelection selection : {LightSelection::power, LightSelection::tree}) {
        for (const std::uint32_t exponent : {0u, 1u, 2u}) {
            expect_equal_means(usual,
                               block_means<TypeParam>(scene, {.samples = 100,
                                                              .depth = 3,
                                                              .seed = 45 + exponent,
                                                              .next_event = true,
                                                              .mis_exponent = exponent,
                                                              .light_selection = selection}),
                               std::string(selection == LightSelection::power ? "power" : "light_tree") + " exponent " +
                                   std::to_string(exponent));
        }
    }
}

// One sample of the two techniques: the mean of plain paths, with every way to choose a light.
TYPED_TEST(NextEventTest, OneSampleOfTwoTechniques) {
    const Scene scene = stage([](SceneBuilder& b) {
        b.sphere(b.emitter({4, 3, 2}), {0.5, 2.8, -1}, 0.6);
        b.box(b.emitter({4, 5, 6}), {1.5, 0.3, 1}, {0.5, 0.3, 0.5});
    });
    const auto off = block_means<TypeParam>(scene, {.samples = 300, .depth = 3, .seed = 61});
    for (const LightSelection selection : {LightSelection::uniform, LightSelection::power, LightSelection::tree}) {
        for (const std::uint32_t exponent : {1u, 2u}) {
            expect_equal_means(
                off,
                block_means<TypeParam>(scene, {.samples = 100,
                                               .depth = 3,
                                               .seed = 62 + exponent,
                                               .next_event = true,
                                               .mis_exponent = exponent,
                                               .light_selection = selection,
                                               .one_sample = true}),
                "selection " + std::to_string(static_cast<int>(selection)) + " exponent " + std::to_string(exponent));
        }
    }
}

// One-sample MIS draws the same numbers as the sum of both techniques: a sample counts twice what the technique that
// was chosen brings there, and nothing by the other; each is chosen about as often.
TYPED_TEST(NextEventTest, OneSampleCountsTheChosenTechniqueTwice) {
    const Scene scene = stage(lamp);
    RenderOptions both{.depth = 2, .seed = 5, .next_event = true, .mis_exponent = 1};
    RenderOptions one = both;
    one.one_sample = true;
    test::Stages<TypeParam> of_both(scene, both), of_one(scene, one);
    int vertices = 0, connected = 0, lit = 0;
    for (std::uint32_t pixel = 0; pixel < of_one.view().pixel_count(); ++pixel) {
        Path<TypeParam> path = of_both.generate(pixel, 0);
        Path<TypeParam> chosen = path;
        if (!of_both.shade(path, of_both.intersect(path)) || path.bsdf_pdf == 0) {
            continue;
        }
        ASSERT_TRUE(of_one.shade(chosen, of_one.intersect(chosen)));
        const Vec3d by_connection(path.radiance);
        path.radiance = Vec3<TypeParam>(TypeParam(0));
        of_both.finish(path);
        const Vec3d by_meeting(path.radiance);
        ++vertices;
        connected += chosen.bsdf_pdf < 0;
        const Vec3d expected = (chosen.bsdf_pdf < 0 ? by_connection : by_meeting) * 2.0;
        of_one.finish(chosen);
        for (int channel = 0; channel < 3; ++channel) {
            ASSERT_EQ(static_cast<double>(chosen.radiance[channel]), expected[channel]) << pixel;
        }
        lit += expected.x > 0;
    }
    EXPECT_GT(vertices, 500);
    EXPECT_GT(lit, 100);
    EXPECT_NEAR(connected, vertices / 2.0, 4 * std::sqrt(vertices / 4.0));
}

// Points on lights however drawn: the mean of solid_angle, of which the tests above have that it is right. With
// multiple importance sampling, since weights are not bounded without where a light is near.
TYPED_TEST(NextEventTest, WaysToDrawLightsHaveOneMean) {
    const std::function<void(SceneBuilder&)> lights[] = {
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2});
        },
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 1.8, -1}, {1, 0.5, 2}, {20, 30, 40});
        },
        [](auto& b) {
            b.quad(b.emitter({4, 5, 6}), {-1.2, 1.5, -0.5}, 1.5, 1, {80, 50, 0});
            b.box(b.diffuse(Vec3d(0.5), {2, 1, 3}), {1.5, 0.5, 1.75}, {1, 1, 0.5});
        },
        // The box stands on the floor and against the wall.
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {1.5, 0.5, 1.75}, {1, 1, 0.5});
        },
    };
    for (std::size_t i = 0; i < std::size(lights); ++i) {
        const Scene scene = stage(lights[i]);
        const auto usual = block_means<TypeParam>(
            scene, {.samples = 150, .depth = 3, .seed = 41, .next_event = true, .mis_exponent = 2});
        for (const WayToLight& way : ways_to_light) {
            expect_equal_means(usual,
                               block_means<TypeParam>(scene, {.samples = 80,
                                                              .depth = 3,
                                                              .seed = 42,
                                                              .next_event = true,
                                                              .mis_exponent = 2,
                                                              .light_sampling = way.sampling,
                                                              .near_light = way.near_light}),
                               std::string(way.name) + " light " + std::to_string(i));
        }
        // Without, where the weights are bounded or the light is far.
        expect_equal_means(usual,
                           block_means<TypeParam>(scene, {.samples = 80,
                                                          .depth = 3,
                                                          .seed = 43,
                                                          .next_event = true,
                                                          .light_sampling = LightSampling::automatic,
                                                          .near_light = 50}),
                           "auto without mis, light " + std::to_string(i));
    }
}

TYPED_TEST(NextEventTest, SeveralLightsAndAnEnvironment) {
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    lamp(b);
                                    b.box(b.emitter({6, 1, 1}), {-2, 2, -1}, Vec3d(0.8));
                                    b.quad(b.emitter({1, 1, 6}), {2, 2.5, -1}, 1, 1, {0, 0, 150});
                                    b.environment(0.5);
                                }),
                                3, "several");
}

TYPED_TEST(NextEventTest, ManyLights) {
    expect_same_mean<TypeParam>(
        stage([](auto& b) {
            for (int i = 0; i < 12; ++i) {
                b.sphere(b.emitter({1.0 + i, 5, 12.0 - i}), {-2.2 + 0.4 * i, 2 + 0.1 * i, -0.5}, 0.3);
            }
        }),
        3, "many");
}

TYPED_TEST(NextEventTest, MovingLightAndMovingShade) {
    Scene scene = stage([](auto& b) {
        b.sphere(b.emitter({4, 5, 6}), {-1.5, 3, -1}, 1.2).velocity = {3, 0, 0};
        b.box(b.diffuse(Vec3d(0.5)), {-1, 2, -0.5}, {0.8, 0.1, 0.8}).velocity = {0, -1, 0.5};
        b.box(b.emitter({3, 1, 1}), {2, 0.5, -1}, {0.5, 1, 0.5}, {0, 30, 0}).velocity = {0, 1, 0};
    });
    scene.camera.shutter_close = 1;
    expect_same_mean<TypeParam>(scene, 3, "moving");
}

TYPED_TEST(NextEventTest, LightsThatReflect) {
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.sphere(b.diffuse(Vec3d(0.5), {4, 5, 6}), {0.5, 3, -1}, 1.2);
                                }),
                                3, "diffuse lamp");
    expect_same_mean<TypeParam>(stage([](auto& b) {
                                    b.sphere(b.mix(Vec3d(0.5), Vec3d(0.75), 0.5, {4, 5, 6}), {0.5, 3, -1}, 1.2);
                                }),
                                3, "mix lamp");
    SceneBuilder inside;
    inside.camera({0.2, 0.1, 0}, {0, 0, 1}).image(side, side, 90, true);
    inside.box(inside.diffuse({0.75, 0.5, 0.25}, {0.5, 0.25, 1}), {0, 0, 0}, {2, 3, 4});
    inside.sphere(inside.diffuse(Vec3d(0.5)), {0, 0, 1}, 0.5);
    expect_same_mean<TypeParam>(inside.scene, 3, "inside a glowing box");
}

TYPED_TEST(NextEventTest, LightByWayOfMirrorGlassMixAndBody) {
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
            return b.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}, 0, 1.3);
        },
    };
    for (std::size_t i = 0; i < std::size(balls); ++i) {
        expect_same_mean<TypeParam>(stage(lamp, balls[i]), 5, "ball " + std::to_string(i));
    }
}

// The last one is too narrow to be connected.
TYPED_TEST(NextEventTest, RoughConductors) {
    for (const double roughness : {1.0, 0.5, 0.25, 0.05}) {
        const Scene scene = stage(lamp, [=](auto& b) { return b.rough_conductor({0.9, 0.8, 0.7}, roughness); });
        expect_same_mean<TypeParam>(scene, 3, "roughness " + std::to_string(roughness));
    }
    const auto white = [](auto& b) { return b.rough_conductor({0.9, 0.8, 0.7}, 0.8, Vec3d(0.0), true); };
    expect_same_mean<TypeParam>(stage(lamp, white), 3, "multiple scattering");
}

// The last one is too narrow to be connected.
TYPED_TEST(NextEventTest, RoughDielectrics) {
    for (const double roughness : {1.0, 0.5, 0.25, 0.05}) {
        const Scene scene = stage(lamp, [=](auto& b) { return b.rough_dielectric(1.5, roughness, {0.2, 0.1, 0.4}); });
        expect_same_mean<TypeParam>(scene, 4, "roughness " + std::to_string(roughness));
    }
}

// The last one has facets too narrow to be connected over a diffuse surface that is.
TYPED_TEST(NextEventTest, PrincipledSurfaces) {
    for (const double roughness : {1.0, 0.5, 0.25, 0.05}) {
        const Vec3d colour{0.9, 0.7, 0.4};
        const std::string name = "roughness " + std::to_string(roughness);
        expect_same_mean<TypeParam>(stage(lamp, [=](auto& b) { return b.principled(colour, 0, roughness); }), 3, name);
        expect_same_mean<TypeParam>(stage(lamp, [=](auto& b) { return b.principled(colour, 0.4, roughness); }), 3,
                                    name + ", part metal");
        expect_same_mean<TypeParam>(stage(lamp, [=](auto& b) { return b.principled(colour, 0.2, roughness, 0.5); }), 4,
                                    name + ", part glass");
    }
}

// What connects through the ball's surface brings much where its lobe is narrow, so these are wide, but for the last.
TYPED_TEST(NextEventTest, LampInsideRoughGlass) {
    for (const double roughness : {1.0, 0.05}) {
        SceneBuilder builder;
        builder.camera({0, 0, -4}, {0, 0, 0}).image(side, side, 50, true);
        builder.sphere(builder.rough_dielectric(1.5, roughness, {0.5, 0.25, 1}, {1, 0.9, 0.8}), {0, 0, 0}, 2.4);
        builder.sphere(builder.diffuse(Vec3d(0.75)), {-0.4, -0.2, 0}, 0.9);
        builder.sphere(builder.emitter({8, 6, 4}), {0.5, 0.5, -0.4}, 0.6);
        expect_same_mean<TypeParam>(builder.scene, 4, "roughness " + std::to_string(roughness), 200);
    }
}

TYPED_TEST(NextEventTest, LampInsideAbsorbingGlass) {
    // The connection of a diffuse ball inside the glass runs through the medium; from outside the lamp is met only.
    SceneBuilder builder;
    builder.camera({0, 0, -4}, {0, 0, 0}).image(side, side, 40, true);
    builder.box(builder.dielectric(1.2, {0.5, 0.25, 1}), {0, 0, 0}, {2.4, 2.4, 2.4});
    builder.sphere(builder.diffuse(Vec3d(0.75)), {-0.4, -0.2, 0}, 0.9);
    builder.sphere(builder.emitter({8, 6, 4}), {0.6, 0.6, -0.4}, 0.6);
    expect_same_mean<TypeParam>(builder.scene, 4, "in glass");
}

// A path of one segment only meets light; a connection is a segment more than the path has so far.
TYPED_TEST(NextEventTest, DepthCountsTheConnection) {
    const Scene scene = stage(lamp);
    const Film off = test::render<TypeParam>(scene, {.samples = 4, .depth = 1});
    for (const std::uint32_t exponent : {0u, 2u}) {
        const Film on =
            test::render<TypeParam>(scene, {.samples = 4, .depth = 1, .next_event = true, .mis_exponent = exponent});
        for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
            ASSERT_EQ(on.pixel(pixel), off.pixel(pixel));  // whole numbers, which both films hold exactly
        }
    }
}

// The box of cis565: its lamp is let into the ceiling. Sampled by area the ceiling's connections would have a variance
// without bound: here that of a sample is below the emission's square.
TYPED_TEST(NextEventTest, LampThatTouchesTheCeiling) {
    SceneBuilder builder;
    builder.camera({0, 0, -2.4}, {0, 0.8, 0}).image(side, side, 60, true);
    builder.box(builder.diffuse(Vec3d(0.7)), {0, 1.05, 0}, {4, 0.1, 4});
    builder.box(builder.emitter(Vec3d(1.0)), {0, 1, 0}, {1, 0.3, 1});
    expect_same_mean<TypeParam>(builder.scene, 3, "ceiling");
    const auto means =
        block_means<TypeParam>(builder.scene, {.samples = 400, .depth = 3, .seed = 5, .next_event = true});
    for (const test::ColourMeanOfPixels& mean : means) {
        EXPECT_LT(mean.channel[0].variance(), 1.0);
    }
}

// A connection may weigh more than any light that is met: the film has room for it, and for no more than before where
// there is none.
TEST(NextEventFilm, HasRoomForConnections) {
    const Scene scene = stage(lamp);
    RenderSettings settings = default_settings(scene);
    const double plain = radiance_bound(scene, settings.depth);
    EXPECT_EQ(radiance_bound(scene, settings), plain);
    settings.next_event = true;
    EXPECT_EQ(radiance_bound(scene, settings), 1024 * plain);
    settings.next_event = false;
    settings.final_bounce = true;
    EXPECT_EQ(radiance_bound(scene, settings), 1024 * plain);
    // Close to a lamp that stands on the floor: by area, little of it is seen from next to nothing.
    SceneBuilder close;
    close.camera({0, 1.5, -4}, {1.5, 0, -0.755}).image(side, side, 0.5, true);
    close.quad(close.diffuse(Vec3d(0.75)), {0, 0, 0}, 8, 8);
    close.box(close.emitter(Vec3d(1.0)), {1.5, 0.5, -0.5}, {1, 1, 0.5});
    const RenderOptions options{.samples = 100, .depth = 1, .final_bounce = true};
    EXPECT_EQ(test::render<float>(close.scene, options).faults().saturated, 0u);
    test::Stages<float> stages(close.scene, options);
    double brightest = 0;
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
        for (std::uint32_t sample = 0; sample < options.samples; ++sample) {
            brightest = std::max(brightest, stages.radiance(pixel, sample).z);
        }
    }
    EXPECT_GT(brightest, 64 * radiance_bound(close.scene, 1)) << "no sample that had no room before";
}

template <class Real>
class RouletteTest : public testing::Test {};
TYPED_TEST_SUITE(RouletteTest, Reals);

TYPED_TEST(RouletteTest, HasTheMeanOfWholePaths) {
    const std::function<std::uint32_t(SceneBuilder&)> balls[] = {
        [](auto& b) {
            return b.mix({0.75, 0.5, 0.25}, {0.9, 0.8, 0.7}, 0.4);
        },
        [](auto& b) {
            return b.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}, 0, 1.3);
        },
    };
    for (const auto& ball : balls) {
        const Scene scene = stage(lamp, ball);
        const auto off = block_means<TypeParam>(scene, {.samples = 300, .depth = 8, .seed = 41});
        for (const std::uint32_t start : {1u, 3u}) {
            expect_equal_means(off,
                               block_means<TypeParam>(
                                   scene, {.samples = 300, .depth = 8, .seed = 42 + start, .roulette_start = start}),
                               "roulette from " + std::to_string(start));
        }
        expect_equal_means(
            off,
            block_means<TypeParam>(
                scene,
                {.samples = 150, .depth = 8, .seed = 51, .next_event = true, .mis_exponent = 2, .roulette_start = 2}),
            "roulette with connections");
    }
}

// A closed room that shines evenly brings what is left of a series, by channel: here to 0.5 %.
TYPED_TEST(RouletteTest, InAFurnaceLosesNothing) {
    const Vec3d albedo{0.75, 0.5, 0.25};
    SceneBuilder builder;
    builder.camera({0.25, 0.125, -0.5}, {0.3, -0.2, 1}).image(4, 4, 120, true).depth(6);
    builder.sphere(builder.diffuse(albedo, Vec3d(1.0) - albedo), {0, 0, 0}, 2);
    for (const std::uint32_t start : {1u, 3u}) {
        const auto mean = test::mean_radiance<TypeParam>(
            builder.scene, {.samples = 30000, .depth = 6, .seed = 7, .roulette_start = start});
        for (int i = 0; i < 3; ++i) {
            const double exact = 1 - std::pow(albedo[i], 6);
            const double error = mean.channel[i].standard_error();
            EXPECT_NEAR(mean.channel[i].value(), exact, test::tolerated_errors * error + 1e-6) << start << " " << i;
            EXPECT_LT(error, 0.001 * exact) << start << " " << i;
        }
    }
}

// What survives carries at least 1 in one channel; what carries that is not put to the choice; nothing survives with
// nothing.
TYPED_TEST(RouletteTest, LeavesTheLargestChannelAtOne) {
    using Real = TypeParam;
    Path<Real> path{};
    path.throughput = {Real(0.25), Real(0.5), Real(0.125)};
    EXPECT_TRUE(survives_roulette(path, Real(0.4999)));
    EXPECT_EQ(path.throughput, Vec3<Real>(Real(0.5), Real(1), Real(0.25)));
    EXPECT_TRUE(survives_roulette(path, Real(0.9999)));
    EXPECT_EQ(path.throughput, Vec3<Real>(Real(0.5), Real(1), Real(0.25)));
    path.throughput = {Real(0.25), Real(0.5), Real(0.125)};
    EXPECT_FALSE(survives_roulette(path, Real(0.5)));
    path.throughput = Vec3<Real>(0);
    EXPECT_FALSE(survives_roulette(path, Real(0)));
}

// Beyond the longest path there is no choice: the same film.
TYPED_TEST(RouletteTest, ThatNeverBeginsChangesNothing) {
    const Scene scene = stage(lamp);
    EXPECT_EQ(test::render<TypeParam>(scene, {.samples = 2, .depth = 4, .roulette_start = 4}).hash(),
              test::render<TypeParam>(scene, {.samples = 2, .depth = 4}).hash());
    EXPECT_NE(test::render<TypeParam>(scene, {.samples = 2, .depth = 4, .roulette_start = 1}).hash(),
              test::render<TypeParam>(scene, {.samples = 2, .depth = 4}).hash());
}

}  // namespace
}  // namespace pt
