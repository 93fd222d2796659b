// What must not change an image, bit for bit: the unit of length, the unit of radiance, the order of the file, objects
// that no path meets, a run in two parts. numerics.md S11, S12, S19 and 4.1.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::RenderOptions;
using test::SceneBuilder;

template <class Real>
class InvarianceTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(InvarianceTest, Reals);

// Every shape, every material, several kinds of light, lens, shutter and jitter.
Scene menagerie() {
    SceneBuilder builder;
    builder.camera({0.3, 1.2, -4}, {0, 0.5, 0}).image(24, 16, 60, true).depth(6).environment(0.125);
    builder.scene.camera.aperture_radius = 0.05;
    builder.scene.camera.focus_distance = 4;
    builder.scene.camera.shutter_close = 1;
    builder.scene.camera.shutter_late = true;
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, 10, 10);
    builder.sphere(builder.dielectric(1.5, {0.1, 0.5, 1}, {1, 0.9, 0.8}), {-1, 0.5, 0}, 1);
    builder.ellipsoid(builder.mirror({0.9, 0.8, 0.7}), {1.2, 0.5, 0.5}, {0.8, 1, 0.5}, {10, 20, 30});
    builder.box(builder.mix({0.5, 0.6, 0.7}, {0.8, 0.9, 1}, 0.25), {0, 0.25, -0.8}, Vec3d(0.5));
    builder.box(builder.subsurface({8, 4, 2}, {0.1, 0.2, 0.4}, 0.5, 1.3), {0.2, 0.6, 1}, {0.8, 1, 0.6}, {0, 30, 20});
    builder.sphere(builder.subsurface({4, 8, 2}, {0.1, 0, 0.3}), {-1.6, 0.4, -1}, 0.6);
    builder.sphere(builder.diffuse(Vec3d(0.5), {0.5, 0.25, 0.125}), {1, 0.2, -1}, 0.4).velocity = {0.5, 0.25, 0};
    builder.quad(builder.emitter(Vec3d(4.0)), {0, 3, 0}, 1, 1.5, {170, 10, 0});
    builder.ellipsoid(builder.emitter({2, 4, 8}), {-2, 2, 1}, {0.5, 0.3, 0.4}, {0, 0, 40});
    builder.box(builder.emitter({8, 4, 2}), {2, 2, 1}, Vec3d(0.3), {10, 20, 30});
    builder.box(builder.emitter({2, 2, 2}), {2, 0.2, -1}, Vec3d(0.2)).velocity = {0, 0.5, 0};
    return builder.scene;
}

template <class Real>
std::vector<std::int64_t> sums_of(const Scene& scene, RenderOptions options) {
    const Film film = test::render<Real>(scene, options);
    EXPECT_EQ(film.faults().nonfinite, 0u);
    EXPECT_EQ(film.faults().negative, 0u);
    EXPECT_EQ(film.faults().saturated, 0u);
    return film.sums();
}

constexpr RenderOptions plain{.samples = 8};
// So short that most of its light comes by connections.
constexpr RenderOptions connected{.samples = 8, .depth = 2, .final_bounce = true};

TYPED_TEST(InvarianceTest, UnitOfLength) {
    for (const RenderOptions& options : {plain, connected}) {
        const auto reference = sums_of<TypeParam>(menagerie(), options);
        for (const int k : {-50, -20, -10, -1, 1, 10, 20, 40}) {
            EXPECT_EQ(sums_of<TypeParam>(test::scaled(menagerie(), std::ldexp(1.0, k)), options), reference)
                << "2^" << k << (options.final_bounce ? ", final bounce" : "");
        }
    }
}

TYPED_TEST(InvarianceTest, UnitOfRadiance) {
    for (const RenderOptions& options : {plain, connected}) {
        const auto reference = sums_of<TypeParam>(menagerie(), options);
        for (const int k : {-50, -20, -1, 1, 20, 40}) {
            EXPECT_EQ(sums_of<TypeParam>(test::brightened(menagerie(), std::ldexp(1.0, k)), options), reference)
                << "2^" << k;
        }
    }
}

TYPED_TEST(InvarianceTest, OrderInTheFile) {
    for (const RenderOptions& options : {plain, connected}) {
        const auto reference = sums_of<TypeParam>(menagerie(), options);
        Scene scene = menagerie();
        std::reverse(scene.objects.begin(), scene.objects.end());
        EXPECT_EQ(sums_of<TypeParam>(scene, options), reference);
        std::rotate(scene.objects.begin(), scene.objects.begin() + 4, scene.objects.end());
        EXPECT_EQ(sums_of<TypeParam>(scene, options), reference);
    }
}

TYPED_TEST(InvarianceTest, UnseenObjects) {
    // In a closed room nothing outside can be met; what stands there only shifts the objects' numbers.
    SceneBuilder builder;
    builder.camera({0, 1, -1.5}, {0, 0.8, 0}).image(24, 16, 80, true).depth(5);
    const std::uint32_t wall = builder.diffuse({0.75, 0.5, 0.25});
    builder.box(wall, {0, 1, 0}, {4, 4, 4});
    builder.sphere(builder.dielectric(1.5), {0, 0.5, 0.5}, 1);
    builder.quad(builder.emitter(Vec3d(4.0)), {0, 2.5, 0}, 1, 1);
    builder.box(wall, {1, 0, 0.5}, Vec3d(0.8), {0, 30, 0});
    SceneBuilder more = builder;
    more.sphere(wall, {1000, 0, 0}, 1);
    more.ellipsoid(wall, {0, 0, -1000}, {1, 2, 3});
    more.box(wall, {0, 5000, 0}, Vec3d(100.0));
    more.box(wall, {0, -50, 0}, Vec3d(3.0), {10, 20, 30});
    more.quad(wall, {-30, 0, 0}, 3, 3, {0, 0, 90});
    for (const RenderOptions& options : {plain, connected}) {
        EXPECT_EQ(sums_of<TypeParam>(more.scene, options), sums_of<TypeParam>(builder.scene, options));
    }
}

