// precision=double of the CPU, through the program's own renders: it is the kernels in double, it has float's mean, and
// it is nearer to closed forms where rounding decides. (Each kernel function is held to long double in both precisions
// by the tests of its header.)
#include <cmath>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

// Lamp, mirror, glass and subsurface ball over a quad, lens, jitter and an environment; 24x16.
Scene mixed_scene() {
    SceneBuilder builder;
    builder.image(24, 16, 60, true).depth(6).environment(0.25);
    builder.scene.camera.aperture_radius = 0.125;
    builder.scene.camera.focus_distance = 4;
    const std::uint32_t white = builder.diffuse(Vec3d(0.75, 0.5, 0.25));
    builder.quad(builder.emitter(Vec3d(8, 6, 4)), {0, 2, 4}, 2, 2);
    builder.quad(white, {0, -1, 4}, 8, 8);
    builder.box(builder.mix(Vec3d(0.5), Vec3d(0.75), 0.5), {0, 0, 6}, {2, 2, 1}, {0, 30, 0});
    builder.sphere(builder.mirror(Vec3d(0.875)), {-1.5, -0.4, 4.5}, 1);
    builder.sphere(builder.dielectric(1.5, Vec3d(0.25, 0.5, 1)), {0, -0.4, 3.5}, 1);
    builder.ellipsoid(builder.subsurface(Vec3d(4, 5, 6), Vec3d(0.1), 0.5, 1.25), {1.5, -0.4, 4}, {1, 1.2, 0.8});
    return builder.scene;
}

RenderRequest request_for(const Scene& scene, const char* precision) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    request.variant.set("integrator", "depth_first");
    request.variant.set("specialisation", "generic");
    request.variant.set("precision", precision);
    request.settings = default_settings(scene);
    request.settings.depth = scene.max_depth;
    request.settings.seed = 1;
    return request;
}

TEST(DoublePrecisionTest, IsTheKernelsInDouble) {
    const Scene scene = mixed_scene();
    RenderRequest request = request_for(scene, "double");
    request.samples = 8;
    for (const bool final_bounce : {false, true}) {
        request.variant.set("direct_light", final_bounce ? "final_bounce" : "off");
        ASSERT_EQ(why_not_applicable(request.variant, features_of(scene)), "");
        const RenderResult result = render(scene, request);
        EXPECT_EQ(result.film.sums(), test::render<double>(scene, {.samples = 8, .final_bounce = final_bounce}).sums());
        EXPECT_TRUE(result.film.faults().none());
        EXPECT_EQ(result.work.paths, 24u * 16u * 8u);
    }
    request.variant.set("direct_light", "off");
    request.variant.set("precision", "float");
    EXPECT_EQ(render(scene, request).film.sums(), test::render<float>(scene, {.samples = 8}).sums());
}

TEST(DoublePrecisionTest, KeepsFirstHitsInDouble) {
    Scene scene = mixed_scene();
    RenderRequest request = request_for(scene, "double");
    request.samples = 12;
    request.variant.set("first_bounce", "cached_jitters");
    request.variant.tuning["jitters"] = 12;  // a ray a sample: nothing is shared
    const RenderResult filled = render(scene, request);
    EXPECT_EQ(filled.film.sums(), test::render<double>(scene, {.samples = 12}).sums());
    // With fewer rays the hits of later samples are kept ones, and a render in parts keeps them too.
    request.variant.tuning["jitters"] = 5;
    const RenderResult shared = render(scene, request);
    EXPECT_EQ(shared.work.cache_fills, 24u * 16u * 5u);
    EXPECT_NE(shared.film.sums(), filled.film.sums());
    request.checkpoints = {1, 2, 8, 12};
    std::vector<std::uint32_t> seen;
    request.on_checkpoint = [&](const Checkpoint& checkpoint) { seen.push_back(checkpoint.samples); };
    const RenderResult in_parts = render(scene, request);
    EXPECT_EQ(in_parts.film.sums(), shared.film.sums());
    EXPECT_EQ(in_parts.work.cache_fills, shared.work.cache_fills);
    EXPECT_EQ(seen, request.checkpoints);
    // Without a lens, jitter or motion the plain cache changes no bit.
    scene.camera.jitter = false;
    scene.camera.aperture_radius = 0;
    request = request_for(scene, "double");
    request.samples = 3;
    const RenderResult uncached = render(scene, request);
    request.variant.set("first_bounce", "cached");
    EXPECT_EQ(render(scene, request).film.sums(), uncached.film.sums());
}

