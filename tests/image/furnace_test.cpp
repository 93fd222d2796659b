// Closed rooms that shine evenly: every path returns the same number, so every pixel must be the same float and equal
// to the geometric series. E sum rho^k over the segments 1..D. (numerics.md S1 to S3, S5, S39)
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::RenderOptions;
using test::SceneBuilder;

template <class Real>
class FurnaceTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(FurnaceTest, Reals);

// D segments: E (1 - rho^D) / (1 - rho), in long double.
long double furnace(long double rho, long double emission, std::uint32_t depth) {
    return rho == 1 ? emission * depth : emission * -expm1l(depth * logl(rho)) / (1 - rho);
}

enum class Cavity { sphere, ellipsoid, box, oriented_box, quads };

Scene cavity_scene(Cavity cavity, const std::function<std::uint32_t(SceneBuilder&)>& wall, std::uint32_t depth,
                   std::uint32_t side = 8) {
    SceneBuilder builder;
    const std::uint32_t material = wall(builder);
    builder.camera({0.25, 0.125, -0.5}, {0.3, -0.2, 1}).image(side, side, 120, true).depth(depth);
    switch (cavity) {
        case Cavity::sphere:
            builder.sphere(material, {0, 0, 0}, 2);
            break;
        case Cavity::ellipsoid:
            builder.ellipsoid(material, {0, 0, 0}, {2, 3, 4}, {10, 20, 30});
            break;
        case Cavity::box:
            builder.box(material, {0, 0, 0}, {2, 3, 4});
            break;
        case Cavity::oriented_box:
            builder.box(material, {0, 0, 0}, {2, 3, 4}, {10, 20, 30});
            break;
        case Cavity::quads:
            builder.room(material, {0, 0, 0}, {1, 1.5, 2});
            break;
    }
    return builder.scene;
}

constexpr Cavity all_cavities[] = {Cavity::sphere, Cavity::ellipsoid, Cavity::box, Cavity::oriented_box, Cavity::quads};

void expect_every_pixel(const Film& film, double exact, double relative_tolerance) {
    EXPECT_EQ(film.faults().nonfinite, 0u);
    EXPECT_EQ(film.faults().saturated, 0u);
    for (std::size_t i = 0; i < film.sums().size(); ++i) {
        ASSERT_EQ(film.sums()[i], film.sums()[0]) << "pixel " << i / 3 << " channel " << i % 3;
    }
    EXPECT_NEAR(film.pixel(0).x, exact, relative_tolerance * exact);
}

TYPED_TEST(FurnaceTest, DiffuseCavitySumsTheSeries) {
    for (const Cavity cavity : all_cavities) {
        for (const int k : {1, 3, 10}) {
            const double emission = std::ldexp(1.0, -k), rho = 1 - emission;
            for (const std::uint32_t depth : {1u, 2u, 9u, 1024u}) {
                // The long walk only once: 64 pixels are 65000 segments.
                const Scene scene = cavity_scene(
                    cavity, [&](auto& b) { return b.diffuse(Vec3d(rho), Vec3d(emission)); }, depth, depth > 9 ? 4 : 8);
                const double exact = static_cast<double>(furnace(rho, emission, depth));
                // Rounding of D products and sums: numerics.md S1 allows 1e-6 up to depth 1024. In double the film's
                // quantum, 2^-40 of the bound, is the coarser one.
                expect_every_pixel(test::render<TypeParam>(scene, {.samples = 2}), exact,
                                   sizeof(TypeParam) == 4 ? 1e-6 : 2e-12);
            }
        }
    }
}

TYPED_TEST(FurnaceTest, ShallowSeriesOfAHalfIsExact) {
    // rho = E = 1/2, nine segments: .998046875 has nine bits, so nothing may round.
    for (const Cavity cavity : all_cavities) {
        const Scene scene = cavity_scene(
            cavity, [](auto& b) { return b.diffuse(Vec3d(0.5), Vec3d(0.5)); }, 9);
        expect_every_pixel(test::render<TypeParam>(scene, {.samples = 2}), 0.998046875, 0);
    }
}

