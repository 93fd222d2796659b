// ptbench stability and ptbench replay as their users call them.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;
using nlohmann::json;

CommandResult stability(Arguments added, const TemporaryFolder& folder) {
    Arguments arguments{"stability", "--backend", "cpu", "--quick"};
    arguments.insert(arguments.end(), added.begin(), added.end());
    return ptbench(arguments, {.folder = folder.path()});
}

// A row names its variant by its identity; what that is stands once in the file.
const json& axes_of(const json& written, const json& row) {
    return written.at("variants").at(row.at("variant_id").get<std::string>()).at("axes");
}

TEST(StabilityCommandTest, RunsACaseAtAPointOfTheCallersChoice) {
    const TemporaryFolder folder;
    const CommandResult result =
        stability({"--case", "furnace_sphere", "--set", "k=2", "--set", "depth=3", "--axis", "integrator=depth_first",
                   "--axis", "precision=float,double", "--out", "stability.json"},
                  folder);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const json written = json::parse(content_of(folder.file("stability.json")));
    EXPECT_EQ(written.at("schema"), "ptbench-stability-1");
    EXPECT_EQ(written.at("context").at("ptbench.status"), "completed");
    ASSERT_EQ(written.at("rows").size(), 4u);  // two precisions, two quantities
    const json& row = written.at("rows").at(0);
    EXPECT_EQ(row.at("point").at("k"), 2);
    EXPECT_EQ(row.at("status"), "passed");
    EXPECT_EQ(row.at("exact"), 0.25 * (1 + 0.75 + 0.5625));
    EXPECT_EQ(row.at("measured"), row.at("exact"));
    EXPECT_EQ(axes_of(written, row).at("robustness"), "robust");
    EXPECT_EQ(axes_of(written, written.at("rows").at(2)).at("precision"), "double");
    EXPECT_NE(result.out.find("4 passed, 0 failed or broke that must pass"), std::string::npos) << result.out;
}

TEST(StabilityCommandTest, ResumesWithWhatIsThere) {
    const TemporaryFolder folder;
    const Arguments call{"--case", "furnace_sphere", "--axis", "integrator=depth_first", "--out", "stability.json"};
    EXPECT_EQ(stability(call, folder).exit_code, 0);
    const std::string first = content_of(folder.file("stability.json"));
    Arguments again = call;
    again.emplace_back("--resume");
    const CommandResult result = stability(again, folder);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out.find("furnace_sphere"), std::string::npos) << "ran again:\n" << result.out;
    EXPECT_EQ(json::parse(content_of(folder.file("stability.json"))).at("rows"), json::parse(first).at("rows"));
}

TEST(StabilityCommandTest, AResultWithAKeyTwiceIsNotGoneOnWith) {
    const TemporaryFolder folder;
    const std::string out = folder.file("s.json");
    write_text(out, R"({"schema": "ptbench-stability-1", "context": {}, "rows": [], "rows": []})");
    const CommandResult result = stability({"--case", "lamp", "--out", "s.json", "--resume"}, folder);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "ptbench: s.json: $: found the key \"rows\" twice, allowed: once\n");
}

// With what works in this process, and with processes that work for it.
TEST(StabilityCommandTest, AnInterruptLeavesWhatIsThereAndTheWayToGoOn) {
    for (const std::string jobs : {"1", "2"}) {
        SCOPED_TRACE(jobs + " jobs");
        const TemporaryFolder folder;
        const std::string out = folder.file("s.json");
        const Arguments call =
            ptbench_arguments({"stability", "--backend", "cpu", "--quick", "--jobs", jobs, "--out", out});  // all cases
        RunningCommand running(call, in_repository());
        ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(out) || !running.is_running(); }));
        const CommandResult second = run_command(call, in_repository());
        EXPECT_EQ(second.exit_code, 3);
        EXPECT_EQ(second.err, "ptbench: " + out + ".lock: another run is writing it\n");
        running.signal(SIGINT);
        ASSERT_TRUE(wait_until([&] { return !running.is_running(); }));
        const CommandResult ended = running.wait();
        EXPECT_EQ(ended.exit_code, 130) << ended.err;
        EXPECT_TRUE(ended.out.ends_with(" --quick --jobs " + jobs + " --out " + out + " --resume\n")) << ended.out;
        EXPECT_EQ(folder.content(), Arguments{"s.json"});
        const json cut = json::parse(content_of(out));
        EXPECT_EQ(cut.at("context").at("ptbench.status"), "interrupted");
        EXPECT_FALSE(cut.at("rows").empty());
    }
}

TEST(StabilityCommandTest, AuditedRowsSayWhatWasSeen) {
    const TemporaryFolder folder;
    EXPECT_EQ(stability({"--case", "S1", "--set", "depth=9", "--axis", "integrator=audited", "--out", "s.json"}, folder)
                  .exit_code,
              0);
    const json written = json::parse(content_of(folder.file("s.json")));
    const json& health = written.at("rows").at(0).at("health");
    EXPECT_EQ(health.at("segments").get<int>(), 9 * health.at("paths").get<int>());
    EXPECT_EQ(health.at("escaped"), 0);
    EXPECT_EQ(health.at("capped"), health.at("paths"));
    EXPECT_EQ(health.at("nonfinite"), json::object());
    EXPECT_LT(health.at("worst_direction").get<double>(), 1e-6);
}