struct Difference {
    test::Mean channel[3];
};

// Differences of image means over batches, double less float; float's seeds are so many further.
Difference difference(const Scene& scene, std::uint64_t float_seeds_from) {
    RenderRequest narrow = request_for(scene, "float"), wide = request_for(scene, "double");
    narrow.samples = wide.samples = 16;
    Difference difference;
    for (std::uint64_t batch = 1; batch <= 24; ++batch) {
        wide.settings.seed = batch;
        narrow.settings.seed = float_seeds_from + batch;
        const Vec3d a = render(scene, wide).film.mean(), b = render(scene, narrow).film.mean();
        for (int i = 0; i < 3; ++i) {
            difference.channel[i].add(a[i] - b[i]);
        }
    }
    return difference;
}

TEST(DoublePrecisionTest, HasTheMeanOfSinglePrecision) {
    const Scene scene = mixed_scene();
    const Difference independent = difference(scene, 1000), paired = difference(scene, 0);
    for (int i = 0; i < 3; ++i) {
        const test::Mean& apart = independent.channel[i];
        EXPECT_LT(std::abs(apart.value()), test::tolerated_errors * apart.standard_error());
        EXPECT_GT(apart.standard_error(), 0);
        // The same numbers take nearly every path the same way; what is left is rounding and a few that part.
        const test::Mean& together = paired.channel[i];
        EXPECT_LT(std::abs(together.value()), test::tolerated_errors * together.standard_error() + 1e-6);
        EXPECT_LT(together.standard_error(), 0.3 * apart.standard_error());
    }
}

// Largest error of a pixel, relative to its exact value.
template <class Exact>
double worst_error(const Scene& scene, const char* precision, const Exact& exact) {
    const Film film = render(scene, request_for(scene, precision)).film;
    double worst = 0;
    for (std::uint32_t pixel = 0; pixel < film.width() * film.height(); ++pixel) {
        const double value = exact(pixel % film.width(), pixel / film.width());
        worst = std::max(worst, std::abs(film.pixel(pixel).x / value - 1));
    }
    return worst;
}

// A ball that absorbs, 10^5 radii away: e^-(2 sigma sqrt(1 - b^2)) at distance b from its axis. Where the ball is, and
// so b, is rounded to 10^5 units of the last place of 1.
TEST(DoublePrecisionTest, SeesAFarBallSharply) {
    constexpr std::uint32_t side = 16;
    constexpr double distance = 1e5, half = 0.6;  // all of the image is within the ball
    SceneBuilder builder;
    builder.camera({0, 0, -distance}, {0, 0, 0})
        .image(side, side, 2 * std::atan(half / distance) * 180 / pi<double>, false)
        .depth(3)
        .environment(1);
    builder.sphere(builder.dielectric(1, Vec3d(0.5)), {0, 0, 0}, 2);
    const auto exact = [&](std::uint32_t x, std::uint32_t y) {
        const auto offset = [&](std::uint32_t i) { return half * (2 * (i + 0.5) / side - 1); };
        const double tangent = std::hypot(offset(x), offset(y)) / distance;
        const double b = distance * tangent / std::sqrt(1 + tangent * tangent);
        return std::exp(-0.5 * 2 * std::sqrt(1 - b * b));
    };
    const double in_float = worst_error(builder.scene, "float", exact);
    const double in_double = worst_error(builder.scene, "double", exact);
    EXPECT_LT(in_double, 1e-10);
    EXPECT_GT(in_float, 1e-5);
}

// In a closed cavity each segment adds a term of 1 - rho^n, whose products and sums round once each.
TEST(DoublePrecisionTest, SumsALongSeriesSharply) {
    SceneBuilder builder;
    constexpr double rho = 0.999;
    constexpr std::uint32_t depth = 1000;
    builder.image(4, 4, 90, true).depth(depth);
    builder.ellipsoid(builder.diffuse(Vec3d(rho), Vec3d(1 - rho)), {0, 0, 0}, {2, 3, 4}, {10, 20, 30});
    const auto exact = [&](std::uint32_t, std::uint32_t) { return -std::expm1(depth * std::log(rho)); };
    const double in_float = worst_error(builder.scene, "float", exact);
    const double in_double = worst_error(builder.scene, "double", exact);
    EXPECT_LT(in_double, 1e-11);
    EXPECT_GT(in_float, 1e-8);
}

}  // namespace
}  // namespace pt
