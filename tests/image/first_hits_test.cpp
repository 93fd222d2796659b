// What camera rays meet first, averaged over pixels: against walls at known places, and ray by ray against the stages
// that renders are made of.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/render/first_hits.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

RenderRequest first_hit_request(const Scene& scene, std::uint32_t samples,
                                const std::vector<std::pair<std::string, std::string>>& axes = {}) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    for (const auto& [axis, choice] : axes) {
        request.variant.set(axis, choice);
    }
    request.settings = default_settings(scene);
    request.settings.seed = 7;
    request.samples = samples;
    return request;
}

Vec3d vector_at(const std::vector<float>& values, std::size_t pixel) {
    return {values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]};
}

TEST(FirstHitsTest, AWallAtAKnownDistance) {
    SceneBuilder builder;
    builder.quad(builder.diffuse(Vec3d(0.75, 0.5, 0.25)), {0, 0, 4}, 20, 20, {-90, 0, 0});
    for (const char* const precision : {"float", "double"}) {
        SCOPED_TRACE(precision);
        const FirstHits hits =
            first_hits(builder.scene,
                       first_hit_request(builder.scene, 1, {{"integrator", "depth_first"}, {"precision", precision}}));
        EXPECT_EQ(hits.rays, 1u);
        EXPECT_EQ(hits.depth, std::vector<float>{4});
        EXPECT_EQ(vector_at(hits.normal, 0), Vec3d(0, 0, -1));
        EXPECT_EQ(vector_at(hits.albedo, 0), Vec3d(0.75, 0.5, 0.25));
        EXPECT_EQ(hits.coverage, std::vector<float>{1});
    }
}

TEST(FirstHitsTest, DepthIsTheDistanceAlongTheRayAndNotAlongTheAxis) {
    SceneBuilder builder;
    builder.image(9, 9, 90, false);
    builder.quad(builder.diffuse(Vec3d(0.5)), {0, 0, 4}, 20, 20, {-90, 0, 0});
    const FirstHits hits = first_hits(builder.scene, first_hit_request(builder.scene, 3));
    for (int pixel = 0; pixel < 81; ++pixel) {
        const double x = (pixel % 9 - 4) / 4.5;
        const double y = (pixel / 9 - 4) / 4.5;
        EXPECT_NEAR(hits.depth[static_cast<std::size_t>(pixel)], 4 * std::sqrt(1 + x * x + y * y), 2e-6) << pixel;
        EXPECT_EQ(vector_at(hits.normal, static_cast<std::size_t>(pixel)), Vec3d(0, 0, -1)) << pixel;
    }
}

TEST(FirstHitsTest, NormalsAreOnTheSideThatTheRayComesFrom) {
    for (const double turn : {-90.0, 90.0}) {
        SceneBuilder flat;
        flat.quad(flat.diffuse(Vec3d(0.5)), {0, 0, 4}, 20, 20, {turn, 0, 0});
        EXPECT_EQ(vector_at(first_hits(flat.scene, first_hit_request(flat.scene, 1)).normal, 0), Vec3d(0, 0, -1))
            << turn;
    }
    SceneBuilder inside;
    inside.sphere(inside.diffuse(Vec3d(0.5)), {0, 0, 0}, 6);
    const FirstHits hits = first_hits(inside.scene, first_hit_request(inside.scene, 1));
    EXPECT_EQ(vector_at(hits.normal, 0), Vec3d(0, 0, -1));
    EXPECT_EQ(hits.depth[0], 3);
}

// The one that is shaded with; from behind, the whole normal is turned round: a bump is a dent.
TEST(FirstHitsTest, NormalsAreThoseOfAMap) {
    for (const double turn : {-90.0, 90.0}) {
        SceneBuilder builder;
        const std::uint32_t grey = builder.diffuse(Vec3d(0.5));
        builder.normal_map(grey, 1, 1, {{0.6, 0, 0.8}});
        builder.quad(grey, {0, 0, 4}, 20, 20, {turn, 0, 0});
        const Vec3d normal = vector_at(first_hits(builder.scene, first_hit_request(builder.scene, 1)).normal, 0);
        EXPECT_NEAR(normal.x, turn < 0 ? 0.6 : -0.6, 1e-6);
        EXPECT_NEAR(normal.y, 0, 1e-6);
        EXPECT_NEAR(normal.z, -0.8, 1e-6);
    }
}

