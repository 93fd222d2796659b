// `ptbench passport`: two runs in one file, what an interrupt leaves, and what is refused. The suite is a small one.
#include <bit>
#include <csignal>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

constexpr const char* tiny_scene = R"({
  "name": "tiny", "max_depth": 3, "environment": [1, 1, 1],
  "camera": {"eye": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [8, 6]},
  "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
  "objects": [{"shape": "box", "material": "white", "translate": [0, 0, 3], "rotate_degrees": [10, 20, 30]}]
})";
constexpr const char* tiny_suite = R"({
  "name": "passport", "description": "A test's.", "repetitions": 3,
  "studies": [{"name": "compaction", "compares": "compaction", "title": "Compacting a queue", "scenes": ["tiny"],
               "axes": {"integrator": ["wavefront"], "compaction": ["none", "thrust_remove_if"]}, "spp": 1}]
})";

class PassportTest : public testing::Test {
protected:
    TemporaryFolder home, folder;
    std::string out = folder.file("passport.json");
    std::string parts = out + ".parts";

    void SetUp() override {
        std::filesystem::create_directories(home.path() / "scenes" / "suites");
        write_text(home.file("scenes/tiny.json"), tiny_scene);
        write_text(home.file("scenes/suites/passport.json"), tiny_suite);
    }
    Arguments command(const Arguments& added = {}) const {
        Arguments words{program_file(), "passport", "--backend", "cpu", "--quiet", "--out", out};
        words.insert(words.end(), added.begin(), added.end());
        return words;
    }
    CommandOptions here() const {
        return {.environment = {{"PTBENCH_HOME", home.path().string()}, {"OMP_NUM_THREADS", "2"}}};
    }
    CommandResult passport(const Arguments& added = {}) const { return run_command(command(added), here()); }
    json content() const { return json::parse(content_of(out)); }
};

std::set<std::uint64_t> seeds_of(const json& run) {
    std::set<std::uint64_t> seeds;
    for (const json& row : run.at("benchmarks")) {
        if (row.at("run_type") == "iteration") {
            seeds.insert(row.at("pt_seed").get<std::uint64_t>());
        }
    }
    return seeds;
}

TEST_F(PassportTest, HoldsTwoRunsOfTheSuiteAtOneNumberOfSamples) {
    const CommandResult made = passport();
    ASSERT_EQ(made.exit_code, 0) << made.err << made.out;
    EXPECT_NE(made.out.find("page: python3 -m ptbench passport " + out + "\n"), std::string::npos) << made.out;
    EXPECT_EQ(folder.content(), Arguments{"passport.json"});
    const json file = content();
    EXPECT_EQ(file.at("schema"), "ptbench-passport-1");
    EXPECT_EQ(file.at("chip").at("cpu").at("threads"), 2);
    ASSERT_EQ(file.at("runs").size(), 2u);
    const auto spp = file.at("spp").at("compaction").get<std::uint32_t>();
    EXPECT_TRUE(std::has_single_bit(spp)) << spp;
    EXPECT_GT(spp, 16u);  // 48 pixels
    std::set<std::uint64_t> seeds;
    for (const json& run : file.at("runs")) {
        EXPECT_EQ(run.at("context").at("ptbench.status"), "completed");
        EXPECT_EQ(run.at("context").at("ptbench.suite"), "passport");
        EXPECT_EQ(run.at("ptbench").at("cells").size(), 2u);
        for (const json& cell : run.at("ptbench").at("cells")) {
            EXPECT_EQ(cell.at("spp"), spp);
        }
        seeds.merge(seeds_of(run));
    }
    EXPECT_GE(seeds.size(), 6u);  // no sample of one run is a sample of the other
}

TEST_F(PassportTest, AnInterruptedOneGoesOnAsItBegan) {
    RunningCommand interrupted(command(), here());
    ASSERT_TRUE(wait_until(
        [&] { return std::filesystem::exists(parts + "/second.json.journal.jsonl") || !interrupted.is_running(); }));
    interrupted.signal(SIGINT);
    EXPECT_EQ(interrupted.wait().exit_code, 130);
    EXPECT_FALSE(std::filesystem::exists(out));
    const std::string about = content_of(parts + "/about.json"), first = content_of(parts + "/first.json");
    ASSERT_FALSE(first.empty());

    const CommandResult refused = passport();
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find(parts + ": passport: found an unfinished one, allowed: --resume"), std::string::npos)
        << refused.err;
    EXPECT_EQ(content_of(parts + "/first.json"), first);

    const CommandResult resumed = passport({"--resume"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(folder.content(), Arguments{"passport.json"});
    EXPECT_EQ(content().at("spp"), json::parse(about).at("spp"));
    EXPECT_EQ(content().at("chip"), json::parse(about).at("chip"));
    EXPECT_EQ(content().at("runs").at(0), json::parse(first));
}

TEST_F(PassportTest, RefusesWhatItWouldLose) {
    const CommandResult nothing = passport({"--resume"});
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_NE(nothing.err.find("--resume: passport: found no unfinished one at " + parts), std::string::npos)
        << nothing.err;
    for (const Arguments& added : {Arguments{}, Arguments{"--overwrite"}}) {
        write_text(out, "mine\n");
        const CommandResult there = passport(added);
        EXPECT_EQ(there.exit_code, 2);
        EXPECT_EQ(content_of(out), "mine\n");
        write_text(out, R"({"schema": "ptbench-passport-1"})");
    }
    const CommandResult there = passport();
    EXPECT_EQ(there.exit_code, 2);
    EXPECT_NE(there.err.find("output file: found a passport, allowed: --overwrite, or another name"), std::string::npos)
        << there.err;
    EXPECT_EQ(folder.content(), Arguments{"passport.json"});
}

// A folder without about.json is what a full disk or a kill at the first write leaves.
TEST_F(PassportTest, AnEmptyFolderOfPartsIsNoBegunPassport) {
    std::filesystem::create_directories(parts);
    EXPECT_EQ(passport({"--resume"}).exit_code, 2);
    EXPECT_EQ(passport().exit_code, 0);
    EXPECT_EQ(folder.content(), Arguments{"passport.json"});
}

TEST_F(PassportTest, AnotherMachinesOrProgramsIsNotGoneOnWith) {
    RunningCommand interrupted(command(), here());
    ASSERT_TRUE(
        wait_until([&] { return std::filesystem::exists(parts + "/about.json") || !interrupted.is_running(); }));
    interrupted.signal(SIGINT);
    interrupted.wait();
    const json about = json::parse(content_of(parts + "/about.json"));
    for (const char* key : {"program", "machine", "host", "backend"}) {
        json changed = about;
        changed["begun_by"][key] = "another";
        write_text(parts + "/about.json", changed.dump());
        const CommandResult refused = passport({"--resume"});
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_NE(refused.err.find(std::string("about.json: $.begun_by.") + key + ": found \"another\", allowed: "),
                  std::string::npos)
            << refused.err;
    }
    json changed = about;
    changed["spp"]["compaction"] = 0;
    write_text(parts + "/about.json", changed.dump());
    const CommandResult refused = passport({"--resume"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find("about.json: $.spp.compaction: found 0, allowed: 1 to 4096"), std::string::npos)
        << refused.err;
}

}  // namespace
}  // namespace pt::test
