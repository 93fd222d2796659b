// Variants that are wrong on purpose (tests/wrong) in runs with right ones, the wrong one first: it alone fails,
// whatever the seed, with a reason that says where. And what is left of a run, and goes on, where one crashes.
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

class WrongVariantsTest : public testing::Test {
protected:
    TemporaryFolder folder;
    std::string out = folder.file("result.json");
    std::string journal = out + ".journal.jsonl";
    // 80 compactions, where the verification before a run has 8; a crash needs fewer.
    std::string resolution = "40x40", spp = "20";

    CommandResult call(Arguments arguments, const std::string& crash_in_render = "0") const {
        arguments.insert(arguments.begin(), program_with_wrong_variants());
        return run_command(arguments, in_repository({.environment = {{"PTBENCH_CRASH_IN_RENDER", crash_in_render}}}));
    }
    CommandResult run(const std::string& compactions, const Arguments& more = {},
                      const std::string& crash_in_render = "0") const {
        Arguments arguments{"run",
                            "--scene=cornell_closed",
                            "--backend=cpu",
                            "--depth=5",
                            "--repetitions=3",
                            "--quiet",
                            "--resolution=" + resolution,
                            "--spp=" + spp,
                            "--out=" + out,
                            "--axis=compaction=" + compactions,
                            "--benchmark_enable_random_interleaving=false"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return call(arguments, crash_in_render);
    }
    json result() const { return json::parse(content_of(out)); }
    // The status of each compaction's cell and, if it failed, the reason.
    std::map<std::string, std::string> statuses() const {
        std::map<std::string, std::string> found;
        const json all = result();
        for (const json& cell : all.at("ptbench").at("cells")) {
            const bool has_failed = cell.at("status") == "failed";
            found[cell.at("axes").at("compaction")] = cell.at(has_failed ? "reason" : "status");
        }
        return found;
    }
    // The film hashes of all samples of a compaction's cell.
    std::vector<std::string> films(const std::string& compaction) const {
        std::vector<std::string> hashes;
        const json all = result();
        for (const json& row : all.at("benchmarks")) {
            const std::string cell = row.at("run_name");
            const bool is_none = cell.find("compaction:") == std::string::npos;
            if (row.contains("pt_seed") &&
                (compaction == "none" ? is_none : cell.find(compaction) != std::string::npos)) {
                hashes.push_back(row.at("film_hash"));
            }
        }
        return hashes;
    }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// wrong_throughput is right with some seeds, bit for bit: with those it may be timed.
TEST_F(WrongVariantsTest, TheWrongOneAloneFailsAtTenSeeds) {
    int failed_before = 0, failed_in_a_sample = 0;
    for (int seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(seed);
        const CommandResult ended = run("wrong_throughput,wrong_loss,wrong_count,none,thrust_remove_if",
                                        {"--overwrite", "--seed", std::to_string(seed)});
        EXPECT_EQ(ended.exit_code, 1) << ended.err;
        std::map<std::string, std::string> found = statuses();
        EXPECT_EQ(found["none"], "ok");
        EXPECT_EQ(found["thrust_remove_if"], "ok");
        EXPECT_EQ(films("none").size(), 3u);
        EXPECT_EQ(films("thrust_remove_if"), films("none"));
        EXPECT_TRUE(has(found["wrong_loss"], " rays, not ")) << found["wrong_loss"];
        EXPECT_TRUE(has(found["wrong_count"], "the compaction returned a count of 1")) << found["wrong_count"];
        EXPECT_TRUE(has(found["wrong_count"], " paths in play, allowed: at most ")) << found["wrong_count"];
        EXPECT_TRUE(has(ended.err, "failed: wavefront/compaction:wrong_count/scene:cornell_closed/")) << ended.err;
        if (found["wrong_throughput"] == "ok") {
            EXPECT_EQ(films("wrong_throughput"), films("none"));
        } else {
            EXPECT_TRUE(has(found["wrong_throughput"], "film ")) << found["wrong_throughput"];
            failed_before += has(found["wrong_throughput"], "at full size, ") ? 1 : 0;
            failed_in_a_sample += found["wrong_throughput"].starts_with("sample ") ? 1 : 0;
        }
    }
    EXPECT_GT(failed_before, 0);
    EXPECT_GT(failed_in_a_sample, 0);
}

TEST_F(WrongVariantsTest, AloneItFailsAsWell) {
    EXPECT_EQ(run("wrong_loss").exit_code, 1);
    EXPECT_TRUE(has(statuses()["wrong_loss"], " rays, not ")) << statuses()["wrong_loss"];
}

// The arguments that verify one queue on a CPU with these compactions, all else at its plainest.
Arguments verify_queue(const std::string& compactions) {
    Arguments arguments{"verify", "--scene", "cornell_open", "--backend", "cpu"};
    for (const std::string& axis :
         {"compaction=" + compactions, std::string("integrator=wavefront"), std::string("sorting=none"),
          std::string("layout=aos"), std::string("specialisation=features"), std::string("direct_light=off"),
          std::string("first_bounce=off"), std::string("precision=float")}) {
        arguments.insert(arguments.end(), {"--axis", axis});
    }
    return arguments;
}

TEST_F(WrongVariantsTest, VerifyHasPathsAndCallsEnough) {
    for (const char* wrong : {"wrong_loss", "wrong_count"}) {
        const CommandResult result = call(verify_queue("none," + std::string(wrong)));
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_TRUE(has(result.out, "compaction=" + std::string(wrong) + " on cornell_open: FAILED, ")) << result.out;
        EXPECT_TRUE(has(result.out, " wavefront on cornell_open: ok, ")) << result.out;
        EXPECT_TRUE(has(result.out, "1 failed, ")) << result.out;
    }
}

// ---- Crashes: verification is the process's first render of it, then two before the timed ones, a warm-up, samples.

struct Crash {
    const char* in_render;
    const char* place;
    std::size_t samples;  // that were taken before it
};

class CrashingVariantTest : public WrongVariantsTest, public testing::WithParamInterface<Crash> {
protected:
    void SetUp() override {
        resolution = "16x16";
        spp = "2";
    }
    std::string reason() const {
        return "crashed in " + std::string(GetParam().place) + ": segmentation fault (SIGSEGV)";
    }
};

TEST_P(CrashingVariantTest, IsNamedAndTheRunGoesOnWithoutIt) {
    const std::string cell = "wavefront/compaction:wrong_crash/scene:cornell_closed/backend:cpu/16x16/depth:5/spp:2";
    const CommandResult crashed = run("wrong_crash,none", {}, GetParam().in_render);
    EXPECT_EQ(crashed.exit_code, 3);
    EXPECT_TRUE(has(crashed.err, "ptbench: crashed, segmentation fault (SIGSEGV), in: " + cell + ", ")) << crashed.err;
    EXPECT_TRUE(has(crashed.err, "\ngo on with: ")) << crashed.err;
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_TRUE(std::filesystem::exists(journal));
    const std::string before = content_of(journal);

    EXPECT_EQ(run("wrong_crash,none").exit_code, 2);  // an unfinished run is neither gone on with nor lost unasked
    EXPECT_EQ(content_of(journal), before);

    const CommandResult resumed = run("wrong_crash,none", {"--resume"}, GetParam().in_render);
    EXPECT_EQ(resumed.exit_code, 1) << resumed.err;
    EXPECT_TRUE(
        has(resumed.err, "failed before and not tried again (--overwrite starts over): " + cell + ": " + reason()))
        << resumed.err;
    EXPECT_EQ(statuses(), (std::map<std::string, std::string>{{"none", "ok"}, {"wrong_crash", reason()}}));
    EXPECT_EQ(films("wrong_crash").size(), GetParam().samples);
    EXPECT_FALSE(std::filesystem::exists(journal));
}

INSTANTIATE_TEST_SUITE_P(Places, CrashingVariantTest,
                         testing::Values(Crash{"1", "a render before the timed ones", 0},
                                         Crash{"3", "a render before the timed ones", 0},
                                         Crash{"4", "sample 0 (seed 1)", 0}, Crash{"6", "sample 1 (seed 2)", 1}),
                         [](const auto& test) { return std::string("InRender") + test.param.in_render; });

TEST_F(WrongVariantsTest, OverwriteStartsOverAndKeepsTheJournal) {
    resolution = "16x16";
    spp = "2";
    EXPECT_EQ(run("wrong_crash,none", {}, "6").exit_code, 3);
    const std::string before = content_of(journal);
    const CommandResult again = run("wrong_crash,none", {"--overwrite"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.err, "ptbench: the unfinished run that was there is kept: " + journal + ".1\n");
    EXPECT_EQ(content_of(journal + ".1"), before);
    EXPECT_EQ(statuses(), (std::map<std::string, std::string>{{"none", "ok"}, {"wrong_crash", "ok"}}));
    EXPECT_EQ(run("wrong_crash,none", {"--overwrite"}, "6").exit_code, 3);
    EXPECT_EQ(run("wrong_crash,none", {"--overwrite"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(journal + ".2"));  // beside the first
    EXPECT_EQ(content_of(journal + ".1"), before);
}

TEST_F(WrongVariantsTest, WhatWasPrintedIsThereAfterACrash) {
    Arguments arguments = verify_queue("none,wrong_crash");
    arguments.insert(arguments.end(), {"--resolution", "16x16"});
    const CommandResult result = call(arguments, "1");
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_TRUE(has(result.out, " wavefront on cornell_open: ok, ")) << result.out;
    const std::string crash =
        "ptbench: crashed, segmentation fault (SIGSEGV), in: wavefront compaction=wrong_crash on cornell_open, "
        "cpu, 16x16, 4 spp, seed 1\n";
    EXPECT_EQ(result.err, crash);
    // By several processes the part that a worker was at is named besides.
    Arguments by_two = arguments;
    by_two.insert(by_two.end(), {"--jobs", "2"});
    const CommandResult at_once = call(by_two, "1");
    EXPECT_EQ(at_once.exit_code, 3);
    EXPECT_TRUE(has(at_once.err, crash)) << at_once.err;
    EXPECT_TRUE(has(at_once.err,
                    "a worker ended with exit code 3 at cornell_open on cpu, part from wavefront "
                    "compaction=wrong_crash\n"))
        << at_once.err;
    const CommandResult rendered =
        call({"render", "--scene", "cornell_open", "--backend", "cpu", "--resolution", "16x16", "--axis",
              "integrator=wavefront", "--axis", "compaction=wrong_crash", "--out", folder.file("image.png")},
             "1");
    EXPECT_EQ(rendered.exit_code, 3);
    EXPECT_TRUE(has(rendered.err, "in: wavefront compaction=wrong_crash on cornell_open, cpu, 16x16, 16 spp, seed 1\n"))
        << rendered.err;
    EXPECT_EQ(folder.content(), Arguments{});
}

}  // namespace
}  // namespace pt::test
