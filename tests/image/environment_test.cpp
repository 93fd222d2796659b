// Light from all round that is drawn as lights are (kernels/environment_map.h), in whole films: met by chance it is
// what a plain environment is, to the last bit; drawn, with and without multiple importance sampling, it has the same
// mean; and where the light of an image is known in closed form, that is the mean.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/environment_map.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::block_means;
using test::ColourMean;
using test::expect_equal_means;
using test::lamp;
using test::mean_radiance;
using test::SceneBuilder;
using test::stage;

template <class Real>
class EnvironmentTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(EnvironmentTest, Reals);

// 12 x 6 texels, brighter upwards, with a window of one texel.
void sky(SceneBuilder& builder) {
    std::vector<Vec3d> texels;
    for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 12; ++column) {
            texels.push_back(Vec3d(0.2, 0.3, 0.5) * (1.0 + 0.25 * (5 - row)) + Vec3d(0.02 * column));
        }
    }
    texels[12 + 10] = {30, 25, 20};
    builder.environment_map(12, 6, texels, 25);
}

void even(SceneBuilder& builder) { builder.environment_map(1, 1, {Vec3d(0.75, 0.5, 0.25)}); }

const std::function<std::uint32_t(SceneBuilder&)> balls[] = {
    [](auto& b) {
        return b.diffuse({0.75, 0.5, 0.25});
    },
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

TYPED_TEST(EnvironmentTest, MetByChanceIsAPlainEnvironment) {
    for (const auto& ball : balls) {
        const Scene drawn = stage([](auto& b) { even(b); }, ball);
        Scene plain = drawn;
        plain.environment_map = nullptr;
        plain.environment = {0.75, 0.5, 0.25};
        EXPECT_EQ(test::render<TypeParam>(drawn, {.samples = 2, .depth = 5}).hash(),
                  test::render<TypeParam>(plain, {.samples = 2, .depth = 5}).hash());
    }
}

// A convex body of albedo a in an even light L: a L in every path, whichever way it is found by chance; by connections
// in the mean.
TYPED_TEST(EnvironmentTest, ConvexBodyInAnEvenLight) {
    SceneBuilder builder;
    builder.camera({0, 0, -3}, {0, 0, 0}).image(8, 8, 20, true).depth(8);
    builder.sphere(builder.diffuse(Vec3d(0.5, 0.25, 1)), {0, 0, 0}, 2);
    builder.environment_map(1, 1, {Vec3d(2, 4, 0.5)});
    const Film film = test::render<TypeParam>(builder.scene, {.samples = 4});
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
        EXPECT_EQ(film.pixel(pixel), Vec3d(1, 1, 0.5));
    }
    for (const std::uint32_t exponent : {0u, 1u, 2u}) {
        const ColourMean mean =
            mean_radiance<TypeParam>(builder.scene, {.samples = 300, .next_event = true, .mis_exponent = exponent});
        for (int c = 0; c < 3; ++c) {
            const double exact = c == 2 ? 0.5 : 1;
            EXPECT_NEAR(mean.channel[c].value(), exact, test::tolerated_errors * mean.channel[c].standard_error());
            EXPECT_LT(mean.channel[c].standard_error(), 0.01);
        }
    }
}

// Behind walls nothing of it is to be seen.
TYPED_TEST(EnvironmentTest, ClosedRoomKeepsItOut) {
    SceneBuilder builder;
    builder.camera({0.25, 0.125, -0.5}, {0.3, -0.2, 1}).image(8, 8, 120, true).depth(6);
    builder.room(builder.diffuse(Vec3d(0.5), Vec3d(0.25)), {0, 0, 0}, {1, 1.5, 2});
    const Film without = test::render<TypeParam>(builder.scene, {.samples = 2});
    sky(builder);
    const Film with = test::render<TypeParam>(builder.scene, {.samples = 2});
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
        EXPECT_NEAR(with.pixel(pixel).x, without.pixel(pixel).x, 1e-6);
    }
}

TYPED_TEST(EnvironmentTest, BackgroundIsTheImage) {
    SceneBuilder builder;
    builder.camera({1, 2, 3}, {1, 3, 1.5}).image(16, 16, 100, false);
    sky(builder);
    builder.sphere(builder.diffuse(Vec3d(0.5)), {1, 2, 13}, 1);  // out of sight
    const Film film = test::render<TypeParam>(builder.scene, {});
    const test::Stages<TypeParam> stages(builder.scene);
    const auto& texels = builder.scene.environment_map->image.texels;
    int agreed = 0;
    for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
        const Vec3d d(stages.generate(pixel, 0).direction);
        const double turns = std::atan2(d.x, -d.z) / (2 * pi<double>)+25.0 / 360;
        const auto column = static_cast<std::size_t>((turns - std::floor(turns)) * 12);
        const auto row = static_cast<std::size_t>(std::acos(d.y) / pi<double> * 6);
        const Vec3d expected(texels[12 * row + column]);
        agreed +=
            std::abs(film.pixel(pixel).x - expected.x) < 1e-5 && std::abs(film.pixel(pixel).z - expected.z) < 1e-5;
    }
    EXPECT_GE(agreed, 254);  // all but those on a border
}

