// Random walks in bodies against radiative transfer: numerics.md S33 to S37.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "kernels/sampling.h"
#include "tests/support/bodies.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::add_body;
using test::Mean;
using test::SceneBuilder;
using test::Slab;
using test::Stages;
using test::tolerated_errors;

template <class Real>
class SubsurfaceTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SubsurfaceTest, Reals);

TYPED_TEST(SubsurfaceTest, WhiteBodyInAnEvenEnvironmentIsInvisible) {
    // numerics.md S36: every path comes out again, with weight exactly 1; with a matched index in 2 segments.
    for (int shape = 0; shape < 4; ++shape) {
        for (const double ior : {1.0, 1.5}) {
            for (const double sigma : {0.0, 1e-6, 1.0, 50.0}) {
                for (const double g : {0.0, 0.8, -0.5}) {
                    if (sigma == 1e-6 && ior != 1) {
                        continue;  // below
                    }
                    SceneBuilder builder;
                    builder.camera({0, 0.5, -3}, {0, 0, 0}).image(8, 8, 40, true).environment(1);
                    builder.depth(ior == 1 ? 2 : 64);
                    add_body(builder, shape, builder.subsurface(Vec3d(sigma), Vec3d(0.0), g, ior));
                    const Film film = test::render<TypeParam>(builder.scene, {.samples = sigma > 1 ? 1u : 4u});
                    for (std::uint32_t i = 0; i < 64; ++i) {
                        ASSERT_EQ(film.pixel(i), Vec3d(1.0))
                            << shape << " ior " << ior << " sigma " << sigma << " g " << g;
                    }
                }
            }
        }
    }
}

TYPED_TEST(SubsurfaceTest, UnfinishedWalksAreCountedAndBlack) {
    SceneBuilder builder;
    builder.camera({0, 0, -3}, {0, 0, 0}).depth(2).environment(1);
    builder.scene.materials.reserve(1);
    const std::uint32_t material = builder.subsurface(Vec3d(4.0));
    builder.scene.materials[material].max_scatterings = 3;
    builder.sphere(material, {0, 0, 0}, 2);
    Stages<TypeParam> stages(builder.scene);
    std::uint64_t black = 0;
    for (std::uint32_t sample = 0; sample < 1000; ++sample) {
        const double value = stages.radiance(0, sample).x;
        EXPECT_TRUE(value == 0 || value == 1);
        black += value == 0 ? 1u : 0u;
    }
    EXPECT_EQ(black, stages.unfinished_walks());
    EXPECT_GT(black, 100u);
    EXPECT_LT(black, 900u);
}

template <class Real>
Slab slab(double tau, double albedo, double mu, int count, std::uint32_t max_scatterings = 1000000, double g = 0) {
    test::RenderOptions options;
    options.seed = 5;
    return test::slab<Real>({tau, albedo, g, max_scatterings}, mu, count, options);
}

TYPED_TEST(SubsurfaceTest, SlabReflectsAndTransmitsItsShare) {
    struct Case {
        double tau, albedo, mu, reflectance, transmittance;
    };
    // numerics.md S34: six digits.
    for (const Case& c :
         {Case{.1, 1, 1, .047689, .952311}, Case{1, 1, 1, .341329, .658671}, Case{2, 1, 1, .517515, .482485},
          Case{5, 1, 1, .738721, .261279}, Case{1, 1, 0, .446594, .553406}, Case{2, 1, 0, .609940, .390060},
          Case{1, .99, 0, .435962, .544352}, Case{1, .9, 0, .352712, .474746}, Case{2, .9, 0, .437147, .265581},
          Case{5, .9, 0, .476338, .053421}}) {
        const Slab result = slab<TypeParam>(c.tau, c.albedo, c.mu, 60000);
        EXPECT_NEAR(result.reflected.value(), c.reflectance,
                    tolerated_errors * result.reflected.standard_error() + 1e-6)
            << c.tau << " " << c.albedo << " " << c.mu;
        EXPECT_NEAR(result.transmitted.value(), c.transmittance,
                    tolerated_errors * result.transmitted.standard_error() + 1e-6)
            << c.tau << " " << c.albedo << " " << c.mu;
    }
}

TYPED_TEST(SubsurfaceTest, HalfSpaceHasChandrasekharsAlbedo) {
    struct Case {
        double tau, albedo, mu, page;
    };
    // numerics.md S33, in a slab so deep that e^-30 or less comes through.
    for (const Case& c : {Case{40, .5, 1, .11522588}, Case{40, .8, 1, .28525450}, Case{60, .9, 1, .41494748},
                          Case{60, .9, .5, .50793891}, Case{60, .9, 0, .47802449}, Case{180, .99, 1, .75272072}}) {
        const Slab result = slab<TypeParam>(c.tau, c.albedo, c.mu, c.tau > 100 ? 4000 : 10000);
        EXPECT_NEAR(result.reflected.value(), c.page, tolerated_errors * result.reflected.standard_error() + 1e-7)
            << c.albedo << " " << c.mu;
    }
}