TEST(FirstHitsTest, WhatMeetsNothingCountsAsZero) {
    SceneBuilder builder;
    builder.image(8, 8, 90, true).environment(1);
    builder.quad(builder.diffuse(Vec3d(0.5)), {10, 0, 4}, 20, 200, {-90, 0, 0});  // the left half of the image
    builder.scene.camera.look_at = {0.013, 0.007, 1};
    const FirstHits hits = first_hits(builder.scene, first_hit_request(builder.scene, 64));
    const test::Stages<float> stages(builder.scene, {.seed = 7});
    bool has_edge = false;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        std::uint32_t met = 0;
        for (std::uint32_t sample = 0; sample < 64; ++sample) {
            met += stages.intersect(stages.generate(pixel, sample)).side.exists() ? 1 : 0;
        }
        EXPECT_FLOAT_EQ(hits.coverage[pixel], static_cast<float>(met) / 64) << pixel;
        EXPECT_FLOAT_EQ(hits.albedo[3 * pixel], 0.5f * static_cast<float>(met) / 64) << pixel;
        EXPECT_FLOAT_EQ(hits.normal[3 * pixel + 2], -static_cast<float>(met) / 64) << pixel;
        EXPECT_EQ(hits.depth[pixel] == 0, met == 0) << pixel;
        has_edge = has_edge || (met > 0 && met < 64);
    }
    EXPECT_TRUE(has_edge);
}

// Jitter, a lens, a shutter and two moving objects, and a mesh.
Scene blurred() {
    SceneBuilder builder;
    builder.image(12, 10, 60, true).environment(1);
    builder.scene.camera.aperture_radius = 0.2;
    builder.scene.camera.focus_distance = 4;
    builder.scene.camera.shutter_close = 0.5;
    builder.sphere(builder.mirror(Vec3d(0.9, 0.8, 0.7)), {-0.5, 0, 4}, 1.5).velocity = {0.5, 0.25, 0};
    builder.box(builder.diffuse(Vec3d(0.3, 0.2, 0.1)), {1, -0.5, 5}, {1, 1, 1}, {10, 20, 30}).velocity = {0, 0, -1};
    builder.mesh(builder.emitter(Vec3d(3)), "icosphere", 2, {0, 1, 4}, 0.5);
    return builder.scene;
}

// The means over rays that the stages make, `kept` of them in turn.
template <class Real>
void expect_rays_of_the_film(const std::vector<std::pair<std::string, std::string>>& axes,
                             const test::RenderOptions& options, std::uint32_t kept) {
    constexpr std::uint32_t samples = 21;
    const Scene scene = blurred();
    const FirstHits hits = first_hits(scene, first_hit_request(scene, samples, axes));
    const test::Stages<Real> stages(scene, options);
    std::uint32_t met_anything = 0;
    for (std::uint32_t pixel = 0; pixel < 120; ++pixel) {
        Vec3d normal(0.0);
        Vec3d albedo(0.0);
        double depth = 0;
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            const Path<Real> path = stages.generate(pixel, sample % kept);
            const Hit<Real> hit = stages.intersect(path);
            if (!hit.side.exists()) {
                continue;
            }
            ++met_anything;
            const Vec3d outward(stages.surface(ray_of(path), hit).normal);
            EXPECT_LT(dot(Vec3d(path.direction), hit.side.inside() ? -outward : outward), 0);
            normal += hit.side.inside() ? -outward : outward;
            albedo += first_hit_albedo(scene.materials[scene.objects[stages.file_index(hit.side)].material]);
            depth += static_cast<double>(hit.t);
        }
        EXPECT_FLOAT_EQ(hits.depth[pixel], static_cast<float>(depth / samples)) << pixel;
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(vector_at(hits.normal, pixel)[i], normal[i] / samples, 1e-7) << pixel;
            EXPECT_NEAR(vector_at(hits.albedo, pixel)[i], albedo[i] / samples, 1e-7) << pixel;
        }
    }
    EXPECT_GT(met_anything, samples * 12);
}

TEST(FirstHitsTest, RaysAreThoseOfTheFilm) {
    expect_rays_of_the_film<float>({}, {.seed = 7}, 21);
    expect_rays_of_the_film<float>({{"integrator", "depth_first"}, {"accelerator", "bvh2"}}, {.seed = 7}, 21);
}

TEST(FirstHitsTest, RaysAreThoseOfTheSampler) {
    expect_rays_of_the_film<float>({{"sampler", "sobol_owen"}},
                                   {.seed = 7, .sampler = static_cast<FeatureSet>(Feature::sobol_owen)}, 21);
    expect_rays_of_the_film<float>({{"sampler", "halton"}},
                                   {.seed = 7, .sampler = static_cast<FeatureSet>(Feature::halton)}, 21);
}

