// Images that are known without rendering: against areas computed by hand, and against renders.
#include "harness/error/closed_form.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

Scene shipped(const std::string& name) { return load_scene(test::in_source("scenes/" + name + ".json")); }

RenderSettings settings_of(std::uint32_t width, std::uint32_t height, std::uint32_t depth = 1) {
    return {width, height, depth, 0, false};
}

// A quad one unit before the camera, whose image is 4 pixels a unit: it covers [1, 2.5] x [0.75, 3] of 4x4 pixels.
TEST(ClosedForm, AQuadLightsThePartOfAPixelThatItCovers) {
    test::SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, -1}).image(4, 4, 2 * std::atan(0.5) * 180 / std::acos(-1.0), true);
    builder.environment(1);
    builder.quad(builder.emitter({5, 3, 1}), {-0.0625, 0.03125, -1}, 0.375, 0.5625, {90, 0, 0});
    const std::optional<ClosedForm> form = closed_form(builder.scene, settings_of(4, 4));
    ASSERT_TRUE(form.has_value());
    const double columns[] = {0, 1, 0.5, 0};
    const double rows[] = {0.25, 1, 1, 0};
    ASSERT_EQ(form->image.size(), 48u);
    for (std::size_t pixel = 0; pixel < 16; ++pixel) {
        const double covered = columns[pixel % 4] * rows[pixel / 4];
        EXPECT_NEAR(form->image[3 * pixel + 0], 1 + 4 * covered, 1e-12) << pixel;
        EXPECT_NEAR(form->image[3 * pixel + 1], 1 + 2 * covered, 1e-12) << pixel;
        EXPECT_NEAR(form->image[3 * pixel + 2], 1, 1e-12) << pixel;
    }
    // Without jitter a pixel is its centre.
    builder.scene.camera.jitter = false;
    const Image centres = closed_form(builder.scene, settings_of(4, 4))->image;
    for (std::size_t pixel = 0; pixel < 16; ++pixel) {
        const bool covered = pixel % 4 == 1 && (pixel / 4 == 1 || pixel / 4 == 2);
        const bool on_the_edge = pixel % 4 == 2;
        if (!on_the_edge) {
            EXPECT_EQ(centres[3 * pixel], covered ? 5 : 1) << pixel;
        }
    }
}

// Every coverage is there as often as its complement, and in steps of a 16th: the mean of c(1-c) over a row of edge
// pixels is what predicts the plateau of frozen camera rays, contrast^2 / (6 K) for a vertical edge.
TEST(ClosedForm, TheEdgeHasEveryCoverageAlike) {
    for (const std::uint32_t size : {48u, 64u, 256u}) {
        SCOPED_TRACE(size);
        const Image image = closed_form(shipped("edge"), settings_of(size, size))->image;
        double sum = 0;
        double variance = 0;
        for (std::size_t i = 0; i < image.size(); i += 3) {
            EXPECT_NEAR(image[i] + image[image.size() - 3 - i], 1, 1e-9);
            sum += image[i];
            variance += image[i] * (1 - image[i]);
        }
        EXPECT_NEAR(sum, 0.5 * size * size, 1e-6 * size);
        EXPECT_NEAR(variance / size, 1.0 / 6, 0.02 / 6);
    }
}

TEST(ClosedForm, RendersOfTheEdgeConvergeToIt) {
    const Scene scene = shipped("edge");
    const std::uint32_t samples = 256;
    Scene small = scene;
    small.camera.width = small.camera.height = 32;
    const Film film = test::render<double>(small, {.samples = samples, .depth = 1});
    const Image image = closed_form(small, settings_of(32, 32))->image;
    double z2 = 0;
    int edge_pixels = 0;
    for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
        const double c = image[3 * pixel];
        const double error = film.pixel(pixel).x - c;
        if (c * (1 - c) < 0.02) {
            EXPECT_NEAR(error, 0, 0.06) << pixel;
            continue;
        }
        z2 += error * error / (c * (1 - c) / samples);
        ++edge_pixels;
    }
    ASSERT_GE(edge_pixels, 25);
    EXPECT_LT(std::abs(z2 - edge_pixels), test::tolerated_errors * std::sqrt(2.0 * edge_pixels));
}

TEST(ClosedForm, AFurnaceIsAGeometricSeries) {
    for (const std::uint32_t depth : {1u, 3u, 9u}) {
        SCOPED_TRACE(depth);
        test::SceneBuilder builder;
        builder.image(2, 2, 90, true).depth(depth);
        builder.sphere(builder.diffuse({0.5, 0.25, 0}, {0.5, 1, 2}), {0, 0, 0}, 2);
        const std::optional<ClosedForm> form = closed_form(builder.scene, settings_of(2, 2, depth));
        ASSERT_TRUE(form.has_value());
        const Film film = test::render<double>(builder.scene, {.samples = 4, .depth = depth});
        for (std::uint32_t pixel = 0; pixel < 4; ++pixel) {
            EXPECT_EQ(form->image[3 * pixel], 0.5 * (1 - std::pow(0.5, depth)) / 0.5);
            EXPECT_NEAR(film.pixel(pixel).x, form->image[3 * pixel + 0], 1e-12);
            EXPECT_NEAR(film.pixel(pixel).y, form->image[3 * pixel + 1], 1e-12);
            EXPECT_EQ(form->image[3 * pixel + 2], 2);
        }
    }
}

TEST(ClosedForm, OtherScenesHaveNone) {
    EXPECT_FALSE(closed_form(shipped("cornell_open"), settings_of(8, 8)).has_value());
    const auto of_quad = [](const auto& change) {
        test::SceneBuilder builder;
        builder.image(4, 4, 90, true);
        SceneObject& quad = builder.quad(builder.emitter({1, 1, 1}), {0, 0, 2}, 1, 1, {90, 0, 0});
        change(builder.scene, quad);
        return closed_form(builder.scene, settings_of(4, 4)).has_value();
    };
    EXPECT_TRUE(of_quad([](Scene&, SceneObject&) {}));
    EXPECT_FALSE(of_quad([](Scene& scene, SceneObject&) { scene.camera.aperture_radius = 0.1; }));
    EXPECT_FALSE(of_quad([](Scene&, SceneObject& quad) { quad.translate.z = 0.1, quad.rotate_degrees.x = 0; }));
    EXPECT_FALSE(of_quad([](Scene& scene, SceneObject&) { scene.materials[0].type = MaterialType::diffuse; }));
    EXPECT_FALSE(of_quad([](Scene& scene, SceneObject& quad) {
        quad.velocity = {1, 0, 0};
        scene.camera.shutter_close = 1;
    }));
    test::SceneBuilder textured;
    textured.sphere(textured.diffuse({0.5, 0.5, 0.5}, {1, 1, 1}), {0, 0, 0}, 2);
    EXPECT_TRUE(closed_form(textured.scene, settings_of(1, 1)).has_value());
    textured.texture(0, 2, 1, {{0.5, 0.5, 0.5}, {0.25, 0.25, 0.25}});
    EXPECT_FALSE(closed_form(textured.scene, settings_of(1, 1)).has_value());
    test::SceneBuilder outside;
    outside.sphere(outside.diffuse({0.5, 0.5, 0.5}, {1, 1, 1}), {0, 0, 3}, 2);
    EXPECT_FALSE(closed_form(outside.scene, settings_of(1, 1)).has_value());
}

}  // namespace
}  // namespace pt
