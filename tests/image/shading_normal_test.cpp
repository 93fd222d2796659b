// Normals that surfaces are shaded with (kernels/shading_normal.h): where they say nothing new, the film is that of
// none, bit for bit; and neither the way to render, nor scale, nor the order of triangles is in it.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "harness/mesh/generate.h"
#include "harness/render/renderer.h"
#include "harness/scene/scene_mesh.h"
#include "tests/support/shading_normals.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::ball_mesh;
using test::bumpy_texels;
using test::Kind;
using test::kinds;
using test::RenderOptions;
using test::SceneBuilder;
using test::with_normals_of_faces;

template <class Real>
class ShadingNormalTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ShadingNormalTest, Reals);

const std::vector<Vec3d> flat_texels(6, Vec3d(0, 0, 1));

enum class Bend { none, faces_normals, flat_map, both };

// Shapes of all kinds in the material, within a room whose walls are axis boxes.
Scene room_of(const Kind& kind, Bend bend) {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(20, 20, 55, true).depth(6).environment(0.25);
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, -0.25, 0}, 8, 8);
    const std::uint32_t material = kind.make(builder);
    if (bend == Bend::flat_map || bend == Bend::both) {
        builder.normal_map(material, 3, 2, flat_texels, 0.7);
    }
    builder.sphere(material, {-1, 0.5, 0}, 1);
    builder.ellipsoid(material, {0.2, 0.5, 0}, {1, 0.8, 0.6}, {10, 20, 30});
    builder.box(material, {1.4, 0.4, 0.3}, {0.8, 0.8, 0.8});
    builder.box(material, {-0.4, 0.4, -1}, {0.5, 0.8, 0.3}, {10, 50, 20});
    Mesh mesh = with_normals_of_faces(generate_mesh("icosphere", 1));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        mesh.coordinates.push_back({{{0, 0}, {1, 0}, {0.25f, 1}}});
    }
    const auto placed = make_scene_mesh(mesh, "placed", true), shared = make_scene_mesh(mesh, "shared", true);
    const bool asks = bend == Bend::faces_normals || bend == Bend::both;
    builder.mesh(material, placed, {0, 2, 1}, 0.5, {10, 20, 30}).shading_normals = asks;
    builder.mesh(material, shared, {-2, 1.2, 1}, 0.5, {0, 30, 0}).shading_normals = asks;
    SceneObject& stretched = builder.mesh(material, shared, {2, 1.5, 1}, 0.5, {40, 30, 0});
    stretched.shading_normals = asks;
    stretched.scale = {0.5, 0.3, 0.7};
    test::lamp(builder);
    return builder.scene;
}

const RenderOptions estimators[] = {
    {.samples = 2},
    {.samples = 2, .final_bounce = true},
    {.samples = 2, .next_event = true},
    {.samples = 2, .next_event = true, .mis_exponent = 2},
    {.samples = 2, .next_event = true, .mis_exponent = 2, .one_sample = true},
    {.samples = 2, .next_event = true, .mis_exponent = 1, .light_selection = LightSelection::tree},
    {.samples = 2, .roulette_start = 2},
};

TYPED_TEST(ShadingNormalTest, ThatAreTheSurfacesLeaveTheFilmOfNone) {
    for (const Kind& kind : kinds) {
        const Scene plain = room_of(kind, Bend::none);
        ASSERT_FALSE(contains(features_of(plain), Feature::shading_normals));
        for (const Bend bend : {Bend::faces_normals, Bend::flat_map, Bend::both}) {
            const Scene bent = room_of(kind, bend);
            ASSERT_TRUE(contains(features_of(bent), Feature::shading_normals));
            for (const RenderOptions& options : estimators) {
                EXPECT_EQ(test::render<TypeParam>(bent, options).hash(), test::render<TypeParam>(plain, options).hash())
                    << kind.name << " " << static_cast<int>(bend);
            }
        }
    }
}

// A studded room with balls and meshes of every material, bent in every way.
Scene bent_scene() {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(12, 12, 55, true).depth(6).environment(0.25);
    const std::uint32_t floor = builder.diffuse({0.75, 0.5, 0.25});
    builder.normal_map(floor, 2, 2, bumpy_texels);
    builder.quad(floor, {0, -0.25, 0}, 8, 8);
    const auto ball = make_scene_mesh(ball_mesh(6), "ball", true);
    double x = -1.6;
    for (const Kind& kind : kinds) {
        const std::uint32_t plain = kind.make(builder), mapped = kind.make(builder);
        builder.normal_map(mapped, 2, 2, bumpy_texels, 0.8);
        builder.mesh(plain, ball, {x, 0.6, 1.5 - std::abs(x)}, 0.25, {10, 20, 30}).shading_normals = true;
        builder.box(mapped, {x, 0.1, -0.5}, {0.3, 0.3, 0.3}, {0, 90 * x, 0});
        builder.sphere(mapped, {x, 1.4, 0.3}, 0.35);
        x += 0.4;
    }
    Mesh single = ball_mesh(5);
    for (std::size_t i = 0; i < single.triangles.size(); ++i) {
        single.coordinates.push_back({{{0, 0}, {1, 0}, {0.25f, 1}}});
    }
    const std::uint32_t knobbly = builder.diffuse(Vec3d(0.6));
    builder.normal_map(knobbly, 2, 2, bumpy_texels);
    builder.mesh(knobbly, make_scene_mesh(single, "single", true), {0, 2, 1}, 0.4).shading_normals = true;
    test::lamp(builder);
    return builder.scene;
}

