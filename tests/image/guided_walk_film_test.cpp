// Guided walks have the mean of the plain ones, wherever that is known: radiative transfer's closed forms and the walks
// of kernels/materials/subsurface.h, whose tests are in subsurface_test.cpp. And they are shorter, with less noise.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "kernels/shade.h"
#include "tests/support/bodies.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::add_body;
using test::Mean;
using test::RenderOptions;
using test::SceneBuilder;
using test::Slab;
using test::tolerated_errors;

template <class Real>
class GuidedFilmTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(GuidedFilmTest, Reals);

RenderOptions guided(double share, std::uint32_t samples = 1, std::uint64_t seed = 5) {
    RenderOptions options;
    options.samples = samples;
    options.seed = seed;
    options.guided_share = share;
    return options;
}

TYPED_TEST(GuidedFilmTest, SlabReflectsAndTransmitsItsShare) {
    struct Case {
        double tau, albedo, mu, reflectance, transmittance;
    };
    // numerics.md S34: six digits.
    for (const Case& c :
         {Case{.1, 1, 1, .047689, .952311}, Case{2, 1, 1, .517515, .482485}, Case{2, 1, 0, .609940, .390060},
          Case{1, .99, 0, .435962, .544352}, Case{1, .9, 0, .352712, .474746}, Case{5, .9, 0, .476338, .053421}}) {
        for (const double share : {0.25, 0.75}) {
            const Slab result = test::slab<TypeParam>({c.tau, c.albedo}, c.mu, 40000, guided(share));
            EXPECT_NEAR(result.reflected.value(), c.reflectance,
                        tolerated_errors * result.reflected.standard_error() + 1e-6)
                << c.tau << " " << c.albedo << " " << c.mu << " " << share;
            EXPECT_NEAR(result.transmitted.value(), c.transmittance,
                        tolerated_errors * result.transmitted.standard_error() + 1e-6)
                << c.tau << " " << c.albedo << " " << c.mu << " " << share;
        }
    }
}

TYPED_TEST(GuidedFilmTest, HalfSpaceHasChandrasekharsAlbedoWithLessNoise) {
    struct Case {
        double tau, albedo, mu, page;
    };
    // numerics.md S33, in a slab so deep that e^-30 or less comes through. Plain walks need 20 and more times as many
    // samples for the error that is asked for (measured): their variance is page (1 - page) less what absorption takes.
    for (const Case& c : {Case{40, .5, 1, .11522588}, Case{40, .8, 1, .28525450}, Case{60, .9, 1, .41494748},
                          Case{60, .9, .5, .50793891}, Case{60, .9, 0, .47802449}, Case{180, .99, 1, .75272072}}) {
        const Slab plain = test::slab<TypeParam>({c.tau, c.albedo}, c.mu, 2000, guided(0));
        const Slab result = test::slab<TypeParam>({c.tau, c.albedo}, c.mu, 100000, guided(0.75));
        EXPECT_NEAR(result.reflected.value(), c.page, tolerated_errors * result.reflected.standard_error() + 1e-7)
            << c.albedo << " " << c.mu;
        EXPECT_LT(result.reflected.standard_error(), 0.003 * c.page) << c.albedo << " " << c.mu;
        const auto variance = [](const Mean& mean) {
            return mean.standard_error() * mean.standard_error() * static_cast<double>(mean.count());
        };
        EXPECT_LT(variance(result.reflected), variance(plain.reflected) / 3) << c.albedo << " " << c.mu;
    }
}

// Light that comes straight down on half spaces of three colours in one, whose mean free paths differ as well.
template <class Real>
test::ColourMean coloured_half_space(const Vec3d& albedo, const Vec3d& sigma_t, std::uint32_t count) {
    SceneBuilder builder;
    builder.camera({0, 200, 0}, {0, 0, 0}, {1, 0, 0}).depth(2);
    builder.box(builder.subsurface(sigma_t * albedo, sigma_t * (Vec3d(1.0) - albedo)), {0, 0, 0}, {1e5, 300, 1e5});
    test::Stages<Real> stages(builder.scene, guided(0.75));
    test::ColourMean reflected;
    for (std::uint32_t sample = 0; sample < count; ++sample) {
        Path<Real> path = stages.generate(0, sample);
        const bool finished = stages.shade(path, stages.intersect(path));
        reflected.add(finished && path.direction.y > 0 ? Vec3d(path.throughput) : Vec3d(0.0));
    }
    return reflected;
}