TYPED_TEST(FurnaceTest, AHundredThousandBouncesKeepTheSeries) {
    const double emission = 0x1p-17;
    const Scene scene = cavity_scene(
        Cavity::sphere, [&](auto& b) { return b.diffuse(Vec3d(1 - emission), Vec3d(emission)); }, 131072, 2);
    // 1 - (1 - 2^-17)^131072; numerics.md prints ...1961782, its ninth digit is off.
    const double exact = static_cast<double>(furnace(1 - 0x1p-17L, 0x1p-17L, 131072));
    EXPECT_NEAR(exact, 0.6321219621817137, 1e-14);
    expect_every_pixel(test::render<TypeParam>(scene, {}), exact, sizeof(TypeParam) == 4 ? 1e-5 : 1e-11);
}

TYPED_TEST(FurnaceTest, ColoursAreSummedApart) {
    const Scene scene = cavity_scene(
        Cavity::box,
        [](auto& b) {
            return b.diffuse({0.5, 0.25, 0}, {0.5, 1, 2});
        },
        4);
    const Film film = test::render<TypeParam>(scene, {.samples = 2});
    for (std::uint32_t i = 0; i < 64; ++i) {
        EXPECT_EQ(film.pixel(i), Vec3d(0.5 * 1.875, 1.328125, 2));
    }
}

TYPED_TEST(FurnaceTest, MirrorAndMixSumTheSameSeries) {
    const double rho = 0.875, emission = 0.125;
    for (const Cavity cavity : all_cavities) {
        const double exact = static_cast<double>(furnace(rho, emission, 32));
        const auto check = [&](const std::function<std::uint32_t(SceneBuilder&)>& wall) {
            expect_every_pixel(test::render<TypeParam>(cavity_scene(cavity, wall, 32), {.samples = 2}), exact, 1e-6);
        };
        check([&](auto& b) { return b.mirror(Vec3d(rho), Vec3d(emission)); });
        for (const double p : {0.0, 0x1p-20, 0.5, 1.0}) {
            check([&](auto& b) { return b.mix(Vec3d(rho), Vec3d(rho), p, Vec3d(emission)); });
        }
    }
}

TYPED_TEST(FurnaceTest, LossyFilmOfABlackOrNearlyBlackWallIsItsEmission) {
    // numerics.md S39. 1e-40 is a denormal in float.
    for (const double rho : {0.0, 1e-30, 1e-38, 1e-40}) {
        const Scene scene = cavity_scene(
            Cavity::sphere, [&](auto& b) { return b.diffuse(Vec3d(rho), Vec3d(0.75)); }, 8);
        expect_every_pixel(test::render<TypeParam>(scene, {}), 0.75, 0);
    }
}

TYPED_TEST(FurnaceTest, ObjectsOfTheSameMaterialDisappear) {
    // The cavity's own material on bodies inside it: they must not be visible at all.
    const double rho = 0.5, emission = 0.5;
    SceneBuilder builder;
    const std::uint32_t wall = builder.diffuse(Vec3d(rho), Vec3d(emission));
    builder.camera({0, 0, -1.5}, {0, 0, 1}).image(16, 16, 100, true).depth(9);
    builder.room(wall, {0, 0, 0}, Vec3d(2.0));
    builder.sphere(wall, {0.5, 0.5, 0}, 0.8);
    builder.ellipsoid(wall, {-0.5, 0.5, 0.5}, {0.5, 1, 0.7}, {10, 20, 30});
    builder.box(wall, {-0.6, -1.5, 0}, Vec3d(1.0));  // stands on the floor
    builder.box(wall, {0.7, -0.8, 0.2}, Vec3d(0.6), {0, 30, 20});
    builder.quad(wall, {0, 0, 1}, 1, 1, {80, 10, 0});
    expect_every_pixel(test::render<TypeParam>(builder.scene, {.samples = 8}), 0.998046875, 0);
}

// Only a mirror shows the other lobe's colour, and only by the draw: p = 0 and p = 1 are the pure materials bit for
// bit.
Scene mix_scene(const std::function<std::uint32_t(SceneBuilder&)>& material) {
    SceneBuilder builder;
    builder.camera({0, 1, -4}, {0, 0.5, 0}).image(24, 16, 60, true).depth(6).environment(0.25);
    const std::uint32_t ball = material(builder);
    builder.sphere(ball, {0, 0.5, 0}, 1);
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, 8, 8);
    builder.box(builder.emitter(Vec3d(4.0)), {1, 2, -1}, {1, 0.1, 1});
    return builder.scene;
}

