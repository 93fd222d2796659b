// Rough glass through whole renders: without roughness the smooth one's film, bit for bit; with index 1 none at all; in
// an even light what its facets reflect, by quadrature.
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
class RoughDielectricImageTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RoughDielectricImageTest, Reals);

constexpr Vec3d absorbing{0.2, 0.5, 1}, tint{1, 0.875, 0.75};

// A lamp, a lamp in a body, and four bodies of the material between diffuse walls.
template <class Material>
Scene room_with(const Material& material) {
    SceneBuilder builder;
    builder.camera({0.2, 0.1, -2.5}, {0, 0, 0}).image(24, 16, 70, true).depth(10);
    builder.room(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, {3, 2, 3});
    const std::uint32_t glass = material(builder);
    builder.sphere(glass, {-1, 0.5, 0.5}, 1.2);
    builder.box(glass, {1, -1.2, 0.5}, {1, 1.5, 1}, {0, 30, 0});
    builder.box(glass, {-0.5, -1.2, 1}, {0.5, 1, 1});
    builder.ellipsoid(glass, {1, 1, 1}, {0.8, 0.5, 0.6}, {10, 20, 30});
    builder.sphere(builder.emitter({8, 6, 4}), {0.2, 1.2, -0.4}, 0.6);
    builder.sphere(builder.emitter({4, 6, 8}), {-1, 0.5, 0.5}, 0.3);
    return builder.scene;
}

const RenderOptions estimators[] = {{.samples = 8},
                                    {.samples = 8, .final_bounce = true},
                                    {.samples = 8, .next_event = true},
                                    {.samples = 8, .next_event = true, .mis_exponent = 2},
                                    {.samples = 8, .roulette_start = 2}};

TYPED_TEST(RoughDielectricImageTest, WithoutRoughnessItLeavesTheSmoothOnesFilm) {
    const Scene smooth = room_with([](auto& b) { return b.dielectric(1.5, absorbing, tint); });
    const Scene none = room_with([](auto& b) { return b.rough_dielectric(1.5, 0, absorbing, tint); });
    const Scene rough = room_with([](auto& b) { return b.rough_dielectric(1.5, 0.5, absorbing, tint); });
    for (const RenderOptions& options : estimators) {
        const auto sums = test::render<TypeParam>(smooth, options).sums();
        EXPECT_EQ(test::render<TypeParam>(none, options).sums(), sums);
        EXPECT_NE(test::render<TypeParam>(rough, options).sums(), sums);
    }
}

TYPED_TEST(RoughDielectricImageTest, BetweenEqualIndicesItIsSmooth) {
    const Scene smooth = room_with([](auto& b) { return b.dielectric(1, absorbing); });
    const Scene rough = room_with([](auto& b) { return b.rough_dielectric(1, 0.7, absorbing); });
    for (const RenderOptions& options : estimators) {
        EXPECT_EQ(test::render<TypeParam>(rough, options).sums(), test::render<TypeParam>(smooth, options).sums());
    }
}

double reflectance(double n, double cosine) {
    const double sine = std::sqrt(1 - cosine * cosine) / n;
    const double beyond = std::sqrt(1 - sine * sine);
    const double s = (cosine - n * beyond) / (cosine + n * beyond);
    const double p = (n * cosine - beyond) / (n * cosine + beyond);
    return (s * s + p * p) / 2;
}

// What is reflected of an even light, seen straight on: a facet of slope m sends it to slope 2 m / (1 - m^2), and
// m^2 = alpha^2 u / (1 - u). Smith's masking of the way out is G2 = 1 / (1 + Lambda), that of the way in is 1.
double reflected_straight_on(double n, double alpha) {
    constexpr int steps = 1 << 20;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double u = (i + 0.5) / steps;
        const double slope_squared = alpha * alpha * u / (1 - u);
        if (slope_squared < 1) {
            const double tangent = 2 * std::sqrt(slope_squared) / (1 - slope_squared);
            const double kept = 2 / (1 + std::sqrt(1 + alpha * alpha * tangent * tangent));
            sum += kept * reflectance(n, 1 / std::sqrt(1 + slope_squared));
        }
    }
    return sum / steps;
}

// Paths have two segments, so what is refracted ends within.
TYPED_TEST(RoughDielectricImageTest, AnEvenLightIsReflectedByFacets) {
    for (const double ior : {1.5, 3.0}) {
        for (const double roughness : {1e-4, 0.3, 0.6, 1.0}) {
            SceneBuilder builder;
            builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
            builder.environment(0.5);
            builder.box(builder.rough_dielectric(ior, roughness), {0, 0, 0}, Vec3d(1.0));
            const RenderOptions options{.samples = 1 << 18, .seed = 9};
            const test::Mean mean = test::mean_radiance<TypeParam>(builder.scene, options).channel[1];
            EXPECT_NEAR(mean.value(), 0.5 * reflected_straight_on(ior, roughness * roughness),
                        test::tolerated_errors * mean.standard_error() + 1e-6)
                << ior << " " << roughness;
        }
    }
}

// What passes into the glass and meets a lamp there: connections bring what lobes meet, to a twentieth.
TYPED_TEST(RoughDielectricImageTest, ConnectionsThroughTheSurfaceBringWhatLobesMeet) {
    for (const double roughness : {0.4, 0.6, 1.0}) {
        SceneBuilder builder;
        builder.camera({-2, 3, 0}, {0, 1, 0}).image(1, 1, 5, true).depth(2);
        builder.box(builder.rough_dielectric(1.5, roughness, absorbing, tint), {0, 0, 0}, {4, 2, 4});
        builder.sphere(builder.emitter(Vec3d(1.0)), {1, -0.2, 0.3}, 1.4);
        test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, roughness);
    }
}

}  // namespace
}  // namespace pt
