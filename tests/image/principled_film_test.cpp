// Principled surfaces through whole renders: all metal, all glass and of index 1 they leave the films of other
// materials, bit for bit; an even light is kept as quadrature has it; connections bring what lobes meet.
#include <algorithm>
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
class PrincipledImageTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(PrincipledImageTest, Reals);

constexpr Vec3d colour{1, 0.75, 0.5};

// A lamp, a lamp in a body, and four bodies of the material between diffuse walls.
template <class Material>
Scene room_with(const Material& material) {
    SceneBuilder builder;
    builder.camera({0.2, 0.1, -2.5}, {0, 0, 0}).image(24, 16, 70, true).depth(10);
    builder.room(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, {3, 2, 3});
    const std::uint32_t body = material(builder);
    builder.sphere(body, {-1, 0.5, 0.5}, 1.2);
    builder.box(body, {1, -1.2, 0.5}, {1, 1.5, 1}, {0, 30, 0});
    builder.box(body, {-0.5, -1.2, 1}, {0.5, 1, 1});
    builder.ellipsoid(body, {1, 1, 1}, {0.8, 0.5, 0.6}, {10, 20, 30});
    builder.sphere(builder.emitter({8, 6, 4}), {0.2, 1.2, -0.4}, 0.6);
    builder.sphere(builder.emitter({4, 6, 8}), {-1, 0.5, 0.5}, 0.3);
    return builder.scene;
}

const RenderOptions estimators[] = {{.samples = 8},
                                    {.samples = 8, .next_event = true},
                                    {.samples = 8, .next_event = true, .mis_exponent = 2},
                                    {.samples = 8, .next_event = true, .mis_exponent = 2, .one_sample = true},
                                    {.samples = 8, .roulette_start = 2},
                                    {.samples = 8, .final_bounce = true}};

template <class Real>
void expect_same_films(const Scene& scene, const Scene& other, std::size_t options) {
    for (std::size_t i = 0; i < options; ++i) {
        EXPECT_EQ(test::render<Real>(scene, estimators[i]).hash(), test::render<Real>(other, estimators[i]).hash())
            << "estimator " << i;
    }
}

TYPED_TEST(PrincipledImageTest, AllMetalItLeavesTheFilmOfARoughConductor) {
    for (const double roughness : {0.0, 0.05, 0.4, 1.0}) {
        const Scene metal = room_with([&](auto& b) { return b.rough_conductor(colour, roughness); });
        const Scene same = room_with([&](auto& b) { return b.principled(colour, 1, roughness, 0.5, 2); });
        const Scene part = room_with([&](auto& b) { return b.principled(colour, 0.75, roughness); });
        expect_same_films<TypeParam>(same, metal, std::size(estimators));
        EXPECT_NE(test::render<TypeParam>(part, estimators[0]).hash(),
                  test::render<TypeParam>(metal, estimators[0]).hash());
    }
}

TYPED_TEST(PrincipledImageTest, AllGlassItLeavesTheFilmOfARoughDielectric) {
    for (const double roughness : {0.0, 0.05, 0.4, 1.0}) {
        const Scene glass = room_with([&](auto& b) { return b.rough_dielectric(1.5, roughness, Vec3d(0.0), colour); });
        const Scene same = room_with([&](auto& b) { return b.principled(colour, 0, roughness, 1); });
        const Scene part = room_with([&](auto& b) { return b.principled(colour, 0, roughness, 0.75); });
        expect_same_films<TypeParam>(same, glass, std::size(estimators));
        EXPECT_NE(test::render<TypeParam>(part, estimators[0]).hash(),
                  test::render<TypeParam>(glass, estimators[0]).hash());
    }
}

// But for the last vertex of a final-bounce path, which goes on from a principled surface.
TYPED_TEST(PrincipledImageTest, OfIndexOneItLeavesTheFilmOfADiffuseSurface) {
    const Scene diffuse = room_with([](auto& b) { return b.diffuse(colour); });
    for (const double roughness : {0.0, 0.4, 1.0}) {
        const Scene same = room_with([&](auto& b) { return b.principled(colour, 0, roughness, 0, 1); });
        expect_same_films<TypeParam>(same, diffuse, std::size(estimators) - 1);
    }
}

TYPED_TEST(PrincipledImageTest, EmissionIsMetAndConnected) {
    const Vec3d glow{0.5, 0.25, 0};
    const Scene metal = room_with([&](auto& b) { return b.rough_conductor(colour, 0.3, glow); });
    const Scene same = room_with([&](auto& b) { return b.principled(colour, 1, 0.3, 0, 1.5, glow); });
    expect_same_films<TypeParam>(same, metal, std::size(estimators));
}

