// first_bounce=cached_jitters on the CPU: sample s has the camera ray of sample s mod K, and its own random numbers
// from there on.
#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/render/renderer.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

// ---- Scenes: a kind of camera ray that varies from sample to sample, each ----

SceneBuilder balls() {
    SceneBuilder builder;
    builder.image(20, 14, 60, false).depth(5).environment(0.3);
    builder.quad(builder.diffuse({0.7, 0.6, 0.5}), {0, -1, 4}, 9, 9);
    builder.sphere(builder.diffuse({0.4, 0.5, 0.6}, {0.2, 0.1, 0}), {0.5, -0.3, 3}, 1);
    builder.sphere(builder.dielectric(1.5, {0.1, 0.3, 0.5}), {-0.8, -0.4, 3}, 1);
    builder.box(builder.mirror({0.9, 0.8, 0.7}), {0, 0.9, 5}, {1, 0.5, 1}, {10, 20, 30});
    builder.quad(builder.emitter({3, 4, 5}), {0, 3, 3}, 1, 1, {180, 0, 0});
    return builder;
}

Scene with_jitter() {
    SceneBuilder builder = balls();
    builder.scene.camera.jitter = true;
    return builder.scene;
}

Scene with_a_lens() {
    SceneBuilder builder = balls();
    builder.scene.camera.aperture_radius = 0.3;
    builder.scene.camera.focus_distance = 3;
    return builder.scene;
}

Scene with_motion() {
    SceneBuilder builder = balls();
    builder.scene.camera.shutter_close = 1;
    builder.sphere(builder.diffuse({0.4, 0.9, 0.6}), {0, 0.5, 2.5}, 0.8).velocity = {0.7, 0.4, 0};
    return builder.scene;
}

class CachedJittersTest : public testing::TestWithParam<std::pair<const char*, Scene (*)()>> {
protected:
    Scene scene = GetParam().second();
};

// ---- Renders ----

struct Part {
    std::uint32_t first = 0, samples = 1, film_samples = 0, depth = 0;
};

// Renders some samples of a scene with a cache of `rays` camera rays a pixel; 0: with first_bounce=off.
RenderResult render_part(const Scene& scene, std::uint32_t rays, const Part& part,
                         const std::string& integrator = "depth_first") {
    Variant variant = Registry::instance().baseline();
    variant.set("integrator", integrator);
    if (rays > 0) {
        variant.set("first_bounce", "cached_jitters");
        variant.tuning["jitters"] = rays;
    }
    EXPECT_EQ(why_not_applicable(variant, features_of(scene)), "");
    RenderSettings settings = default_settings(scene);
    settings.seed = 3;
    settings.depth = part.depth != 0 ? part.depth : scene.max_depth;
    return render(scene, {.variant = variant,
                          .settings = settings,
                          .first_sample = part.first,
                          .samples = part.samples,
                          .film_samples = part.film_samples});
}

std::vector<std::int64_t> sums(const Scene& scene, std::uint32_t rays, const Part& part,
                               const std::string& integrator = "depth_first") {
    return render_part(scene, rays, part, integrator).film.sums();
}

constexpr std::uint32_t pixels = 20 * 14;

TEST_P(CachedJittersTest, WithARayASampleTheFilmIsThatOfNoCache) {
    constexpr std::uint32_t spp = 5;
    for (const char* integrator : {"wavefront", "depth_first"}) {
        const RenderResult plain = render_part(scene, 0, {.samples = spp}, integrator);
        for (const std::uint32_t rays : {5u, 6u, 16u, 4096u}) {
            const RenderResult kept = render_part(scene, rays, {.samples = spp}, integrator);
            EXPECT_EQ(kept.film.sums(), plain.film.sums()) << integrator << ", " << rays << " rays";
            EXPECT_EQ(kept.work.cache_fills, pixels * spp);
            EXPECT_EQ(kept.work.cache_hits, 0u);
            EXPECT_EQ(kept.work.rays, plain.work.rays);
        }
        EXPECT_NE(sums(scene, 4, {.samples = spp}, integrator), plain.film.sums());
    }
}

