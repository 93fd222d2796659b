// rays as a user calls it, on the CPU: accelerators agree, files go round, bad calls are one line.
#include <algorithm>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "harness/mesh/read_mesh.h"
#include "harness/rays/ray_file.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

CommandResult rays_in(const TemporaryFolder& folder, const Arguments& added) {
    Arguments arguments{"rays", "--backend", "cpu", "--repetitions", "1"};
    if (std::find(added.begin(), added.end(), "--log2-rays") == added.end()) {
        arguments.insert(arguments.end(), {"--log2-rays", "7"});
    }
    arguments.insert(arguments.end(), added.begin(), added.end());
    return ptbench(arguments, {.folder = folder.path(), .environment = {{"PTBENCH_HOME", test::source_folder()}}});
}

// class -> every checksum that a batch of it has.
std::map<std::string, std::set<std::string>> checksums_in(const Json& result) {
    std::map<std::string, std::set<std::string>> sums;
    for (const Json& tree : result["meshes"][0]["trees"]) {
        for (const Json& batch : tree["batches"]) {
            sums[batch["class"]].insert(batch["checksum"].get<std::string>());
            EXPECT_EQ(batch["differ_from_brute_force"], 0) << batch;
        }
    }
    return sums;
}

TEST(RaysCommandTest, AcceleratorsAndBuildersMeetTheSame) {
    const TemporaryFolder folder;
    const CommandResult result =
        rays_in(folder, {"--mesh", "icosphere:1", "--accelerator", "brute_force,bvh2,bvh4,bvh8,cwbvh", "--builder",
                         "sah_binned,sah_sweep,sbvh,lbvh,ploc", "--out", "rays.json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json json = Json::parse(content_of(folder.file("rays.json")));
    EXPECT_EQ(json["schema"], "ptbench-rays-1");
    EXPECT_EQ(json["meshes"][0]["triangles"], 80 + 12);
    EXPECT_EQ(json["meshes"][0]["trees"].size(), 1 + 4 * 5);
    const auto sums = checksums_in(json);
    EXPECT_EQ(sums.size(), 6);
    for (const auto& [name, of_class] : sums) {
        EXPECT_EQ(of_class.size(), 1) << name;
    }
    for (const Json& set : json["meshes"][0]["ray_sets"]) {
        EXPECT_EQ(set["checked"], 128);
        // The box is closed: a ray that no distance ends meets something.
        EXPECT_TRUE(set["any"].get<bool>() || set["hits"] == 128) << set;
    }
}

TEST(RaysCommandTest, AFileOfRaysAndItsMeshGiveTheSameHits) {
    const TemporaryFolder folder;
    const Arguments tree{"--accelerator", "cwbvh", "--class", "shadow,diffuse_3"};
    Arguments first{"--mesh", "icosphere:1", "--write-rays", "a.rays", "--write-mesh", "a.ply", "--out", "a.json"};
    Arguments second{"--mesh", "a.ply", "--read-rays", "a.rays", "--write-rays", "b.rays", "--out", "b.json"};
    for (Arguments* arguments : {&first, &second}) {
        arguments->insert(arguments->end(), tree.begin(), tree.end());
        const CommandResult result = rays_in(folder, *arguments);
        ASSERT_EQ(result.exit_code, 0) << result.err;
    }
    EXPECT_EQ(content_of(folder.file("a.rays")), content_of(folder.file("b.rays")));
    const Json a = Json::parse(content_of(folder.file("a.json"))), b = Json::parse(content_of(folder.file("b.json")));
    EXPECT_EQ(checksums_in(a), checksums_in(b));
    EXPECT_EQ(checksums_in(a).size(), 2);
    EXPECT_EQ(read_mesh(folder.file("a.ply")).triangles.size(), 92);
    const std::vector<rays::RaySet> sets = rays::read_rays(folder.file("a.rays"));
    ASSERT_EQ(sets.size(), 2);
    EXPECT_EQ(sets[0].name, "shadow");
    EXPECT_TRUE(sets[0].any);
    EXPECT_EQ(sets[1].rays.size(), 128);
}

TEST(RaysCommandTest, AScenesMeshesAreSeenByItsCamera) {
    const TemporaryFolder folder;
    const CommandResult result = rays_in(folder, {"--scene", test::in_source("scenes/meshes/teapot_room.json"),
                                                  "--check", "2", "--class", "primary", "--out", "s.json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json json = Json::parse(content_of(folder.file("s.json")));
    EXPECT_GT(json["meshes"][0]["ray_sets"][0]["hits"], 0);
}

TEST(RaysCommandTest, ABadCallIsOneLineAndWritesNothing) {
    const TemporaryFolder folder;
    const auto refusal = [&](const Arguments& added) {
        const CommandResult result = rays_in(folder, added);
        EXPECT_EQ(result.exit_code, 2) << result.out;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        return result.err;
    };
    EXPECT_EQ(refusal({}), "ptbench: rays: --mesh: found none, allowed: --mesh NAME:SIZE|FILE,.. or --scene S,..\n");
    EXPECT_NE(refusal({"--mesh", "sphere_262"}).find("did you mean \"sphere_262k\"?"), std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:x"}).find("NAME:SIZE, SIZE a whole number"), std::string::npos);
    EXPECT_NE(refusal({"--mesh", "none.ply"}).find("none.ply"), std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:1", "--accelerator", "bvh3"}).find("--accelerator: name: found \"bvh3\""),
              std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:1", "--class", "primry"}).find("did you mean \"primary\"?"),
              std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:1,icosphere:2", "--write-rays", "a.rays"}).find("allowed: one mesh"),
              std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:1", "--log2-rays", "40"}).find("--log2-rays"), std::string::npos);
    for (const char* flag : {"--counters", "--counted"}) {
        EXPECT_EQ(refusal({"--mesh", "icosphere:1", flag}),
                  "ptbench: rays: --counters: found --backend cpu, allowed: --backend cuda: counters are a GPU's\n");
    }
    EXPECT_EQ(refusal({"--leaks", "--mesh", "icosphere:1", "--counters"}),
              "ptbench: rays: --counters: found it with --leaks, allowed: one of them\n");
    EXPECT_TRUE(folder.content().empty());
}

TEST(RaysCommandTest, NoRayLeavesAClosedMesh) {
    const TemporaryFolder folder;
    const CommandResult result =
        rays_in(folder, {"--leaks", "--mesh", "icosphere:2,menger:1", "--accelerator", "bvh2,cwbvh", "--builder",
                         "sah_binned,lbvh", "--first-ray", "1000", "--log2-rays", "12", "--out", "leaks.json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json json = Json::parse(content_of(folder.file("leaks.json")));
    EXPECT_EQ(json["schema"], "ptbench-leaks-1");
    ASSERT_EQ(json["meshes"].size(), 2);
    EXPECT_EQ(json["meshes"][0]["triangles"], 320);  // no box
    ASSERT_EQ(json["meshes"][0]["trees"].size(), 4);
    for (const Json& kernel : json["meshes"][1]["trees"][3]["kernels"]) {
        EXPECT_EQ(kernel["rays"], 4096);
        EXPECT_EQ(kernel["leaks"], 0);
        EXPECT_EQ(kernel["classes"].size(), 7);
    }
}

TEST(RaysCommandTest, LeaksAreOfClosedMeshesAlone) {
    const TemporaryFolder folder;
    const auto refusal = [&](const Arguments& added) {
        const CommandResult result = rays_in(folder, added);
        EXPECT_EQ(result.exit_code, 2) << result.out;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        return result.err;
    };
    EXPECT_NE(refusal({"--leaks", "--mesh", "needles:9"}).find("found a mesh that is not closed"), std::string::npos);
    EXPECT_NE(refusal({"--leaks", "--mesh", "sphere_262k"}).find("allowed: NAME:SIZE"), std::string::npos);
    EXPECT_NE(refusal({"--leaks", "--mesh", "icosphere:1", "--class", "primary"}).find("--class"), std::string::npos);
    EXPECT_NE(refusal({"--mesh", "icosphere:1", "--first-ray", "7"}).find("--first-ray"), std::string::npos);
    EXPECT_TRUE(folder.content().empty());
}

TEST(RaysCommandTest, ABrokenFileOfRaysIsOneLine) {
    const TemporaryFolder folder;
    ASSERT_EQ(rays_in(folder, {"--mesh", "icosphere:0", "--class", "primary", "--write-rays", "a.rays"}).exit_code, 0);
    const std::string good = content_of(folder.file("a.rays"));
    const auto refusal = [&](const std::string& content) {
        write_text(folder.file("b.rays"), content);
        const CommandResult result = rays_in(folder, {"--mesh", "icosphere:0", "--read-rays", "b.rays"});
        EXPECT_EQ(result.exit_code, 2) << result.out;
        return result.err;
    };
    EXPECT_NE(refusal("").find("b.rays: byte 0: found 0 bytes left"), std::string::npos);
    EXPECT_NE(refusal("x" + good.substr(1)).find("another kind of file"), std::string::npos);
    EXPECT_NE(refusal(good.substr(0, good.size() - 1)).find("127 whole rays, allowed: 128"), std::string::npos);
    EXPECT_NE(refusal(good + "x").find("1 bytes after the last set"), std::string::npos);
    std::string not_a_number = good;
    not_a_number.replace(64, 4, "\xff\xff\xff\xff");
    EXPECT_NE(refusal(not_a_number).find("set 0, ray 0"), std::string::npos);
}

}  // namespace
}  // namespace pt::test