double reflectance(double n, double cosine) {
    const double sine = std::sqrt(1 - cosine * cosine) / n;
    const double beyond = std::sqrt(1 - sine * sine);
    const double s = (cosine - n * beyond) / (cosine + n * beyond);
    const double p = (n * cosine - beyond) / (n * cosine + beyond);
    return (s * s + p * p) / 2;
}

// What a white one keeps of an even light, seen straight on. A facet of slope m sends it to slope 2 m / (1 - m^2), and
// m^2 = alpha^2 u / (1 - u); Smith's masking of the way out is G2 = 1 / (1 + Lambda), that of the way in is 1. The
// diffuse surface keeps 1 - max(F(1), F(l)), and F grows from F(1) on.
double kept_straight_on(double metallic, double alpha) {
    constexpr int steps = 1 << 20;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double u = (i + 0.5) / steps;
        const double slope_squared = alpha * alpha * u / (1 - u);
        if (slope_squared < 1) {
            const double tangent = 2 * std::sqrt(slope_squared) / (1 - slope_squared);
            const double kept = 2 / (1 + std::sqrt(1 + alpha * alpha * tangent * tangent));
            sum += kept * (metallic + (1 - metallic) * reflectance(1.5, 1 / std::sqrt(1 + slope_squared)));
        }
        sum += (1 - metallic) * (1 - std::max(0.04, reflectance(1.5, std::sqrt(u))));
    }
    return sum / steps;
}

TYPED_TEST(PrincipledImageTest, AnEvenLightIsKeptAsQuadratureHasIt) {
    for (const double metallic : {0.0, 0.3}) {
        for (const double roughness : {1e-4, 0.3, 0.6, 1.0}) {
            SceneBuilder builder;
            builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
            builder.environment(0.5);
            builder.quad(builder.principled(Vec3d(1.0), metallic, roughness), {0, 0, 0}, 1, 1);
            const RenderOptions options{.samples = 1 << 18, .seed = 9};
            const test::Mean mean = test::mean_radiance<TypeParam>(builder.scene, options).channel[1];
            EXPECT_NEAR(mean.value(), 0.5 * kept_straight_on(metallic, roughness * roughness),
                        test::tolerated_errors * mean.standard_error() + 1e-6)
                << metallic << " " << roughness;
        }
    }
}

// Both sides of a sheet are the outside: no light comes from within.
TYPED_TEST(PrincipledImageTest, BothSidesOfASheetAreAlike) {
    const auto seen_from = [](double height) {
        SceneBuilder builder;
        builder.camera({0, height, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
        builder.environment(0.5);
        builder.quad(builder.principled(Vec3d(1.0), 0, 0.4), {0, 0, 0}, 1, 1);
        return test::mean_radiance<TypeParam>(builder.scene, {.samples = 1 << 16, .seed = 9}).channel[1];
    };
    const test::Mean above = seen_from(3), below = seen_from(-3);
    EXPECT_NEAR(above.value(), below.value(),
                test::tolerated_errors * std::hypot(above.standard_error(), below.standard_error()));
}

// One bounce from a plate to a lamp beside the mirror's direction: connections bring what lobes meet, to a twentieth.
TYPED_TEST(PrincipledImageTest, ConnectionsBringWhatLobesMeet) {
    for (const double metallic : {0.0, 0.4}) {
        for (const double roughness : {0.02, 0.2, 0.3, 0.6, 1.0}) {
            SceneBuilder builder;
            builder.camera({-2, 2, 0}, {0, 0, 0}).image(1, 1, 5, true).depth(2);
            builder.quad(builder.principled({0.9, 0.6, 0.3}, metallic, roughness), {0, 0, 0}, 4, 4);
            builder.sphere(builder.emitter(Vec3d(1.0)), {2, 2 + roughness, 0.5}, 2.5);
            test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, roughness);
        }
    }
}

// What passes into part glass and meets a lamp there.
TYPED_TEST(PrincipledImageTest, ConnectionsThroughTheSurfaceBringWhatLobesMeet) {
    for (const double roughness : {0.6, 1.0}) {
        SceneBuilder builder;
        builder.camera({-2, 3, 0}, {0, 1, 0}).image(1, 1, 5, true).depth(2);
        builder.box(builder.principled(colour, 0.25, roughness, 0.75), {0, 0, 0}, {4, 2, 4});
        builder.sphere(builder.emitter(Vec3d(1.0)), {1, -0.2, 0.3}, 1.4);
        test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, roughness);
    }
}

}  // namespace
}  // namespace pt