// At depth 1 a sample is its camera ray and nothing else.
TEST_P(CachedJittersTest, SampleSHasTheCameraRayOfSModK) {
    std::vector<std::vector<std::int64_t>> plain;
    for (std::uint32_t sample = 0; sample < 8; ++sample) {
        plain.push_back(sums(scene, 0, {.first = sample, .film_samples = 8, .depth = 1}));
    }
    ASSERT_NE(plain[0], plain[1]);  // the rays differ from sample to sample
    for (const char* integrator : {"wavefront", "depth_first"}) {
        for (const std::uint32_t rays : {1u, 2u, 3u, 7u}) {
            for (std::uint32_t sample = 0; sample < 8; ++sample) {
                EXPECT_EQ(sums(scene, rays, {.first = sample, .film_samples = 8, .depth = 1}, integrator),
                          plain[sample % rays])
                    << integrator << ", " << rays << " rays, sample " << sample;
            }
        }
        // Two rays for eight samples: four times the film of the first two.
        std::vector<std::int64_t> expected = plain[0];
        for (std::size_t i = 0; i < expected.size(); ++i) {
            expected[i] = 4 * (plain[0][i] + plain[1][i]);
        }
        EXPECT_EQ(sums(scene, 2, {.samples = 8, .depth = 1}, integrator), expected) << integrator;
    }
}

TEST_P(CachedJittersTest, ASampleHasItsOwnRandomNumbersBehindItsCameraRay) {
    const auto sample = [&](std::uint32_t number) { return sums(scene, 2, {.first = number, .film_samples = 8}); };
    EXPECT_EQ(sample(0), sums(scene, 0, {.first = 0, .film_samples = 8}));
    EXPECT_EQ(sample(1), sums(scene, 0, {.first = 1, .film_samples = 8}));
    EXPECT_NE(sample(2), sample(0));  // the same camera rays
    EXPECT_NE(sample(4), sample(2));
}

TEST_P(CachedJittersTest, WavefrontAndDepthFirstAgreeBitForBit) {
    for (const std::uint32_t rays : {1u, 2u, 3u, 5u, 8u}) {
        for (const std::uint32_t first : {0u, 3u}) {
            const Part part{.first = first, .samples = 7};
            const RenderResult queue = render_part(scene, rays, part, "wavefront");
            const RenderResult loop = render_part(scene, rays, part, "depth_first");
            SCOPED_TRACE(testing::Message() << rays << " rays from sample " << first);
            EXPECT_EQ(queue.film.sums(), loop.film.sums());
            EXPECT_EQ(queue.work.rays, loop.work.rays);
            for (const RenderResult* result : {&queue, &loop}) {
                EXPECT_EQ(result->work.cache_fills, pixels * std::min(rays, 7u));
                EXPECT_EQ(result->work.cache_hits, pixels * (7u - std::min(rays, 7u)));
            }
        }
    }
}

TEST_P(CachedJittersTest, ARunInTwoPartsHasTheSameFilm) {
    for (const char* integrator : {"wavefront", "depth_first"}) {
        const auto whole = sums(scene, 3, {.samples = 8}, integrator);
        const auto first = sums(scene, 3, {.samples = 4, .film_samples = 8}, integrator);
        const auto second = sums(scene, 3, {.first = 4, .samples = 4, .film_samples = 8}, integrator);
        for (std::size_t i = 0; i < whole.size(); ++i) {
            ASSERT_EQ(first[i] + second[i], whole[i]) << integrator;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CachedJittersTest,
                         testing::Values(std::pair{"jitter", &with_jitter}, std::pair{"lens", &with_a_lens},
                                         std::pair{"motion", &with_motion}),
                         [](const auto& test) { return std::string(test.param.first); });

TEST(CachedJittersTest, IsNotForASceneWhoseCameraRaysAreAllAlike) {
    Variant variant = Registry::instance().baseline();
    variant.set("first_bounce", "cached_jitters");
    EXPECT_EQ(why_not_applicable(variant, features_of(balls().scene)),
              "first_bounce=cached_jitters needs jitter, a lens or motion; without them first_bounce=cached is it");
}

}  // namespace
}  // namespace pt
