// Meshes in scenes: furnaces that show any leak, films that do not depend on the order of triangles, on scale, or on
// how the triangles are found, and meshes as lights.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/mesh/generate.h"
#include "harness/scene/scene_mesh.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

Film film_of(const Scene& scene, const AxisChoices& choices, std::uint32_t samples = 2) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    for (const auto& [axis, names] : choices) {
        request.variant.set(axis, names.front());
    }
    EXPECT_EQ(why_not_applicable(request.variant, features_of(scene)), "");
    request.settings = default_settings(scene);
    request.settings.seed = 3;
    request.samples = samples;
    return pt::render(scene, request).film;
}

std::vector<std::string> accelerators() {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices("accelerator")) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

// A room that shines evenly, E = rho = 1/2, with a body of the same material in it that hides a light a thousand times
// as bright: every pixel has the same nine bits unless a ray goes through the body's surface.
SceneBuilder furnace_round_a_light() {
    SceneBuilder builder;
    const std::uint32_t wall = builder.diffuse(Vec3d(0.5), Vec3d(0.5));
    builder.room(wall, {0, 0, 0}, {4, 4, 4});
    builder.camera({0, 0, -3.5}, {0, 0, 1}).image(16, 16, 60, true).depth(9);
    return builder;
}

TEST(MeshTest, NoRayGoesThroughAClosedMesh) {
    const struct {
        const char* name;
        std::uint32_t size;
        double light;  // diameter of the light inside; it fits between the mesh's walls
    } bodies[] = {{"icosphere", 1, 1.2}, {"icosphere", 3, 1.6}, {"grid_sphere", 7, 1.2}};
    for (const auto& body : bodies) {
        for (const std::string& accelerator : accelerators()) {
            SceneBuilder builder = furnace_round_a_light();
            builder.mesh(0, body.name, body.size, {0, 0, 0}, 1.5, {10, 20, 30});
            builder.sphere(builder.emitter(Vec3d(1000)), {0, 0, 0}, body.light);
            const Film film = film_of(builder.scene, {{"accelerator", {accelerator}}}, 8);
            for (std::uint32_t i = 0; i < 256; ++i) {
                ASSERT_EQ(film.pixel(i), Vec3d(0.998046875)) << body.name << " " << accelerator << " pixel " << i;
            }
        }
    }
}

TEST(MeshTest, FromWithinAClosedMeshNothingElseIsSeen) {
    for (const std::string& accelerator : accelerators()) {
        SceneBuilder builder;
        builder.mesh(builder.diffuse(Vec3d(0.5), Vec3d(0.5)), "icosphere", 2, {0, 0, 0}, 2, {5, 0, 0});
        builder.camera({0.25, 0.125, -0.5}, {0, 0, 1}).image(16, 16, 120, true).depth(9).environment(1000);
        const Film film = film_of(builder.scene, {{"accelerator", {accelerator}}}, 8);
        for (std::uint32_t i = 0; i < 256; ++i) {
            ASSERT_EQ(film.pixel(i), Vec3d(0.998046875)) << accelerator << " pixel " << i;
        }
    }
}

// A room with meshes of every shape that the generators make, and other objects: a mesh also ends paths, refracts,
// shines.
Scene mixed_scene() {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.75));
    builder.room(white, {0, 0, 0}, {3, 3, 3});
    builder.mesh(white, "menger", 1, {-1, -2, 0.5}, 1.5, {0, 0, 0});
    builder.mesh(builder.mirror(Vec3d(0.9)), "trefoil", 4, {1, -1, 0}, 1, {30, 0, 10});
    builder.mesh(builder.dielectric(1.5, Vec3d(0.5)), "icosphere", 2, {0.5, 1, -0.5}, 0.75, {0, 0, 0});
    builder.mesh(builder.dielectric(1.5, Vec3d(0.5)), "icosphere", 2, {-1.5, 1.5, 1}, 0.5, {0, 40, 0});
    builder.mesh(builder.emitter(Vec3d(4)), "cornell", 1, {0, 2.5, 0}, 0.25, {90, 0, 0});
    builder.sphere(white, {-1, 0, -1}, 1);
    builder.camera({0, 0, -2.9}, {0, 0, 1}).image(16, 16, 90, true).depth(5);
    return builder.scene;
}

TEST(MeshTest, EveryVariantLeavesTheFilmOfBruteForce) {
    const Scene scene = mixed_scene();
    RenderSettings settings = default_settings(scene);
    settings.width = settings.height = 8;
    settings.seed = 11;
    Verifier verifier(scene, settings, 2);
    AxisChoices axes = all_choices();
    axes["direct_light"] = {"off", "nee_mis"};
    axes["russian_roulette"] = {"off"};
    axes["sampler"] = {"pcg4d"};
    axes["arithmetic"] = {"exact"};
    std::size_t held = 0, with_tree = 0;
    for (const Variant& variant : covering_variants(axes, features_of(scene), Backend::cpu)) {
        const Verdict verdict = verifier.check(variant);
        EXPECT_TRUE(verdict.holds) << variant.spelled_out() << ": " << verdict.message;
        held += 1;
        with_tree += variant["accelerator"] != "brute_force" ? 1 : 0;
    }
    EXPECT_GT(held, 10u);
    EXPECT_GT(with_tree, 4u);
}