// Every way to render leaves one film of what is bent.
TEST(ShadingNormalFilm, IsOneByEveryChoice) {
    const Scene scene = bent_scene();
    const auto film_of = [&](const Variant& variant) {
        RenderRequest request;
        request.variant = variant;
        request.settings = default_settings(scene);
        request.samples = 2;
        return pt::render(scene, request).film.hash();
    };
    const Registry& registry = Registry::instance();
    int compared = 0;
    for (const Choice* light : registry.choices("direct_light")) {
        Variant baseline = registry.baseline();
        baseline.set("direct_light", std::string(light->descriptor.name));
        const std::string film = film_of(baseline);
        for (const char* const axis :
             {"integrator", "accelerator", "builder", "levels", "layout", "compaction", "sorting", "specialisation"}) {
            for (const Choice* choice : registry.choices(axis)) {
                Variant variant = baseline;
                variant.set(axis, std::string(choice->descriptor.name));
                if (why_not_applicable(variant, features_of(scene)).empty()) {
                    EXPECT_EQ(film_of(variant), film)
                        << light->descriptor.name << " " << axis << "=" << choice->descriptor.name;
                    ++compared;
                }
            }
        }
    }
    EXPECT_GT(compared, 50);
}

TYPED_TEST(ShadingNormalTest, ScaleByAPowerOfTwoIsNotInTheFilm) {
    const RenderOptions options{.samples = 2, .next_event = true, .mis_exponent = 2};
    const std::string film = test::render<TypeParam>(bent_scene(), options).hash();
    for (const int k : {-20, -3, 5, 30}) {
        EXPECT_EQ(test::render<TypeParam>(test::scaled(bent_scene(), std::ldexp(1.0, k)), options).hash(), film) << k;
    }
}

TYPED_TEST(ShadingNormalTest, TheOrderOfTrianglesIsNotInTheFilm) {
    const auto film_of = [](Mesh mesh, bool is_shuffled) {
        if (is_shuffled) {
            std::reverse(mesh.triangles.begin(), mesh.triangles.end());
            for (auto& triangle : mesh.triangles) {
                std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
            }
        }
        SceneBuilder builder;
        builder.camera({0, 1.5, -4}, {0, 0, 0}).image(16, 16, 40, true).depth(3).environment(1);
        builder.mesh(builder.diffuse(Vec3d(0.7)), make_scene_mesh(mesh, "m", true), {0, 0, 0}, 1).shading_normals =
            true;
        return test::render<TypeParam>(builder.scene, {.samples = 2}).hash();
    };
    // Two balls at one place with other normals: the least primitive is met, whichever it is in the file.
    Mesh twice = ball_mesh(6);
    const auto vertices = static_cast<std::uint32_t>(twice.vertices.size());
    for (std::uint32_t i = 0; i < vertices; ++i) {
        twice.vertices.push_back(twice.vertices[i]);
        twice.normals.push_back({twice.normals[i][0], twice.normals[i][1] + 0.3f, twice.normals[i][2]});
    }
    const std::size_t triangles = twice.triangles.size();
    for (std::size_t i = 0; i < triangles; ++i) {
        const auto [a, b, c] = twice.triangles[i];
        twice.triangles.push_back({a + vertices, b + vertices, c + vertices});
    }
    for (const Mesh& mesh : {ball_mesh(6), twice}) {
        EXPECT_EQ(film_of(mesh, false), film_of(mesh, true));
    }
    EXPECT_NE(film_of(ball_mesh(6), false), film_of(with_normals_of_faces(ball_mesh(6)), false));
}

// Turned round, the normals are the same: the corners' order says where outside is.
TYPED_TEST(ShadingNormalTest, PointOutwardWhateverTheFileSays) {
    const auto film_of = [](const Mesh& mesh) {
        SceneBuilder builder;
        builder.camera({0, 1.5, -4}, {0, 0, 0}).image(16, 16, 40, true).depth(3).environment(1);
        builder.mesh(builder.diffuse(Vec3d(0.7)), make_scene_mesh(mesh, "m", true), {0, 0, 0}, 1).shading_normals =
            true;
        return test::render<TypeParam>(builder.scene, {.samples = 2}).hash();
    };
    Mesh inward = ball_mesh(6);
    for (auto& normal : inward.normals) {
        normal = {-7 * normal[0], -7 * normal[1], -7 * normal[2]};
    }
    EXPECT_EQ(film_of(inward), film_of(ball_mesh(6)));
}

}  // namespace
}  // namespace pt