// The pages of the test above, to 1 %.
TYPED_TEST(GuidedFilmTest, HalfSpacesOfThreeColoursHaveChandrasekharsAlbedos) {
    const Vec3d page{.11522588, .41494748, .28525450};
    for (const Vec3d& sigma_t : {Vec3d(1.0), Vec3d(0.5, 1, 2)}) {
        const auto reflected = coloured_half_space<TypeParam>({.5, .9, .8}, sigma_t, 800000);
        for (int i = 0; i < 3; ++i) {
            const Mean& mean = reflected.channel[i];
            EXPECT_NEAR(mean.value(), page[i], tolerated_errors * mean.standard_error() + 1e-7) << i;
            EXPECT_LT(mean.standard_error(), 0.002 * page[i]) << i;
        }
    }
}

// A channel that loses nothing, beside two that do, in bodies of which every path comes out: it brings the environment.
TYPED_TEST(GuidedFilmTest, ChannelThatLosesNothingIsInvisible) {
    for (const int shape : {0, 3}) {
        for (const double g : {0.0, 0.5}) {
            SceneBuilder builder;
            builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 12, true).depth(16).environment(1);
            add_body(builder, shape, builder.subsurface({3, 9, 18}, {0, 0.02, 6}, g));
            const auto mean = test::mean_radiance<TypeParam>(builder.scene, guided(0.75, 24000, 3));
            const Mean& kept = mean.channel[0];
            EXPECT_NEAR(kept.value(), 1, tolerated_errors * kept.standard_error()) << shape << " g " << g;
            EXPECT_LT(kept.standard_error(), 0.002) << shape << " g " << g;
        }
    }
}

TEST(GuidedMeanPathTest, DoesNotDependOnTheScattering) {
    for (const int shape : {0, 2, 3}) {
        for (const test::BodyMedium& c : {test::BodyMedium{1, 10, 0}, test::BodyMedium{1, 10, 0.6},
                                          test::BodyMedium{1.5, 5, 0}, test::BodyMedium{1.5, 5, -0.5}}) {
            const Mean path = test::mean_path(shape, c, 20000, guided(0.75));
            const double exact = c.ior * c.ior * test::four_v_over_s(shape);
            // The tolerance is that of subsurface_test.cpp; and a walk's weight is 1 to (its length times least_decay)
            // / sigma_a.
            EXPECT_NEAR(path.value(), exact, tolerated_errors * path.standard_error() + 1e-4)
                << shape << " " << c.ior << " " << c.sigma_s << " " << c.g;
        }
    }
}

// Coloured bodies of every shape, with and without a boundary and an even phase function. Plain walks are noisy: this
// sees 9 %, and what is less is for the closed forms of the tests around it.
TYPED_TEST(GuidedFilmTest, HasTheMeanOfPlainWalks) {
    for (int shape = 0; shape < 4; ++shape) {
        for (const double ior : {1.0, 1.4}) {
            for (const double g : {0.0, 0.5}) {
                for (const Vec3d& absorbs : {Vec3d(0.6, 0.1, 0.3), Vec3d(0, 0.02, 6)}) {
                    SceneBuilder builder;
                    builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(16).environment(1);
                    add_body(builder, shape, builder.subsurface({3, 9, 18}, absorbs, g, ior));
                    builder.quad(builder.emitter({2, 4, 1}), {0.8, 0.8, -1.5}, 0.5, 0.5, {70, 0, 0});
                    const auto plain = test::mean_radiance<TypeParam>(builder.scene, guided(0, 500, 2));
                    const auto mean = test::mean_radiance<TypeParam>(builder.scene, guided(0.75, 700, 3));
                    for (int i = 0; i < 3; ++i) {
                        const double error =
                            std::hypot(plain.channel[i].standard_error(), mean.channel[i].standard_error());
                        EXPECT_NEAR(mean.channel[i].value(), plain.channel[i].value(), tolerated_errors * error)
                            << shape << " ior " << ior << " g " << g << " channel " << i;
                        EXPECT_LT(error, 0.02);
                    }
                }
            }
        }
    }
}