TYPED_TEST(SubsurfaceTest, CapLosesWhatScattersMoreOften) {
    // numerics.md S33: escaped from a white half space after at most n scatterings. (Four digits, from a Monte Carlo
    // run of unknown length: 3e-4 on top.)
    struct Case {
        std::uint32_t cap;
        double mu, escaped;
    };
    for (const Case& c : {Case{8, 0, .5809}, Case{32, 0, .7753}, Case{8, 1, .5025}, Case{256, 1, .8981}}) {
        const Slab result = slab<TypeParam>(2000, 1, c.mu, c.cap < 100 ? 100000 : 30000, c.cap);
        EXPECT_NEAR(result.reflected.value(), c.escaped, tolerated_errors * result.reflected.standard_error() + 3e-4)
            << c.cap << " " << c.mu;
    }
    // No scattering... is not to be had from a scene file (1 is the least): then only what scatters once or not at all
    // comes back. From normal incidence on a white half space that is 1/2 int e^-t int e^(-t/mu) dmu dt = (1 - ln 2)
    // / 2.
    const Slab once = slab<TypeParam>(2000, 1, 1, 100000, 1);
    EXPECT_NEAR(once.reflected.value(), 0.5 * (1 - std::log(2.0)), tolerated_errors * once.reflected.standard_error());
}

TYPED_TEST(SubsurfaceTest, SimilarSlabsOfForwardScatterersTransmitAlike) {
    // Thick white slabs with equal (1 - g) tau transmit nearly alike (diffusion): within 2 % at reduced depth 10, where
    // a phase function turned the wrong way round would be off by a factor of 10.
    const Slab forward = slab<TypeParam>(40, 1, 0, 8000, 1000000, 0.75);
    EXPECT_NEAR(forward.transmitted.value(), .116745,
                0.02 * .116745 + tolerated_errors * forward.transmitted.standard_error());
}

TEST(SubsurfaceTest, MeanPathDoesNotDependOnTheScattering) {
    for (const int shape : {0, 2, 3}) {
        struct Case {
            double ior, sigma_s, g;
        };
        for (const Case& c : {Case{1, 0.5, 0}, Case{1, 10, 0}, Case{1, 10, 0.9}, Case{1.5, 5, 0}, Case{1.5, 5, 0.8}}) {
            const Mean path = test::mean_path(shape, {c.ior, c.sigma_s, c.g}, 40000);
            const double length = path.value(), error = path.standard_error();
            const double exact = c.ior * c.ior * test::four_v_over_s(shape);
            // 1 - (1 - x)^k = k x to 1e-7 k; the throughput's own rounding is 1e-16 / 1e-7.
            EXPECT_NEAR(length, exact, tolerated_errors * error + 1e-4)
                << shape << " " << c.ior << " " << c.sigma_s << " " << c.g;
            EXPECT_LT(error, 0.03 * exact);
        }
    }
}

TYPED_TEST(SubsurfaceTest, ColouredBodyIsThreeGreyBodies) {
    const Vec3d sigma_s(1, 3, 6), sigma_a(0.6, 0.1, 0.3);
    for (int shape = 0; shape < 4; ++shape) {
        for (const double ior : {1.0, 1.4}) {
            const auto scene = [&](const Vec3d& s, const Vec3d& a) {
                SceneBuilder builder;
                builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(16).environment(1);
                add_body(builder, shape, builder.subsurface(s, a, 0.3, ior));
                return builder.scene;
            };
            const auto coloured = test::mean_radiance<TypeParam>(scene(sigma_s, sigma_a), {.samples = 3000, .seed = 2});
            for (int i = 0; i < 3; ++i) {
                const auto grey = test::mean_radiance<TypeParam>(scene(Vec3d(sigma_s[i]), Vec3d(sigma_a[i])),
                                                                 {.samples = 1000, .seed = 3});
                const double error = std::hypot(coloured.channel[i].standard_error(), grey.channel[i].standard_error());
                EXPECT_NEAR(coloured.channel[i].value(), grey.channel[i].value(), tolerated_errors * error)
                    << shape << " ior " << ior << " channel " << i;
                EXPECT_LT(error, 0.006);
            }
        }
    }
}