template <class Real>
void expect_same_mean(const Scene& scene, std::uint32_t depth, const std::string& what) {
    const auto off = block_means<Real>(scene, {.samples = 300, .depth = depth, .seed = 31});
    for (const auto selection : {LightSelection::uniform, LightSelection::power, LightSelection::tree}) {
        for (const std::uint32_t exponent : {0u, 1u, 2u}) {
            const test::RenderOptions options{.samples = 80,
                                              .depth = depth,
                                              .seed = 32 + exponent,
                                              .next_event = true,
                                              .mis_exponent = exponent,
                                              .light_selection = selection};
            expect_equal_means(off, block_means<Real>(scene, options), what + " exponent " + std::to_string(exponent));
        }
        const test::RenderOptions one{.samples = 120,
                                      .depth = depth,
                                      .seed = 39,
                                      .next_event = true,
                                      .mis_exponent = 1,
                                      .light_selection = selection,
                                      .one_sample = true};
        expect_equal_means(off, block_means<Real>(scene, one), what + " one sample");
        if (!contains(features_of(scene), Feature::emitter)) {
            return;  // no lights to choose from
        }
    }
}

TYPED_TEST(EnvironmentTest, DrawnHasTheMeanOfMet) {
    for (std::size_t i = 0; i < std::size(balls); ++i) {
        expect_same_mean<TypeParam>(stage([](auto& b) { sky(b); }, balls[i]), 4, "ball " + std::to_string(i));
    }
    expect_same_mean<TypeParam>(stage([](auto& b) { even(b); }), 3, "even");
}

TYPED_TEST(EnvironmentTest, BesideOtherLights) {
    const Scene scene = stage([](auto& b) {
        lamp(b);
        b.quad(b.emitter({1, 1, 6}), {2, 2.5, -1}, 1, 1, {0, 0, 150});
        sky(b);
    });
    expect_same_mean<TypeParam>(scene, 3, "several");
    // The last vertex connected: the mean of one segment more.
    expect_equal_means(block_means<TypeParam>(scene, {.samples = 300, .depth = 3, .seed = 51}),
                       block_means<TypeParam>(scene, {.samples = 300, .depth = 2, .seed = 52, .final_bounce = true}),
                       "final bounce");
}

// A floor under one bright texel and an even rest: what it reflects is albedo (L + (L' - L) E / pi), with
// E = dphi (sin^2 theta_1 - sin^2 theta_0) / 2 the texel's cosine integral. By chance one path in thousands meets it.
TYPED_TEST(EnvironmentTest, OneBrightTexelOf1e8) {
    constexpr std::uint32_t width = 64, height = 32, row = 5, column = 20;
    constexpr double contrast = 1e8;
    std::vector<Vec3d> texels(width * height, Vec3d(1));
    texels[row * width + column] = Vec3d(contrast);
    SceneBuilder builder;
    builder.camera({0, 2, 0}, {0, 0, 0.5}).image(8, 8, 20, true).depth(2);
    builder.quad(builder.diffuse(Vec3d(0.5)), {0, 0, 0}, 10, 10);
    builder.environment_map(width, height, texels);
    const double low = std::sin(row * pi<double> / height), high = std::sin((row + 1) * pi<double> / height);
    const double of_texel = 2 * pi<double> / width * (high * high - low * low) / 2;
    const double exact = 0.5 * (1 + (contrast - 1) * of_texel / pi<double>);
    for (const std::uint32_t exponent : {0u, 1u, 2u}) {
        const ColourMean mean = mean_radiance<TypeParam>(
            builder.scene, {.samples = 100, .seed = 9, .next_event = true, .mis_exponent = exponent});
        const test::Mean& channel = mean.channel[1];
        EXPECT_NEAR(channel.value(), exact, test::tolerated_errors * channel.standard_error() + 1e-5 * exact)
            << exponent;
        EXPECT_LT(channel.standard_error(), 0.002 * exact) << exponent;
    }
}

// The light is multiplied by a power of two, from below the least to beyond the largest of other tests.
TYPED_TEST(EnvironmentTest, ScalesWithItsRadiance) {
    const Scene scene = stage([](auto& b) { sky(b); });
    for (const std::uint32_t exponent : {0u, 2u}) {
        const test::RenderOptions options{.samples = 2, .depth = 4, .next_event = true, .mis_exponent = exponent};
        const Film film = test::render<TypeParam>(scene, options);
        for (const int power : {-60, 3, 60}) {
            const Film scaled = test::render<TypeParam>(test::brightened(scene, std::ldexp(1.0, power)), options);
            EXPECT_EQ(scaled.sums(), film.sums()) << power;
            EXPECT_TRUE(scaled.faults().none());
        }
    }
}

// What a film can hold of one sample: a sun takes no room from what is fainter by 10^8.
TEST(EnvironmentBound, SunLeavesRoomForTheSky) {
    SceneBuilder builder;
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, 0, 4}, 1);
    std::vector<Vec3d> texels(64 * 32, Vec3d(1));
    texels[5 * 64] = Vec3d(1e8);
    builder.environment_map(64, 32, texels);
    RenderSettings settings = default_settings(builder.scene);
    EXPECT_EQ(radiance_bound(builder.scene, settings), 1e8);
    settings.next_event = true;
    EXPECT_EQ(radiance_bound(builder.scene, settings), 1e8);
    builder.environment_map(2, 2, std::vector<Vec3d>(4, Vec3d(3)));
    EXPECT_EQ(radiance_bound(builder.scene, settings), 1024 * 3);
    builder.emitter(Vec3d(5));
    EXPECT_EQ(radiance_bound(builder.scene, settings), 1024 * 5);
}

}  // namespace
}  // namespace pt