TYPED_TEST(GuidedFilmTest, WhiteBodyInAnEvenEnvironmentIsInvisible) {
    // Every weight is 1 but for the least decay (2^-20) times the way: some hundred mean free paths.
    for (int shape = 0; shape < 4; ++shape) {
        for (const double ior : {1.0, 1.5}) {
            SceneBuilder builder;
            builder.camera({0, 0.5, -3}, {0, 0, 0}).image(4, 4, 40, true).environment(1).depth(64);
            add_body(builder, shape, builder.subsurface(Vec3d(20.0), Vec3d(0.0), 0, ior));
            const Film film = test::render<TypeParam>(builder.scene, guided(0.75, 4));
            for (std::uint32_t i = 0; i < 16; ++i) {
                ASSERT_NEAR(film.pixel(i).x, 1, 1e-3) << shape << " ior " << ior;
            }
        }
    }
}

TYPED_TEST(GuidedFilmTest, ChannelWithoutMediumIsClear) {
    SceneBuilder builder;
    builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(2).environment(1);
    builder.sphere(builder.subsurface({0, 2, 2}, {0, 1, 0}), {0, 0, 0}, 1.5);
    const auto mean = test::mean_radiance<TypeParam>(builder.scene, guided(0.75, 2000));
    EXPECT_NEAR(mean.channel[0].value(), 1, tolerated_errors * mean.channel[0].standard_error());
    EXPECT_NEAR(mean.channel[2].value(), 1, tolerated_errors * mean.channel[2].standard_error());
    EXPECT_LT(mean.channel[0].standard_error(), 0.05);
}

TYPED_TEST(GuidedFilmTest, PureAbsorberIsAMatchedDielectric) {
    SceneBuilder builder;
    builder.camera({0.6, 0, -5}, {0.6, 0, 1}).depth(3).environment(1);
    builder.sphere(builder.subsurface(Vec3d(0.0), {0.25, 0.5, 1}), {0, 0, 0}, 2);
    const auto mean = test::mean_radiance<TypeParam>(builder.scene, guided(0.75, 40000));
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(mean.channel[i].value(), std::exp(-1.6 * std::ldexp(0.25, i)),
                    tolerated_errors * mean.channel[i].standard_error() + 1e-6);
    }
}

TYPED_TEST(GuidedFilmTest, UnfinishedWalksAreCountedAndBlack) {
    const Slab capped = test::slab<TypeParam>({2000, 1, 0, 8}, 0, 20000, guided(0.75));
    const double lost = 1 - capped.reflected.value();
    // numerics.md S33: .5809 escape from a white half space after at most 8 scatterings. With a guide of no decay the
    // weights are 1, and what is lost is what is counted.
    EXPECT_NEAR(lost, 1 - .5809, tolerated_errors * capped.reflected.standard_error() + 3e-4);
    EXPECT_NEAR(static_cast<double>(capped.unfinished) / 20000, lost, 1e-4);
}

TYPED_TEST(GuidedFilmTest, ScenesByAPowerOfTwoLeaveTheSameFilm) {
    const auto film = [](double scale, double share) {
        SceneBuilder builder;
        builder.camera({0, 0.5 * scale, -3 * scale}, {0, 0, 0}).image(8, 8, 40, true).environment(1).depth(8);
        const std::uint32_t material =
            builder.subsurface(Vec3d(4, 6, 9) / scale, Vec3d(0.125, 0.5, 1) / scale, 0, 1.25);
        builder.sphere(material, {0, 0, 0}, 1.5 * scale);
        builder.box(material, {0.5 * scale, -scale, 0}, Vec3d(scale));
        return test::render<TypeParam>(builder.scene, guided(share, 4)).hash();
    };
    const std::string once = film(1, 0.75);
    EXPECT_EQ(film(0x1p-10, 0.75), once);
    EXPECT_EQ(film(0x1p12, 0.75), once);
    EXPECT_NE(film(1, 0), once);  // for it is guided
}