TYPED_TEST(InvarianceTest, RunInTwoParts) {
    for (const bool final_bounce : {false, true}) {
        const Scene scene = menagerie();
        const auto part = [&](std::uint32_t first, std::uint32_t samples) {
            return sums_of<TypeParam>(
                scene, {.samples = samples, .first_sample = first, .film_samples = 8, .final_bounce = final_bounce});
        };
        const auto whole = part(0, 8), first = part(0, 3), second = part(3, 5);
        for (std::size_t i = 0; i < whole.size(); ++i) {
            ASSERT_EQ(first[i] + second[i], whole[i]);
        }
    }
}

TYPED_TEST(InvarianceTest, PlaceOfTheSceneTogetherWithItsCamera) {
    // Places are taken relative to the eye, in double: a shift by multiples of 2^-10 up to 10^6 leaves nothing behind
    // but the rounding of decimal places like 0.3 in double, so the scene is put on dyadic places first.
    const auto snapped = [](const Vec3d& offset) {
        Scene scene = menagerie();
        const auto snap = [&](const Vec3d& v) {
            Vec3d result;
            for (int k = 0; k < 3; ++k) {
                result[k] = std::round(v[k] * 64) / 64 + offset[k];
            }
            return result;
        };
        scene.camera.eye = snap(scene.camera.eye);
        scene.camera.look_at = snap(scene.camera.look_at);
        for (SceneObject& object : scene.objects) {
            object.translate = snap(object.translate);
        }
        return scene;
    };
    const auto reference = sums_of<TypeParam>(snapped(Vec3d(0.0)), connected);
    for (const double distance : {1e3, 1e6, 0x1p30}) {
        EXPECT_EQ(sums_of<TypeParam>(snapped(Vec3d(distance, -distance, 2 * distance)), connected), reference)
            << distance;
    }
}

TYPED_TEST(InvarianceTest, SeedsGiveDifferentImagesOfTheSameMean) {
    const auto one = test::mean_radiance<TypeParam>(menagerie(), {.samples = 32, .seed = 1});
    const auto two = test::mean_radiance<TypeParam>(menagerie(), {.samples = 32, .seed = 2});
    for (int i = 0; i < 3; ++i) {
        EXPECT_NE(one.channel[i].value(), two.channel[i].value());
        EXPECT_NEAR(
            one.channel[i].value(), two.channel[i].value(),
            test::tolerated_errors * std::hypot(one.channel[i].standard_error(), two.channel[i].standard_error()));
    }
}

TYPED_TEST(InvarianceTest, CoincidentQuadsShowOneOfThem) {
    // numerics.md S19: two radiances in the same place: one of the two in every pixel, and the same one in any order.
    SceneBuilder builder;
    builder.image(16, 16, 40, true);
    builder.quad(builder.emitter(Vec3d(0.25)), {0, 0, 4}, 8, 8, {70, 10, 0});
    builder.quad(builder.emitter(Vec3d(0.75)), {0, 0, 4}, 8, 8, {70, 10, 0});
    // In a plane across an axis distances are exactly 0, so paths also leave the pair as they leave one quad.
    SceneBuilder reflecting;
    reflecting.image(16, 16, 40, true).depth(2).environment(1);
    reflecting.quad(reflecting.diffuse(Vec3d(0.25)), {0, 0, 4}, 8, 8, {90, 0, 0});
    reflecting.quad(reflecting.diffuse(Vec3d(0.75)), {0, 0, 4}, 8, 8, {90, 0, 0});
    for (Scene* scene : {&builder.scene, &reflecting.scene}) {
        const Film film = test::render<TypeParam>(*scene, {});
        for (std::uint32_t i = 0; i < 256; ++i) {
            ASSERT_TRUE(film.pixel(i) == Vec3d(0.25) || film.pixel(i) == Vec3d(0.75)) << film.pixel(i).x;
        }
        std::swap(scene->objects[0], scene->objects[1]);
        EXPECT_EQ(test::render<TypeParam>(*scene, {}).sums(), film.sums());
    }
}

TEST(InvarianceTest, TheProgramsOwnRendererIsInvariantToo) {
    const Film reference = test::render_variant(menagerie(), {.samples = 4});
    EXPECT_EQ(reference.sums(), test::render<float>(menagerie(), {.samples = 4}).sums());
    for (const int k : {-20, 20}) {
        EXPECT_EQ(test::render_variant(test::scaled(menagerie(), std::ldexp(1.0, k)), {.samples = 4}).hash(),
                  reference.hash());
        EXPECT_EQ(test::render_variant(test::brightened(menagerie(), std::ldexp(1.0, k)), {.samples = 4}).hash(),
                  reference.hash());
    }
    Scene reversed = menagerie();
    std::reverse(reversed.objects.begin(), reversed.objects.end());
    EXPECT_EQ(test::render_variant(reversed, {.samples = 4}).hash(), reference.hash());
    const auto part = [&](std::uint32_t first, std::uint32_t samples) {
        return test::render_variant(menagerie(), {.samples = samples, .first_sample = first, .film_samples = 4}).sums();
    };
    const auto whole = part(0, 4), first = part(0, 1), second = part(1, 3);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        ASSERT_EQ(first[i] + second[i], whole[i]);
    }
}

}  // namespace
}  // namespace pt
