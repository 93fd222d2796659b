// Copies of an object by a rule: how many, where, and how a scene's file asks for them.
#include "harness/scene/instances.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace pt {
namespace {

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

TEST(InstancesTest, ASphereflakeHasNineSpheresOnEverySphere) {
    std::size_t expected = 0, of_level = 1;
    for (std::uint32_t levels = 0; levels <= 4; ++levels) {
        expected += of_level;
        of_level *= 9;
        EXPECT_EQ(sphereflake(levels).size(), expected);
    }
    EXPECT_EQ(sphereflake(3).size(), 820u);
}

TEST(InstancesTest, EveryChildOfASphereflakeTouchesItsParentAndNoSibling) {
    const std::vector<Copy> all = sphereflake(3);
    EXPECT_EQ(all[0].offset, Vec3d(0.0));
    EXPECT_EQ(all[0].scale, 1);
    for (std::size_t i = 1; i < all.size(); ++i) {
        const Copy& parent = all[(i - 1) / 9];
        EXPECT_EQ(all[i].scale, parent.scale / 3);
        EXPECT_NEAR(length(all[i].offset - parent.offset), parent.scale * 4 / 3, 1e-14) << i;
        for (std::size_t j = 1 + (i - 1) / 9 * 9; j < i; ++j) {
            EXPECT_GT(length(all[i].offset - all[j].offset), 2 * all[i].scale * (1 - 1e-14)) << i << " " << j;
        }
    }
    // Six round the equator, three above; y is up.
    for (std::size_t i = 1; i <= 9; ++i) {
        EXPECT_NEAR(all[i].offset.y, i <= 6 ? 0 : 4.0 / 3 * std::sqrt(2.0 / 3), 1e-15) << i;
    }
}

TEST(InstancesTest, AFieldIsASquareOfTurnedCopies) {
    const std::vector<Copy> all = field(100, 0.5, 1);
    ASSERT_EQ(all.size(), 10000u);
    EXPECT_EQ(all.front().offset, Vec3d(-24.75, 0, -24.75));
    EXPECT_EQ(all.back().offset, Vec3d(24.75, 0, 24.75));
    EXPECT_EQ(all[1].offset, Vec3d(-24.25, 0, -24.75));
    std::set<double> turns;
    double sum = 0;
    for (const Copy& copy : all) {
        EXPECT_EQ(copy.scale, 1);
        turns.insert(copy.turn_degrees);
        sum += copy.turn_degrees;
    }
    EXPECT_EQ(turns.size(), 10000u);
    EXPECT_GE(*turns.begin(), 0);
    EXPECT_LT(*turns.rbegin(), 360);
    // 5 standard errors of the mean of 10,000 even numbers.
    EXPECT_NEAR(sum / 10000, 180, 5 * 360 / std::sqrt(12.0 * 10000));
    EXPECT_EQ(field(100, 0.5, 1)[7].turn_degrees, all[7].turn_degrees);
    EXPECT_NE(field(100, 0.5, 2)[7].turn_degrees, all[7].turn_degrees);
}

std::string scene_with(const std::string& object) {
    return R"({"name": "s", "max_depth": 2, "camera": {"eye": [0, 0, -5], "look_at": [0, 0, 0], "up": [0, 1, 0],
        "vertical_fov_degrees": 60, "resolution": [4, 4]}, "materials": {"m": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
        "objects": [{"shape": "sphere", "material": "m"}, {"material": "m", )" +
           object + "}]}";
}

const std::string ball = R"("shape": "mesh", "generate": {"mesh": "icosphere", "size": 0})";

std::string error_of(const std::string& object) {
    try {
        parse_scene(scene_with(object), "s.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(InstancesTest, AFileAsksForThem) {
    const Scene scene = parse_scene(
        scene_with(ball +
                   R"(, "instances": {"generate": "sphereflake", "levels": 2}, "translate": [1, 2, 3], "scale": 2,
            "rotate_degrees": [10, 20, 30], "velocity": [0, 1, 0])"),
        "s.json");
    ASSERT_EQ(scene.objects.size(), 1u + 91);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.objects[1].translate, Vec3d(1, 2, 3));
    EXPECT_EQ(scene.objects[1].scale, Vec3d(2.0));
    EXPECT_EQ(scene.objects[2].scale, Vec3d(2.0 * (1.0 / 3)));
    EXPECT_NEAR(length(scene.objects[2].translate - Vec3d(1, 2, 3)), 8.0 / 3, 1e-15);
    EXPECT_EQ(scene.objects[91].rotate_degrees, Vec3d(10, 20, 30));
    EXPECT_EQ(scene.objects[91].velocity, Vec3d(0, 1, 0));

    const std::string field_of_9 =
        R"("instances": {"generate": "field", "side": 3, "spacing": 4, "seed": 7}, "scale": 2,)";
    const Scene turned = parse_scene(scene_with(field_of_9 + ball + R"(, "rotate_degrees": [10, 20, 30])"), "s.json");
    ASSERT_EQ(turned.objects.size(), 10u);
    EXPECT_EQ(turned.objects[1].translate, Vec3d(-4, 0, -4));
    EXPECT_EQ(turned.objects[1].rotate_degrees, Vec3d(10, 20 + field(3, 4, 7)[0].turn_degrees, 30));
}

TEST(InstancesTest, WhatARuleMakesIsPartOfTheScenesHash) {
    std::set<std::string> hashes;
    for (const char* rule : {"", R"(, "instances": {"generate": "sphereflake", "levels": 1})",
                             R"(, "instances": {"generate": "sphereflake", "levels": 2})",
                             R"(, "instances": {"generate": "field", "side": 3, "spacing": 4, "seed": 1})",
                             R"(, "instances": {"generate": "field", "side": 3, "spacing": 4, "seed": 2})"}) {
        EXPECT_TRUE(hashes.insert(parse_scene(scene_with(ball + rule), "s.json").hash).second) << rule;
    }
}

TEST(InstancesTest, FaultsHaveTheirPlace) {
    const auto expect = [](const std::string& object, const std::string& place, const std::string& allowed) {
        const std::string error = error_of(object);
        EXPECT_NE(error.find("s.json: " + place), std::string::npos) << error;
        EXPECT_NE(error.find(allowed), std::string::npos) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    };
    const std::string at = "$.objects[1].instances";
    expect(ball + R"(, "instances": {"generate": "spiral"})", at + ".generate", "\"sphereflake\", \"field\"");
    expect(ball + R"(, "instances": 3)", at, "an object");
    expect(ball + R"(, "instances": {"levels": 3})", at, "generate");
    expect(ball + R"(, "instances": {"generate": "sphereflake", "levels": 6})", at + ".levels", "from 0 to 5");
    expect(ball + R"(, "instances": {"generate": "sphereflake"})", at, "levels");
    expect(ball + R"(, "instances": {"generate": "sphereflake", "levels": 1, "side": 2})", at, "generate, levels");
    expect(ball + R"(, "instances": {"generate": "field", "side": 0, "spacing": 1})", at + ".side", "from 1 to 512");
    expect(ball + R"(, "instances": {"generate": "field", "side": 2, "spacing": -1})", at + ".spacing",
           "1e-18 to 1e15");
    expect(ball + R"(, "instances": {"generate": "field", "side": 2, "spacing": 1, "seed": 0.5})", at + ".seed",
           "a whole number");
    expect(ball + R"(, "scale": [1, 2, 1], "instances": {"generate": "sphereflake", "levels": 1})",
           "$.objects[1].scale", "one number, with instances");
    expect(ball + R"(, "scale": 1e-17, "instances": {"generate": "sphereflake", "levels": 3})", at, "1e-18");
    expect(R"("shape": "sphere", "instances": {"generate": "sphereflake", "levels": 1})", "$.objects[1]", "shape");
}

}  // namespace
}  // namespace pt