// Steps of walks in a body lit from all round, a walk.
template <class Real>
double mean_steps(double share, double albedo, int shape, Mean* left) {
    using Kernel = Config<Real, all_features | samplings>;
    SceneBuilder builder;
    builder.camera({0, 0.4, -3}, {0, 0, 0}).image(8, 8, 20, true).depth(2).environment(1);
    add_body(builder, shape, builder.subsurface(Vec3d(40 * albedo), Vec3d(40 * (1 - albedo))));
    RenderSettings settings = default_settings(builder.scene);
    settings.guided_share = share;
    const SceneBuffers<Real> buffers(builder.scene, settings);
    PathCounters counters;
    Mean steps;
    for (std::uint32_t sample = 0; sample < 200; ++sample) {
        for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
            Path<Real> path = generate<Kernel>(buffers.view(), pixel, sample);
            const Hit<Real> hit = intersect<Kernel>(buffers.view(), path);
            WalkOf<Kernel> walk;
            if (!hit.side.exists() || !shade<Kernel>(buffers.view(), buffers.view(), path, hit, counters, walk)) {
                continue;
            }
            double taken = 0;
            while (walk.is_on() && walk_on<Kernel>(buffers.view(), path, walk, counters)) {
                taken += 1;
            }
            steps.add(taken);
            left->add(static_cast<double>(path.throughput.x));
        }
    }
    return steps.value();
}

TYPED_TEST(GuidedFilmTest, WalksAreShorterWithLessNoise) {
    for (const int shape : {0, 1, 2, 3}) {
        for (const double albedo : {0.9, 0.98}) {
            Mean plain, towards;
            const double before = mean_steps<TypeParam>(0, albedo, shape, &plain);
            const double after = mean_steps<TypeParam>(0.75, albedo, shape, &towards);
            EXPECT_LT(after, 0.6 * before) << shape << " " << albedo;
            EXPECT_LT(towards.standard_error(), 0.7 * plain.standard_error()) << shape << " " << albedo;
            EXPECT_NEAR(towards.value(), plain.value(),
                        tolerated_errors * std::hypot(towards.standard_error(), plain.standard_error()));
        }
    }
}

TYPED_TEST(GuidedFilmTest, MovingBodyIsGuidedInItsOwnFrame) {
    const Vec3d velocity(4, -2, 1);
    const auto scene = [&](bool moves) {
        SceneBuilder builder;
        builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(8).environment(1);
        builder.scene.camera.shutter_open = builder.scene.camera.shutter_close = 0.5;
        SceneObject& object = builder.sphere(builder.subsurface(Vec3d(3.0), Vec3d(0.5), 0, 1.3), {0, 0, 0}, 1.5);
        if (moves) {
            object.velocity = velocity;
            object.translate = velocity * -0.5;
        }
        return builder.scene;
    };
    const auto moving = test::mean_radiance<TypeParam>(scene(true), guided(0.75, 500));
    const auto still = test::mean_radiance<TypeParam>(scene(false), guided(0.75, 500));
    // Both films have the same random numbers and, but for rounding, the same walks.
    EXPECT_NEAR(moving.channel[0].value(), still.channel[0].value(), 0.1 * still.channel[0].standard_error());
}

// A kernel that could guide walks leaves, where it is not asked to, the film of one that cannot.
TYPED_TEST(GuidedFilmTest, WithoutAShareEveryBitIsAsBefore) {
    for (const double g : {0.0, 0.5}) {
        SceneBuilder builder;
        builder.camera({0, 0.5, -3}, {0, 0, 0}).image(8, 8, 40, true).environment(1).depth(8);
        builder.sphere(builder.subsurface({4, 6, 9}, {0.1, 0.5, 1}, g, 1.3), {0, 0, 0}, 1.5);
        const SceneBuffers<TypeParam> buffers(builder.scene, default_settings(builder.scene));
        const auto radiance = [&]<class Kernel>(std::uint32_t pixel) {
            PathCounters counters;
            Path<TypeParam> path = generate<Kernel>(buffers.view(), pixel, 0);
            while (shade<Kernel>(buffers.view(), buffers.view(), path, intersect<Kernel>(buffers.view(), path),
                                 counters)) {
            }
            return path.radiance;
        };
        for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
            const auto with = radiance.template operator()<Config<TypeParam, all_features | samplings>>(pixel);
            const auto without = radiance.template operator()<Config<TypeParam, all_features>>(pixel);
            ASSERT_EQ(with, without) << pixel;
        }
    }
}

}  // namespace
}  // namespace pt