TEST(StabilityCommandTest, ListsWithoutRunning) {
    const TemporaryFolder folder;
    const CommandResult result = stability({"--list", "--case", "lamp"}, folder);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out.find("S5   lamp "), 0u) << result.out;
    EXPECT_NE(result.out.find("--set a=0.1"), std::string::npos);
    EXPECT_EQ(result.out.find("passed"), std::string::npos);
}

void expect_refusal(const Arguments& arguments, const std::string& message) {
    const TemporaryFolder folder;
    const CommandResult result = ptbench(arguments, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err.find("ptbench: " + message), 0u) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(folder.content(), Arguments());
}

TEST(StabilityCommandTest, ScenesThatItWritesReplaceOthersOnlyWhereTheCallSaysSo) {
    const TemporaryFolder folder;
    std::vector<std::string> call{"stability", "--write-scenes", folder.path().string()};
    EXPECT_EQ(ptbench(call).exit_code, 0);
    const std::vector<std::string> files = folder.content();
    ASSERT_GT(files.size(), 1u);
    EXPECT_EQ(ptbench(call).exit_code, 0);  // the same
    const std::string last = folder.file(files.back());
    const std::string scene = content_of(last);
    write_text(last, "mine");
    std::filesystem::remove(folder.file(files.front()));
    const CommandResult refused = ptbench(call);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find("--overwrite, which replaces it, or another --write-scenes"), std::string::npos)
        << refused.err;
    EXPECT_EQ(folder.content().size(), files.size() - 1);
    EXPECT_EQ(content_of(last), "mine");
    call.emplace_back("--overwrite");
    write_text(last, "mine");
    EXPECT_EQ(ptbench(call).exit_code, 0);
    EXPECT_EQ(content_of(last), scene);
    EXPECT_EQ(folder.content(), files);
}

TEST(StabilityCommandTest, RefusesWhatItDoesNotKnow) {
    const Arguments call{"stability", "--backend", "cpu", "--out", "s.json"};
    const auto with = [&](Arguments added) {
        added.insert(added.begin(), call.begin(), call.end());
        return added;
    };
    expect_refusal(with({"--case", "nope"}), "--case: name: found \"nope\", allowed: furnace_sphere");
    expect_refusal(with({"--family", "nope"}), "--family: name: found \"nope\", allowed: cavities");
    expect_refusal(with({"--case", "lamp", "--set", "a"}), "--set: argument: found \"a\", allowed: NAME=NUMBER");
    expect_refusal(with({"--case", "lamp", "--set", "a=x"}), "--set: argument: found \"a=x\", allowed: NAME=NUMBER");
    expect_refusal(with({"--case", "lamp", "--set", "b=1"}), "--set: lamp: found parameter \"b\", allowed: a, albedo");
    expect_refusal(with({"--case", "lamp", "--set", "a=2"}), "--set: lamp: found a=2, allowed: 1e-06 to 0.45");
    expect_refusal(with({"--set", "a=0.1"}), "--set: argument: found ");
    expect_refusal(with({"--axis", "robustness=nope"}), "--axis");
}

TEST(ReplayCommandTest, ShowsBothPrecisionsSegmentBySegment) {
    const TemporaryFolder folder;
    const CommandResult result =
        ptbench({"replay", "--scene", "cornell_open", "--resolution", "16x16", "--pixel", "8,8", "--sample", "3"},
                {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out.find("cornell_open pixel 8,8 sample 3 seed 1, depth_first specialisation=generic\n"), 0u)
        << result.out;
    EXPECT_NE(result.out.find("segment 1\n  float   "), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("\n  double  "), std::string::npos);
    EXPECT_NE(result.out.find("both go the same way"), std::string::npos);
}

// A mirror ball on a ground sphere of a million times its size.
constexpr const char* huge_ground = R"({"name": "ground", "max_depth": 6, "environment": [1, 1, 1],
  "camera": {"eye": [0, 1.3, -4], "look_at": [0, 0.5, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60,
             "resolution": [16, 16]},
  "materials": {"ground": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]},
                "ball": {"type": "mirror", "reflectance": [0.9, 0.9, 0.9]}},
  "objects": [{"shape": "sphere", "material": "ground", "translate": [0, -1000000, 0], "scale": 2000000},
              {"shape": "sphere", "material": "ball", "translate": [0, 0.5, 0], "scale": 1}]})";

TEST(ReplayCommandTest, CountsPathsThatPart) {
    const TemporaryFolder folder;
    write_text(folder.file("ground.json"), huge_ground);
    const auto parted = [&](const std::string& choice) {
        const CommandResult result = ptbench(
            {"replay", "--scene", "ground.json", "--diverging", "16", "--axis", choice}, {.folder = folder.path()});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_NE(result.out.find(" of 4096 paths go another way"), std::string::npos) << result.out;
        return std::stoi(result.out);
    };
    EXPECT_GT(parted("robustness=naive"), 10);
    // Both have the ground by the eye's power (kernels/shapes/sphere.h): so near to double that no path goes another
    // way.
    EXPECT_EQ(parted("robustness=robust"), 0);
    EXPECT_EQ(parted("precision=double_intersection"), 0);
}

TEST(ReplayCommandTest, RefusesWhatItCannotShow) {
    expect_refusal({"replay", "--scene", "cornell_open"}, "replay: arguments: found neither --pixel nor --diverging");
    for (const std::string pixel : {"8", "8,", "800,0", "-1,0", "a,b", "1,2,3"}) {
        expect_refusal({"replay", "--scene", "cornell_open", "--pixel=" + pixel},
                       "--pixel: argument: found \"" + pixel + "\", allowed: X,Y with X below 800 and Y below 800");
    }
}

}  // namespace
}  // namespace pt::test