TEST(MeshTest, TheOrderOfTrianglesIsNotInTheFilm) {
    Mesh mesh = generate_mesh("trefoil", 4);
    std::vector<std::string> hashes;
    for (int turn = 0; turn < 2; ++turn) {
        Scene scene = mixed_scene();
        auto& shown = *std::find_if(scene.objects.begin(), scene.objects.end(),
                                    [](const SceneObject& object) { return object.mesh == 1; });
        scene.meshes[shown.mesh] = make_scene_mesh(mesh, "shuffled");
        hashes.push_back(film_of(scene, {{"accelerator", {"bvh2"}}}).hash());
        std::reverse(mesh.triangles.begin(), mesh.triangles.end());
        for (auto& triangle : mesh.triangles) {
            std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
        }
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], film_of(mixed_scene(), {{"accelerator", {"bvh2"}}}).hash());
}

TEST(MeshTest, ScaleByAPowerOfTwoIsNotInTheFilm) {
    const std::string hash = film_of(mixed_scene(), {{"accelerator", {"bvh2"}}}).hash();
    for (const int k : {-20, -3, 5, 30}) {
        EXPECT_EQ(film_of(test::scaled(mixed_scene(), std::ldexp(1.0, k)), {{"accelerator", {"bvh2"}}}).hash(), hash)
            << k;
    }
}

// A lamp of two triangles and the same one as a quad; connected by area, by solid angle, met only.
TEST(MeshTest, AMeshShinesAsTheShapeThatItIs) {
    const auto scene_with = [](bool is_mesh) {
        SceneBuilder builder;
        const std::uint32_t white = builder.diffuse(Vec3d(0.5)), lamp = builder.emitter(Vec3d(2));
        builder.quad(white, {0, -1, 2}, 4, 4);
        if (is_mesh) {
            Mesh square;
            square.vertices = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f}};
            square.triangles = {{0, 2, 1}, {0, 3, 2}};
            builder.mesh(lamp, make_scene_mesh(square, "square"), {0, 1, 2}, 1, {10, 0, 20});
        } else {
            builder.quad(lamp, {0, 1, 2}, 1, 1, {10, 0, 20});
        }
        builder.camera({0, 0, -1}, {0, -0.3, 1}).image(8, 8, 50, true).depth(3);
        return builder.scene;
    };
    const Scene mesh = scene_with(true), quad = scene_with(false);
    for (const bool final_bounce : {false, true}) {
        for (const bool next_event : {false, true}) {
            if (final_bounce && next_event) {
                continue;
            }
            for (const std::uint32_t mis_exponent : {0u, 2u}) {
                // The light of the lit floor itself counts where the last vertex is connected: no path meets a second
                // surface here.
                const test::RenderOptions options{.samples = 400,
                                                  .depth = final_bounce ? 1u : 3u,
                                                  .final_bounce = final_bounce,
                                                  .next_event = next_event,
                                                  .mis_exponent = next_event ? mis_exponent : 0};
                const auto a = test::mean_radiance<float>(mesh, options);
                const auto b = test::mean_radiance<float>(quad, options);
                // 5 standard errors of the difference: a chance of 6e-7 of failing, and the seed is fixed.
                const double error = std::hypot(a.channel[0].standard_error(), b.channel[0].standard_error());
                EXPECT_NEAR(a.channel[0].value(), b.channel[0].value(), 5 * error)
                    << final_bounce << next_event << mis_exponent;
                EXPECT_GT(a.channel[0].value(), 15 * error) << final_bounce << next_event << mis_exponent;
            }
        }
    }
}

TEST(MeshTest, BeyondAHundredThousandTrianglesATreeIsTheReference) {
    for (const bool is_large : {false, true}) {
        SceneBuilder builder;
        builder.mesh(builder.diffuse(Vec3d(0.5)), "teapot", is_large ? 40 : 39, {0, 0, 5}, 1);
        Variant variant = Registry::instance().baseline();
        variant.set("accelerator", "brute_force");
        EXPECT_EQ(reference_on(builder.scene, variant, Backend::cpu)["accelerator"], is_large ? "bvh2" : "brute_force");
    }
}

TEST(MeshTest, ARenderSaysWhatItsMeshesAre) {
    for (const std::string& accelerator : accelerators()) {
        RenderRequest request;
        request.variant = Registry::instance().baseline();
        request.variant.set("accelerator", accelerator);
        request.settings = default_settings(mixed_scene());
        const MeshFacts facts = render(mixed_scene(), request).meshes;
        // A sponge, a knot, one sphere for two objects, a box of 30.
        EXPECT_EQ(facts.triangles, 2u * (2 * 20 + 4 * 8) + 16 * 16 + 20 * 16 + 30);
        EXPECT_EQ(facts.leaf_bytes, facts.triangles * sizeof(LeafTriangle));
        const Choice* choice = Registry::instance().find("accelerator", accelerator);
        const bool has_tree = traits_in<AcceleratorTraits>(choice->descriptor).has_tree;
        EXPECT_EQ(facts.nodes > 0, has_tree) << accelerator;
        EXPECT_EQ(facts.sah_cost > 1, has_tree) << accelerator;
        EXPECT_EQ(facts.node_bytes > 80 * 10, has_tree) << accelerator;
    }
}

TEST(MeshTest, SeveralObjectsShareOneMesh) {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    for (int i = 0; i < 3; ++i) {
        builder.mesh(white, "icosphere", 4, {2.0 * i, 0, 5}, 1, {0, 0, 0});
    }
    const SceneBuffers<float> buffers(builder.scene, default_settings(builder.scene));
    ASSERT_EQ(buffers.view().meshes.size, 3u);
    EXPECT_EQ(buffers.view().meshes[0].geometry.triangles, buffers.view().meshes[2].geometry.triangles);
    EXPECT_EQ(buffers.view().meshes[0].is_placed, 0u);
    EXPECT_EQ(buffers.view().meshes[1].geometry.triangle_count, 20u * 256);
}

}  // namespace
}  // namespace pt