TEST(FirstHitsTest, RaysAreThoseOfACacheOfThem) {
    Variant variant = Registry::instance().baseline();
    variant.set("first_bounce", "cached_jitters");
    const std::uint32_t kept = tunable(variant, "jitters", Backend::cpu);
    ASSERT_LT(kept, 21u);
    expect_rays_of_the_film<float>({{"first_bounce", "cached_jitters"}}, {.seed = 7}, kept);
}

TEST(FirstHitsTest, RaysAreInTheVariantsPrecision) {
    expect_rays_of_the_film<double>({{"integrator", "depth_first"}, {"precision", "double"}}, {.seed = 7}, 21);
}

TEST(FirstHitsTest, ALongRenderHasThoseOfItsFirstSamples) {
    SceneBuilder builder;
    builder.image(4, 4, 60, true);
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0.3, 0.2, 4}, 2);
    const FirstHits longer = first_hits(builder.scene, first_hit_request(builder.scene, most_first_hit_rays + 40));
    const FirstHits whole = first_hits(builder.scene, first_hit_request(builder.scene, most_first_hit_rays));
    EXPECT_EQ(longer.rays, most_first_hit_rays);
    EXPECT_EQ(longer.depth, whole.depth);
    EXPECT_NE(first_hits(builder.scene, first_hit_request(builder.scene, 16)).depth, whole.depth);
}

TEST(FirstHitsTest, AlbedoIsTheNumberOfTheScene) {
    SceneBuilder builder;
    const auto albedo = [&](std::uint32_t material) { return first_hit_albedo(builder.scene.materials[material]); };
    const Vec3d a(0.25, 0.5, 0.75), b(1, 0.5, 0);
    EXPECT_EQ(albedo(builder.diffuse(a, Vec3d(2))), a);
    EXPECT_EQ(albedo(builder.mirror(b)), b);
    EXPECT_EQ(albedo(builder.mix(a, b, 0.25)), a * 0.75 + b * 0.25);
    EXPECT_EQ(albedo(builder.rough_conductor(b, 0.3)), b);
    EXPECT_EQ(albedo(builder.principled(b, 0.5, 0.3)), b);
    EXPECT_EQ(albedo(builder.dielectric(1.5, Vec3d(1), a)), a);
    EXPECT_EQ(albedo(builder.rough_dielectric(1.5, 0.2, Vec3d(0), b)), b);
    EXPECT_EQ(albedo(builder.subsurface({3, 1, 0}, {1, 1, 0})), Vec3d(0.75, 0.5, 0));
    EXPECT_EQ(albedo(builder.emitter(Vec3d(5))), Vec3d(0));
}

// Seen from above with -z up: the lower left texel in the lower left pixel.
TEST(FirstHitsTest, AlbedoOfAnImageIsTheTexelThatIsMet) {
    const std::vector<Vec3d> texels{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.25, 0.75}};
    const auto expect_texels = [&](const auto& make_material, const auto& expected) {
        SceneBuilder builder;
        builder.camera({0, 1, 0}, {0, 0, 0}, {0, 0, -1}).image(2, 2, 90, false);
        const std::uint32_t material = make_material(builder);
        builder.texture(material, 2, 2, texels);
        builder.quad(material, {0, 0, 0}, 2, 2);
        const FirstHits hits = first_hits(builder.scene, first_hit_request(builder.scene, 1));
        for (std::size_t pixel = 0; pixel < 4; ++pixel) {
            const Vec3d off = vector_at(hits.albedo, pixel) - expected(texels[(pixel + 2) % 4]);
            EXPECT_LT(std::sqrt(dot(off, off)), 1e-6) << pixel;
        }
    };
    const Vec3d mirror(0.5, 0.75, 1);
    expect_texels([](SceneBuilder& b) { return b.diffuse(Vec3d(1)); }, [](const Vec3d& texel) { return texel; });
    expect_texels([](SceneBuilder& b) { return b.mirror(Vec3d(1)); }, [](const Vec3d& texel) { return texel; });
    expect_texels([&](SceneBuilder& b) { return b.mix(Vec3d(1), mirror, 0.25); },
                  [&](const Vec3d& texel) { return texel * 0.75 + mirror * 0.25; });
}

}  // namespace
}  // namespace pt
