// Which accelerator and light sampling a call gets that names none, and that a suite's cells stay what they are.
#include "harness/bench/fastest.h"

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/scenes.h"
#include "variants/registry.h"

namespace pt {
namespace {

// Balls of 80 triangles each.
Scene balls(int count) {
    test::SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    for (int i = 0; i < count; ++i) {
        builder.mesh(white, "icosphere", 1, {3.0 * i, 0, 5}, 1);
    }
    return builder.scene;
}

AxisChoices chosen(const AxisChoices& axes, int count) { return with_tree(axes, {}, balls(count), Backend::cpu); }

TEST(WithTreeTest, FromAFewHundredTrianglesOn) {
    EXPECT_EQ(triangles_of(balls(3)), 240u);
    EXPECT_EQ(chosen({}, 0), AxisChoices());
    EXPECT_EQ(chosen({}, 3), AxisChoices());
    EXPECT_EQ(chosen({}, 4), (AxisChoices{{"accelerator", {"bvh8"}}}));
    EXPECT_EQ(tree_in_words({}, {}, balls(3), Backend::cpu), "");
    EXPECT_EQ(tree_in_words({}, {}, balls(4), Backend::cpu), "accelerator=bvh8 for its 320 triangles");
}

TEST(WithTreeTest, OverManyObjectsOneMore) {
    EXPECT_EQ(chosen({}, 16), (AxisChoices{{"accelerator", {"bvh8"}}}));
    EXPECT_EQ(chosen({}, 17), (AxisChoices{{"accelerator", {"bvh8"}}, {"levels", {"two_level"}}}));
    EXPECT_EQ(chosen({{"levels", {"each_object"}}}, 17),
              (AxisChoices{{"accelerator", {"bvh8"}}, {"levels", {"each_object"}}}));
    EXPECT_EQ(tree_in_words({}, {}, balls(17), Backend::cpu),
              "accelerator=bvh8 and levels=two_level for its 1360 triangles");
}

TEST(WithTreeTest, AGpuHasATreeOfItsOwn) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "this build has no CUDA";
    }
    EXPECT_EQ(with_tree({}, {}, balls(3), Backend::cuda), AxisChoices());
    EXPECT_EQ(with_tree({}, {}, balls(4), Backend::cuda), (AxisChoices{{"accelerator", {"cwbvh"}}}));
}

TEST(WithTreeTest, WhatTheCallNamesStays) {
    const AxisChoices named{{"accelerator", {"brute_force", "bvh2"}}};
    EXPECT_EQ(chosen(named, 4), named);
    EXPECT_EQ(chosen({{"builder", {"lbvh"}}}, 4), (AxisChoices{{"accelerator", {"bvh8"}}, {"builder", {"lbvh"}}}));
}

// The choice of light_sampling that a variant with this direct_light gets over a room of boxes, and over a ball alone.
std::string drawn_by(const std::string& direct_light, const AxisChoices& named, bool has_boxes) {
    test::SceneBuilder builder;
    builder.sphere(builder.emitter(Vec3d(1)), {0, 3, 0}, 1);
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, 0, 0}, 1);
    if (has_boxes) {
        builder.box(builder.emitter(Vec3d(1)), {0, 5, 0}, Vec3d(1));
    }
    Variant variant = Registry::instance().baseline();
    variant.set("direct_light", direct_light);
    for (const auto& [axis, choices] : named) {
        variant.set(axis, choices.front());
    }
    variant = with_light_sampling(variant, named, features_of(builder.scene), Backend::cpu);
    const bool is_told = !light_sampling_in_words(variant, named).empty();
    EXPECT_EQ(is_told, variant["light_sampling"] == "auto" && !named.contains("light_sampling"));
    return variant["light_sampling"];
}

TEST(WithLightSamplingTest, WhereACallConnectsLightsAndNamesNone) {
    for (const char* const connected : {"nee", "nee_mis", "nee_one_sample"}) {
        EXPECT_EQ(drawn_by(connected, {}, true), "auto");
        EXPECT_EQ(drawn_by(connected, {}, false), "solid_angle") << "nothing to draw on a face";
        EXPECT_EQ(drawn_by(connected, {{"light_sampling", {"solid_angle"}}}, true), "solid_angle");
        EXPECT_EQ(drawn_by(connected, {{"light_sampling", {"projected"}}}, true), "projected");
        EXPECT_EQ(drawn_by(connected, {{"light_sampling", {"auto"}}}, true), "auto");
    }
    EXPECT_EQ(drawn_by("off", {}, true), "solid_angle");
}

TEST(WithLightSamplingTest, NotInASuite) {
    Study study;
    study.name = "adhoc";
    study.scenes = {"cornell_open"};
    study.axes = {{"integrator", {"depth_first"}}, {"direct_light", {"off", "nee_mis"}}};
    Suite suite{.name = "adhoc", .description = "", .studies = {study}};
    const auto drawn = [&] {
        std::vector<std::string> found;
        for (const Cell& cell : make_plan(suite).cells) {
            found.push_back(cell.variant["direct_light"] + " " + cell.variant["light_sampling"]);
        }
        return found;
    };
    EXPECT_EQ(drawn(), (std::vector<std::string>{"off solid_angle", "nee_mis solid_angle"}));
    EXPECT_EQ(make_plan(suite).chosen, std::vector<std::string>());
    suite.studies[0].is_of_a_call = true;
    EXPECT_EQ(drawn(), (std::vector<std::string>{"off solid_angle", "nee_mis auto"}));
    EXPECT_EQ(make_plan(suite).chosen,
              std::vector<std::string>{"cornell_open: light_sampling=auto for its connections"});
}

TEST(WithTreeTest, ASuiteThatSaysNothingHasTheBaseline) {
    const test::TemporaryFolder folder;
    const auto scene = [&](const std::string& name, int size) {
        test::write_text(folder.file(name), R"({"name": ")" + name.substr(0, 4) +
                                                R"(", "max_depth": 3, "environment": [1, 1, 1],
            "camera": {"eye": [0, 0, 4], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40, "resolution": [16, 16]},
            "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
            "objects": [{"shape": "mesh", "generate": {"mesh": "icosphere", "size": )" +
                                                std::to_string(size) + R"(}, "material": "white"}]})");
        return folder.file(name);
    };
    Study study;
    study.name = "adhoc";
    study.scenes = {scene("few_.json", 1), scene("many.json", 2)};
    study.axes = {{"integrator", {"wavefront", "depth_first"}}};
    Suite suite{.name = "adhoc", .description = "", .studies = {study}};
    const auto accelerators = [&] {
        std::vector<std::string> found;
        for (const Cell& cell : make_plan(suite).cells) {
            found.push_back(cell.scene->name + " " + cell.variant["integrator"] + " " + cell.variant["accelerator"]);
        }
        return found;
    };
    EXPECT_EQ(accelerators(), (std::vector<std::string>{"few_ wavefront brute_force", "few_ depth_first brute_force",
                                                        "many wavefront brute_force", "many depth_first brute_force"}));
    EXPECT_EQ(make_plan(suite).chosen, std::vector<std::string>());
    suite.studies[0].is_of_a_call = true;
    EXPECT_EQ(accelerators(), (std::vector<std::string>{"few_ wavefront brute_force", "few_ depth_first brute_force",
                                                        "many wavefront bvh8", "many depth_first bvh8"}));
    EXPECT_EQ(make_plan(suite).chosen, std::vector<std::string>{"many: accelerator=bvh8 for its 320 triangles"});
}

}  // namespace
}  // namespace pt
