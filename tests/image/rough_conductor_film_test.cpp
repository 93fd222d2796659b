// Rough conductors through whole renders: without roughness the mirror's film, bit for bit; in an even light what
// single scattering keeps, by quadrature.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/connections.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::RenderOptions;
using test::SceneBuilder;

template <class Real>
class RoughConductorImageTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RoughConductorImageTest, Reals);

// A lamp and four bodies of the material between diffuse walls.
template <class Material>
Scene room_with(const Material& material) {
    SceneBuilder builder;
    builder.camera({0.2, 0.1, -2.5}, {0, 0, 0}).image(24, 16, 70, true).depth(8);
    builder.room(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, {3, 2, 3});
    const std::uint32_t metal = material(builder);
    builder.sphere(metal, {-1, 0.5, 0.5}, 1.2);
    builder.box(metal, {1, -1.2, 0.5}, {1, 1.5, 1}, {0, 30, 0});
    builder.ellipsoid(metal, {1, 1, 1}, {0.8, 0.5, 0.6}, {10, 20, 30});
    builder.quad(metal, {-1, -1, 1}, 1, 1.5, {60, 20, 0});
    builder.sphere(builder.emitter({8, 6, 4}), {0.2, 1.2, -0.4}, 0.6);
    return builder.scene;
}

TYPED_TEST(RoughConductorImageTest, WithoutRoughnessItLeavesTheMirrorsFilm) {
    const Vec3d emission{0.5, 0.25, 0};
    for (const Vec3d& glow : {Vec3d(0.0), emission}) {
        const Scene mirror = room_with([&](auto& b) { return b.mirror(Vec3d(1.0), glow); });
        const Scene smooth = room_with([&](auto& b) { return b.rough_conductor(Vec3d(1.0), 0, glow); });
        const Scene rough = room_with([&](auto& b) { return b.rough_conductor(Vec3d(1.0), 0.5, glow); });
        for (const RenderOptions& options :
             {RenderOptions{.samples = 8}, RenderOptions{.samples = 8, .final_bounce = true},
              RenderOptions{.samples = 8, .next_event = true},
              RenderOptions{.samples = 8, .next_event = true, .mis_exponent = 2},
              RenderOptions{.samples = 8, .roulette_start = 2}}) {
            const auto sums = test::render<TypeParam>(mirror, options).sums();
            EXPECT_EQ(test::render<TypeParam>(smooth, options).sums(), sums);
            EXPECT_NE(test::render<TypeParam>(rough, options).sums(), sums);
        }
    }
}

// What a white surface keeps of an even light, seen straight on: a facet of slope m sends it to slope 2 m / (1 - m^2),
// and m^2 = alpha^2 u / (1 - u). Smith's masking of the way out is G2 = 1 / (1 + Lambda), that of the way in is 1.
double kept_straight_on(double alpha) {
    constexpr int steps = 1 << 20;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double u = (i + 0.5) / steps;
        const double slope_squared = alpha * alpha * u / (1 - u);
        if (slope_squared < 1) {
            const double tangent = 2 * std::sqrt(slope_squared) / (1 - slope_squared);
            sum += 2 / (1 + std::sqrt(1 + alpha * alpha * tangent * tangent));
        }
    }
    return sum / steps;
}

TYPED_TEST(RoughConductorImageTest, AnEvenLightIsKeptButForWhatScattersTwice) {
    for (const double roughness : {1e-4, 0.1, 0.3, 0.6, 1.0}) {
        SceneBuilder builder;
        builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
        builder.environment(0.5);
        builder.quad(builder.rough_conductor(Vec3d(1.0), roughness), {0, 0, 0}, 1, 1);
        const RenderOptions options{.samples = 1 << 18, .seed = 9};
        const test::Mean mean = test::mean_radiance<TypeParam>(builder.scene, options).channel[1];
        EXPECT_NEAR(mean.value(), 0.5 * kept_straight_on(roughness * roughness),
                    test::tolerated_errors * mean.standard_error() + 1e-6)
            << roughness;
    }
}

TYPED_TEST(RoughConductorImageTest, AnEvenLightIsKeptWhereLightScattersMultiply) {
    for (const double roughness : {0.3, 0.6, 1.0}) {
        SceneBuilder builder;
        builder.camera({0, 3, 1}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
        builder.environment(0.5);
        builder.quad(builder.rough_conductor(Vec3d(1.0), roughness, Vec3d(0.0), true), {0, 0, 0}, 1, 1);
        const RenderOptions options{.samples = 1 << 18, .seed = 9};
        const test::Mean mean = test::mean_radiance<TypeParam>(builder.scene, options).channel[1];
        // 2.5e-3: of kernels/ggx_gain.h.
        EXPECT_NEAR(mean.value() / 0.5, 1, test::tolerated_errors * mean.standard_error() / 0.5 + 2.5e-3) << roughness;
    }
}

// One bounce from a plate to a lamp beside the mirror's direction: connections bring what lobes meet, to a twentieth.
TYPED_TEST(RoughConductorImageTest, ConnectionsBringWhatLobesMeet) {
    for (const double roughness : {0.2, 0.3, 0.6, 1.0}) {
        SceneBuilder builder;
        builder.camera({-2, 2, 0}, {0, 0, 0}).image(1, 1, 5, true).depth(2);
        builder.quad(builder.rough_conductor({0.9, 0.6, 0.3}, roughness), {0, 0, 0}, 4, 4);
        builder.sphere(builder.emitter(Vec3d(1.0)), {2, 2 + roughness, 0.5}, 2.5);
        test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, roughness);
    }
}

}  // namespace
}  // namespace pt