TYPED_TEST(FurnaceTest, MixAtItsEndsIsThePureMaterialBitForBit) {
    const Vec3d albedo(0.75, 0.5, 0.125), reflectance(0.25, 0.875, 0.5), glow(0.125);
    for (const bool final_bounce : {false, true}) {
        const RenderOptions options{.samples = 8, .final_bounce = final_bounce};
        const auto sums = [&](const std::function<std::uint32_t(SceneBuilder&)>& material) {
            return test::render<TypeParam>(mix_scene(material), options).sums();
        };
        const auto diffuse = sums([&](auto& b) { return b.diffuse(albedo, glow); });
        const auto mirror = sums([&](auto& b) { return b.mirror(reflectance, glow); });
        EXPECT_EQ(sums([&](auto& b) { return b.mix(albedo, reflectance, 0, glow); }), diffuse);
        EXPECT_EQ(sums([&](auto& b) { return b.mix(albedo, reflectance, 1, glow); }), mirror);
        EXPECT_NE(sums([&](auto& b) { return b.mix(albedo, reflectance, 0.5, glow); }), diffuse);
        EXPECT_NE(diffuse, mirror);
    }
}

// numerics.md S5: a lamp of radius a in a diffuse sphere of radius 1. Wall radiance after d scatterings:
// sum over j = 1..d of rho^j (1-s)^(j-1) s, s = a^2.
double concentric_lamp(double rho, double a, std::uint32_t scatterings) {
    const double s = a * a;
    double sum = 0;
    for (std::uint32_t j = 1; j <= scatterings; ++j) {
        sum += std::pow(rho, j) * std::pow(1 - s, j - 1) * s;
    }
    return sum;
}

Scene lamp_scene(double rho, double a) {
    SceneBuilder builder;
    builder.camera({0, 0, 0.75}, {0, 0.25, 1});  // one pixel of wall, the lamp behind the camera
    builder.sphere(builder.diffuse(Vec3d(rho)), {0, 0, 0}, 2);
    builder.sphere(builder.emitter(Vec3d(1.0)), {0, 0, 0}, 2 * a);
    return builder.scene;
}

TYPED_TEST(FurnaceTest, ConcentricLampLightsTheWallAtEveryDepth) {
    EXPECT_NEAR(concentric_lamp(0.5, 0.1, 200), 0.00990099, 1e-8);  // the page's limits
    EXPECT_NEAR(concentric_lamp(0.9, 0.1, 2000), 0.0825688, 1e-7);
    for (const double a : {0.1, 0.3}) {
        const Scene scene = lamp_scene(0.875, a);
        for (const std::uint32_t depth : {1u, 2u, 3u, 5u, 8u}) {
            // Plain: depth D has D - 1 scatterings. With a final bounce, D.
            const auto plain = test::mean_radiance<TypeParam>(scene, {.samples = 100000, .depth = depth}).channel[0];
            const auto connected =
                test::mean_radiance<TypeParam>(scene, {.samples = 20000, .depth = depth, .final_bounce = true})
                    .channel[0];
            EXPECT_NEAR(plain.value(), concentric_lamp(0.875, a, depth - 1),
                        test::tolerated_errors * plain.standard_error());
            EXPECT_NEAR(connected.value(), concentric_lamp(0.875, a, depth),
                        test::tolerated_errors * connected.standard_error() + 1e-6)
                << "a " << a << " depth " << depth;
        }
    }
}

TEST(FurnaceTest, EveryVariantIntegratorKeepsTheSeries) {
    const Scene scene = cavity_scene(
        Cavity::quads, [](auto& b) { return b.diffuse(Vec3d(0.5), Vec3d(0.5)); }, 9);
    for (const char* integrator : {"depth_first", "packet", "wavefront"}) {
        expect_every_pixel(test::render_variant(scene, {.samples = 4}, "integrator", integrator), 0.998046875, 0);
    }
    // The tests' own loop is the program's.
    const Scene mixed = mix_scene([](auto& b) { return b.mix(Vec3d(0.75), Vec3d(0.5), 0.5); });
    EXPECT_EQ(test::render<float>(mixed, {.samples = 4}).sums(), test::render_variant(mixed, {.samples = 4}).sums());
}

}  // namespace
}  // namespace pt