TYPED_TEST(SubsurfaceTest, ColouredWhiteBodyKeepsTheSumOfItsChannels) {
    // Without absorption what a walk takes from one channel it gives to the others: the weights are bounded whatever
    // the length of the walk. The tolerance is the rounding of some 10^3 products.
    SceneBuilder builder;
    builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(2).environment(1);
    builder.box(builder.subsurface({2, 10, 40}), {0, 0, 0}, {1, 1.25, 1.5}, {10, 20, 30});
    Stages<TypeParam> stages(builder.scene);
    test::ColourMean mean;
    for (std::uint32_t pixel = 0; pixel < 16; ++pixel) {
        for (std::uint32_t sample = 0; sample < 1000; ++sample) {
            const Vec3d radiance = stages.radiance(pixel, sample);
            ASSERT_NEAR(radiance.x + radiance.y + radiance.z, 3, sizeof(TypeParam) == 4 ? 1e-3 : 1e-11);
            mean.add(radiance);
        }
    }
    for (const Mean& channel : mean.channel) {
        EXPECT_NEAR(channel.value(), 1, tolerated_errors * channel.standard_error());
        EXPECT_LT(channel.standard_error(), 0.01);
    }
}

TYPED_TEST(SubsurfaceTest, ChannelWithoutMediumIsClear) {
    // sigma 0 in one channel: nothing is absorbed or scattered there, whatever the others do. Mean 1, without bias.
    SceneBuilder builder;
    builder.camera({0, 0.4, -3}, {0, 0, 0}).image(4, 4, 20, true).depth(2).environment(1);
    builder.sphere(builder.subsurface({0, 2, 2}, {0, 1, 0}), {0, 0, 0}, 1.5);
    const auto mean = test::mean_radiance<TypeParam>(builder.scene, {.samples = 2000});
    EXPECT_NEAR(mean.channel[0].value(), 1, tolerated_errors * mean.channel[0].standard_error());
    EXPECT_NEAR(mean.channel[2].value(), 1, tolerated_errors * mean.channel[2].standard_error());
    EXPECT_LT(mean.channel[0].standard_error(), 0.02);
}

TYPED_TEST(SubsurfaceTest, PureAbsorberIsAMatchedDielectric) {
    // sigma_s = 0: what comes through is e^(-sigma_a chord), as in numerics.md S32, here by chance.
    for (const double b : {0.0, 0.6}) {
        SceneBuilder builder;
        builder.camera({b, 0, -5}, {b, 0, 1}).depth(3).environment(1);
        builder.sphere(builder.subsurface(Vec3d(0.0), {0.25, 0.5, 1}), {0, 0, 0}, 2);
        const auto mean = test::mean_radiance<TypeParam>(builder.scene, {.samples = 40000});
        const double chord = 2 * std::sqrt(1 - b * b);
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(mean.channel[i].value(), std::exp(-chord * std::ldexp(0.25, i)),
                        tolerated_errors * mean.channel[i].standard_error() + 1e-6);
        }
    }
}

TYPED_TEST(SubsurfaceTest, ClearBodyWithAnIndexIsGlass) {
    // numerics.md S37: without medium the boundary alone is left; L behind it as for a dielectric. A lamp seen through
    // the body, so that bending shows: both must agree.
    const auto scene = [](bool subsurface) {
        SceneBuilder builder;
        builder.camera({0, 0, -5}, {0, 0, 0}).image(6, 6, 25, true).depth(50);
        builder.sphere(subsurface ? builder.subsurface(Vec3d(0.0), Vec3d(0.0), 0, 1.5) : builder.dielectric(1.5),
                       {0, 0, 0}, 2);
        builder.quad(builder.emitter({1, 0.5, 0.25}), {0.5, 0.25, 3}, 2, 1, {90, 0, 0});
        return builder.scene;
    };
    const auto body = test::mean_radiance<TypeParam>(scene(true), {.samples = 3000, .seed = 4}).channel[0];
    const auto glass = test::mean_radiance<TypeParam>(scene(false), {.samples = 3000, .seed = 5}).channel[0];
    EXPECT_NEAR(body.value(), glass.value(),
                tolerated_errors * std::hypot(body.standard_error(), glass.standard_error()));
}

TYPED_TEST(SubsurfaceTest, MovingBodyWalksInItsOwnFrame) {
    // Moving with everything else still, in an even environment: white stays white, and a coloured body has the mean of
    // the same body standing where it is at the only instant of the shutter.
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
    const auto moving = test::mean_radiance<TypeParam>(scene(true), {.samples = 1000});
    const auto still = test::mean_radiance<TypeParam>(scene(false), {.samples = 1000});
    // Both films have the same random numbers and, but for rounding, the same walks.
    EXPECT_NEAR(moving.channel[0].value(), still.channel[0].value(), 0.1 * still.channel[0].standard_error());
}

}  // namespace
}  // namespace pt
