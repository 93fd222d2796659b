// ptbench run as a user calls it: dry, whole, killed, interrupted, resumed.
#include <regex>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/machine/cpu_quota.h"
#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

class RunCommandTest : public testing::Test {
protected:
    TemporaryFolder folder;
    std::string out = folder.file("result.json");
    std::string journal = out + ".journal.jsonl";

    // Two cells of so many samples.
    Arguments call(int repetitions, const Arguments& added = {}) const {
        Arguments arguments{"run",
                            "--scene",
                            "cornell_open",
                            "--resolution",
                            "8x6",
                            "--spp",
                            "1",
                            "--axis",
                            "layout=aos,soa",
                            "--repetitions",
                            std::to_string(repetitions),
                            "--retakes",
                            "0",
                            "--out",
                            out};
        arguments.insert(arguments.end(), added.begin(), added.end());
        return arguments;
    }
    json result() const { return json::parse(content_of(out)); }
    std::size_t samples_in_journal() const {
        const std::string text = content_of(journal);
        std::size_t count = 0;
        const std::string mark = R"("type":"sample","check":")";
        for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
            const std::size_t end = at + mark.size() + 16 + 2;  // its digits, "}
            count += end < text.size() && text[end] == '\n' ? 1u : 0u;
        }
        return count;
    }
    static std::vector<json> samples(const json& file) {
        std::vector<json> rows;
        for (const json& row : file.at("benchmarks")) {
            if (row.at("run_type") == "iteration") {
                rows.push_back(row);
            }
        }
        return rows;
    }
    void expect_complete(int repetitions) const {
        EXPECT_FALSE(std::filesystem::exists(journal));
        const json file = result();
        EXPECT_EQ(file.at("context").at("ptbench.status"), "completed");
        // Drawn as the comparison that was asked for: the axis that was given two choices.
        EXPECT_EQ(file.at("ptbench").at("studies").at(0).at("compares"), "layout");
        const std::vector<json> rows = samples(file);
        EXPECT_EQ(rows.size(), 2u * static_cast<std::size_t>(repetitions));
        std::set<std::pair<std::string, int>> ids;
        for (const json& row : rows) {
            ids.emplace(row.at("run_name"), row.at("repetition_index"));
            EXPECT_EQ(row.at("pt_seed").get<int>(), row.at("repetition_index").get<int>() + 1);
        }
        EXPECT_EQ(ids.size(), rows.size());
    }
};

TEST_F(RunCommandTest, DryRunListsTheCellsAndRunsNothing) {
    const CommandResult result =
        ptbench(call(7, {"--axis", "first_bounce=all", "--dry-run"}), {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out,
              "wavefront/scene:cornell_open/backend:cpu/8x6/depth:8/spp:1\nwavefront/layout:soa/scene:cornell_open/"
              "backend:cpu/8x6/depth:8/spp:1\nwavefront/first_bounce:cached_jitters/scene:cornell_open/backend:cpu/8x6/"
              "depth:8/spp:1\nwavefront/first_bounce:cached_jitters/layout:soa/scene:cornell_open/backend:cpu/8x6/"
              "depth:8/spp:1\nn/a: wavefront first_bounce=cached on cornell_open: first_bounce=cached needs jitter off "
              "(camera.jitter is true in the scene)\nn/a: wavefront first_bounce=cached layout=soa on cornell_open: "
              "first_bounce=cached needs jitter off (camera.jitter is true in the scene)\n4 cells, 28 samples, 2 not "
              "applicable\n");
    EXPECT_EQ(folder.content(), Arguments());
    const CommandResult filtered = ptbench(call(7, {"--dry-run", "--benchmark_filter=layout:soa/"}));
    EXPECT_EQ(filtered.out,
              "wavefront/layout:soa/scene:cornell_open/backend:cpu/8x6/depth:8/spp:1\n1 cell, 7 samples, 0 not "
              "applicable\n");
    for (const char* suite : {"quick", "cis565"}) {
        const CommandResult planned = ptbench({"run", "--suite", suite, "--dry-run"}, {.folder = folder.path()});
        EXPECT_EQ(planned.exit_code, 0) << planned.err;
        EXPECT_NE(planned.out.find(" cells, "), std::string::npos);
    }
    EXPECT_EQ(folder.content(), Arguments());
}

// Alone it says what there is to compare, and runs nothing.
TEST_F(RunCommandTest, WithoutSuiteSceneAndAxisItSaysWhatItWouldCompare) {
    const CommandResult said = ptbench({"run", "--backend", "cpu"}, {.folder = folder.path()});
    EXPECT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(said.err, "");
    for (const char* text :
         {"On cpu, --scene S --axis AXIS=all compares\n", "  layout            aos soa\n", "and --suite NAME\n",
          "  meshes            scenes with meshes: --dry-run reads them and counts the cells\n",
          "  ptbench run --suite quick\n"}) {
        EXPECT_NE(said.out.find(text), std::string::npos) << text << said.out;
    }
    EXPECT_EQ(said.out.find("  launch "), std::string::npos) << said.out;  // one choice: nothing to compare
    const std::string planned = ptbench({"run", "--suite", "quick", "--backend", "cpu", "--dry-run"}).out;
    const int cells = std::stoi(planned.substr(planned.rfind('\n', planned.size() - 2) + 1));  // "58 cells, .."
    EXPECT_NE(said.out.find(fmt::format("  {:<17} {:>3} cells, {:>4} samples\n", "quick", cells, 9 * cells)),
              std::string::npos)
        << said.out << planned;
    EXPECT_EQ(folder.content(), Arguments());
}

TEST_F(RunCommandTest, OneVariantAloneIsComparedWithNothingAndARunSaysSo) {
    const Arguments alone{"run",       "--scene", "cornell_open",
                          "--backend", "cpu",     "--resolution",
                          "8x6",       "--spp",   "1",
                          "--depth",   "2",       "--repetitions",
                          "1",         "--out",   out};
    const CommandResult run = ptbench(alone);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_NE(run.err.find("\none variant, wavefront, compared with nothing; --axis AXIS=all compares choices "),
              std::string::npos)
        << run.err;
    EXPECT_EQ(ptbench(call(1, {"--overwrite"})).err.find("one variant"), std::string::npos);
}

// The table of verdicts, with short names, and the same in the file.
TEST_F(RunCommandTest, ARunEndsWithATableOfVerdicts) {
    const CommandResult run = ptbench(call(9));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out.find("cornell_open 8x6, depth 8, 1 spp on cpu: ratio to layout=aos, all else equal\n"
                           "    ms/spp   ratio  95 % interval     verdict   variant\n"),
              0u)
        << run.out;
    EXPECT_NE(run.out.find("  baseline  wavefront\n"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("  wavefront layout=soa\n"), std::string::npos) << run.out;
    EXPECT_NE(run.err.find("[18/18] time: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(" left  wavefront layout=soa, cornell_open\n"), std::string::npos) << run.err;
}

TEST_F(RunCommandTest, ErrorAgainstTimeIsOneFlag) {
    const Arguments arguments{"run",
                              "--scene",
                              "cornell_open",
                              "--resolution",
                              "8x6",
                              "--depth",
                              "4",
                              "--spp",
                              "16",
                              "--axis",
                              "direct_light=off,nee",
                              "--retakes",
                              "0",
                              "--backend",
                              "cpu",
                              "--out",
                              out,
                              "--reference-cache",
                              folder.file("references"),
                              "--error-against-time"};
    const CommandResult run = ptbench(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.out.find("cornell_open 8x6, depth 4 on cpu: errors at 16 spp; efficiency: "), std::string::npos)
        << run.out;
    EXPECT_NE(run.out.find("efficiency by MSE"), std::string::npos);
    EXPECT_NE(run.out.find("\nfigures: python3 -m ptbench plots " + out + "\n"), std::string::npos);
    EXPECT_EQ(run.err.find("1e+300"), std::string::npos) << run.err;
    const json file = result();
    EXPECT_EQ(file.at("ptbench").at("studies").at(0).at("type"), "convergence");
    EXPECT_EQ(file.at("ptbench").at("cells").size(), 4u);  // two variants, with checkpoints and without
    for (const json& row : samples(file)) {
        if (row.at("run_name").get<std::string>().ends_with("/checkpoints:octaves")) {
            EXPECT_EQ(row.at("pt_checkpoints").size(), 5u);
        }
    }
}

// Times of so small an image scatter: some cells may get more samples, none is left with a gap.
TEST_F(RunCommandTest, MoreSamplesForOpenVerdictsAreWithinWhatTheResultSays) {
    const CommandResult run = ptbench(call(9, {"--decide", "2"}));
    ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
    EXPECT_NE(run.err.find("9 samples a cell, then up to 2 s of more where a verdict is open"), std::string::npos);
    const json file = result();
    EXPECT_EQ(file.at("ptbench").at("run").at("most_repetitions"), 36);
    std::map<std::string, std::set<int>> indices;
    for (const json& row : samples(file)) {
        indices[row.at("run_name")].insert(row.at("repetition_index").get<int>());
        EXPECT_EQ(row.at("pt_seed").get<int>(), row.at("repetition_index").get<int>() + 1);
    }
    EXPECT_EQ(indices.size(), 2u);
    for (const auto& [name, taken] : indices) {
        EXPECT_GE(taken.size(), 9u) << name;
        EXPECT_LE(taken.size(), 36u) << name;
        EXPECT_EQ(*taken.rbegin() + 1, static_cast<int>(taken.size())) << name;
    }
}

TEST_F(RunCommandTest, ErrorAgainstTimeIsOfScenesAndOfEnoughSeeds) {
    const CommandResult suite = ptbench({"run", "--suite", "quick", "--error-against-time"});
    EXPECT_EQ(suite.exit_code, 2);
    EXPECT_NE(suite.err.find("found --error-against-time beside --suite, allowed: --scene"), std::string::npos)
        << suite.err;
    const CommandResult seeds =
        ptbench({"run", "--scene", "cornell_open", "--error-against-time", "--repetitions", "7", "--out", out});
    EXPECT_EQ(seeds.exit_code, 2);
    EXPECT_NE(seeds.err.find("found 7, allowed: 8 or more with --error-against-time"), std::string::npos) << seeds.err;
    EXPECT_FALSE(std::filesystem::exists(out));
}

// Scripts that use the old name of a suite go on, and learn the name that results have now.
TEST_F(RunCommandTest, ASuiteIsFoundByItsOldName) {
    const auto planned = [&](const char* suite) {
        return ptbench({"run", "--suite", suite, "--dry-run", "--backend", "cpu"}, {.folder = folder.path()});
    };
    const CommandResult old = planned("seeds"), now = planned("cis565");
    EXPECT_EQ(old.exit_code, 0);
    EXPECT_EQ(old.out, now.out);
    EXPECT_EQ(old.err, "ptbench: the suite seeds is called cis565 now\n");
    EXPECT_EQ(now.err, "");
}

// A tunable's values, a study's resolutions and what only a GPU has, as cells.
TEST_F(RunCommandTest, DryRunListsTunedCellsAndSizes) {
    write_text(folder.file("suite.json"), R"({"name": "mine", "studies": [
        {"name": "a", "scenes": ["cornell_open"], "axes": {"first_bounce": ["off", "cached_jitters"]},
         "tunables": {"jitters": [2]}, "depth": 3, "resolution": [[8, 6], [4, 3]]},
        {"name": "b", "scenes": ["cornell_open"], "axes": {"launch": ["graph"]}, "resolution": [8, 6]}]})");
    const Arguments dry{"run", "--suite", "suite.json", "--dry-run", "--backend", "cpu"};
    const auto planned = [&](const Arguments& added) {
        Arguments arguments = dry;
        arguments.insert(arguments.end(), added.begin(), added.end());
        const CommandResult result = ptbench(arguments, {.folder = folder.path()});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.out;
    };
    const std::string off = "wavefront";
    const std::string kept = "wavefront/first_bounce:cached_jitters";
    const auto cell = [](const std::string& variant, const std::string& resolution) {
        return variant + "/scene:cornell_open/backend:cpu/" + resolution + "/depth:3/spp:1\n";
    };
    const std::string nothing_tuned =
        "n/a: " + off + " jitters=2 on cornell_open: jitters=2 tunes none of the variant's choices\n";
    const std::string no_graph =
        "n/a: wavefront launch=graph on cornell_open: "
        "launch=graph is not "
        "there on the backend cpu\n";
    EXPECT_EQ(planned({}), cell(kept + "/jitters:2", "8x6") + cell(kept + "/jitters:2", "4x3") + nothing_tuned +
                               no_graph + "2 cells, 18 samples, 2 not applicable\n");
    // From the command line, for every study: one resolution instead of all, other values instead of the suite's.
    EXPECT_EQ(planned({"--resolution", "5x5", "--tune", "jitters=16", "--axis", "launch=stream", "--depth", "3"}),
              cell(off, "5x5") + cell(kept, "5x5") + "2 cells, 18 samples, 0 not applicable\n");
    EXPECT_EQ(folder.content(), Arguments{"suite.json"});
}

TEST_F(RunCommandTest, SamplesFromTheCommandLineReplaceThoseOfEveryBackend) {
    write_text(folder.file("suite.json"), R"({"name": "mine", "studies": [
        {"name": "a", "scenes": ["cornell_open"], "resolution": [8, 6], "spp": {"cpu": 2, "cuda": 50}}]})");
    const std::string suite = folder.file("suite.json");
    EXPECT_NE(ptbench({"run", "--suite", suite, "--backend", "cpu", "--dry-run"}).out.find("/spp:2\n"),
              std::string::npos);
    EXPECT_NE(ptbench({"run", "--suite", suite, "--backend", "cpu", "--spp", "7", "--dry-run"}).out.find("/spp:7\n"),
              std::string::npos);
}

// The cells of another machine can be listed on this one.
TEST_F(RunCommandTest, DryRunListsTheCellsOfAGpuWithoutOne) {
    if (!cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const CommandResult result =
        ptbench({"run", "--scene", "cornell_open", "--resolution", "8x6", "--depth", "3", "--spp", "2", "--backend",
                 "cuda", "--axis", "integrator=wavefront,megakernel,depth_first", "--tune", "block=64", "--dry-run"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string rest = "/block:64";
    const std::string settings = "/scene:cornell_open/backend:cuda/8x6/depth:3/spp:2\n";
    EXPECT_EQ(result.out, "wavefront" + rest + settings + "megakernel" + rest + settings + "n/a: depth_first block=64" +
                              " on cornell_open: integrator=depth_first is not there on the backend cuda\n" +
                              "2 cells, 18 samples, 1 not applicable\n");
}

TEST_F(RunCommandTest, AWholeRunWritesOneFile) {
    const CommandResult run = ptbench(call(2));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(folder.content(), Arguments{"result.json"});
    expect_complete(2);
    const json file = result();
    EXPECT_EQ(file.at("context").at("ptbench.backend"), "cpu");  // where no GPU is
    EXPECT_EQ(file.at("ptbench").at("baselines").at("arithmetic"), "exact");
    EXPECT_EQ(file.at("benchmarks").size(), 2u * (2 + 4));
    const std::string command_line = file.at("context").at("ptbench.command_line");
    EXPECT_NE(command_line.find(" run --scene cornell_open --resolution 8x6 "), std::string::npos) << command_line;
    EXPECT_NE(run.out.find(out + "\n2 cells, 4 samples, 0 failed, 0 not applicable\n"), std::string::npos) << run.out;
}

TEST_F(RunCommandTest, GoogleBenchmarksFlagsWork) {
    const auto without_repetitions = [this](const Arguments& more) {
        Arguments arguments = call(5, more);
        std::erase_if(arguments,
                      [](const std::string& argument) { return argument == "--repetitions" || argument == "5"; });
        return arguments;
    };
    EXPECT_EQ(ptbench(call(5, {"--benchmark_repetitions=3"})).exit_code, 2);  // which of them?
    EXPECT_EQ(ptbench(without_repetitions({"--benchmark_filter=layout:soa/", "--benchmark_repetitions=3"})).exit_code,
              0);
    const std::vector<json> rows = samples(result());
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0].at("run_name"), "wavefront/layout:soa/scene:cornell_open/backend:cpu/8x6/depth:8/spp:1");
}

TEST_F(RunCommandTest, ResumeWithoutAJournalSaysThatItBegins) {
    const CommandResult begun = ptbench(call(1, {"--resume"}));
    EXPECT_EQ(begun.exit_code, 0) << begun.err;
    EXPECT_NE(begun.err.find("ptbench: --resume: there is no unfinished run (" + journal + "), so this one begins\n"),
              std::string::npos)
        << begun.err;
    EXPECT_EQ(samples(result()).size(), 2u);
    EXPECT_EQ(ptbench(call(1, {"--resume"})).err.find("so this one begins"), std::string::npos);  // it is done
}

// The program is started as nohup starts it.
TEST_F(RunCommandTest, AHangupThatTheCallerIgnoresStaysIgnored) {
    Arguments arguments{"/bin/sh", "-c", "trap '' HUP; exec \"$0\" \"$@\""};
    for (const std::string& argument : ptbench_arguments(call(200))) {
        arguments.push_back(argument);
    }
    RunningCommand running(arguments, in_repository());
    ASSERT_TRUE(wait_until([&] { return samples_in_journal() >= 2 || !running.is_running(); }));
    running.signal(SIGHUP);
    EXPECT_EQ(running.wait().exit_code, 0);
}

// A report renders a picture of it.
TEST_F(RunCommandTest, ASceneByItsPathStandsInTheResult) {
    const std::string own = folder.file("own.json");
    std::filesystem::copy_file(in_source("scenes/cornell_open.json"), own);
    Arguments arguments = call(1);
    *std::find(arguments.begin(), arguments.end(), "cornell_open") = own;
    EXPECT_EQ(ptbench(arguments).exit_code, 0);
    EXPECT_EQ(result().at("ptbench").at("cells")[0].at("scene_file"), own);
    EXPECT_EQ(ptbench(call(1, {"--overwrite"})).exit_code, 0);
    EXPECT_FALSE(result().at("ptbench").at("cells")[0].contains("scene_file"));
}

// Set back by an hour at every reading, it gave "-4439:-58 elapsed".
TEST_F(RunCommandTest, AClockThatIsSetBackLeavesProgressAsItIs) {
    const CommandResult run = ptbench(call(2), {.environment = {{"LD_PRELOAD", set_clock_back_library()}}});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find(" elapsed, about "), std::string::npos) << run.err;
    const std::regex below_0("[ :]-[0-9]");
    EXPECT_FALSE(std::regex_search(run.err, below_0)) << run.err;
    // The clock was set back: the samples were taken in the order that their numbers say, and ended ever earlier.
    const std::vector<json> rows = samples(result());
    EXPECT_LT(std::abs(rows[0].at("pt_timestamp").get<double>()), 2e9);
    EXPECT_GT(rows[0].at("pt_timestamp").get<double>(), rows[1].at("pt_timestamp").get<double>());
}

TEST_F(RunCommandTest, MoreThreadsThanProcessorsAreToldAndTheQuotaStandsInTheResult) {
    const std::string too_many = std::to_string(available_processors() + 1);
    const CommandResult run = ptbench(call(1), {.environment = {{"OMP_NUM_THREADS", too_many}}});
    EXPECT_NE(run.err.find("ptbench: warning: " + too_many + " threads on "), std::string::npos) << run.err;
    EXPECT_LT(run.err.find("ptbench: warning: "), run.err.find("elapsed"));
    const std::string quota = result().at("context").at("ptbench.cpu_quota");
    EXPECT_TRUE(quota == "none" || std::stod(quota) > 0) << quota;
    for (const json& row : samples(result())) {
        EXPECT_TRUE(row.at("pt_throttled_periods").is_number_unsigned());
        EXPECT_GE(row.at("pt_throttled_ms").get<double>(), 0);
    }
}

// The library reads them before main; some end every run, and --resume, some the program with exit code 0.
TEST_F(RunCommandTest, GoogleBenchmarksVariablesAreIgnoredAndNamed) {
    write_text(folder.file("mine.json"), "{}");
    const CommandResult run = ptbench(call(2), {.environment = {{"BENCHMARK_FILTER", "nothing"},
                                                                {"BENCHMARK_LIST_TESTS", "true"},
                                                                {"BENCHMARK_FORMAT", "xml"},
                                                                {"BENCHMARK_OUT", folder.file("mine.json")},
                                                                {"BENCHMARK_TIME_UNIT", "h"},
                                                                {"BENCHMARK_ROOT", "else"}}});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err.find("ptbench: ignored in the environment: BENCHMARK_LIST_TESTS, BENCHMARK_FILTER, "
                           "BENCHMARK_FORMAT, BENCHMARK_OUT, BENCHMARK_TIME_UNIT (options are given on the command "
                           "line)\n"),
              0u)
        << run.err;
    EXPECT_EQ(content_of(folder.file("mine.json")), "{}");
    EXPECT_EQ(result().at("context").at("ptbench.status"), "completed");
    // The environment's flags are ignored also where it says how threads wait.
    const CommandResult again =
        ptbench(call(2, {"--overwrite"}), {.environment = {{"BENCHMARK_FILTER", "nothing"}, {"GOMP_SPINCOUNT", "0"}}});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(ptbench({"list", "layout"}, {.environment = {{"BENCHMARK_FILTER", "nothing"}}}).err, "");
}

// What GOMP_SPINCOUNT does to the time of a render beside other jobs: results/*/waiting.txt.
TEST_F(RunCommandTest, ThreadsThatWaitSpinForAMomentUnlessTheEnvironmentSaysOtherwise) {
    const auto environment_of = [this](const Arguments& settings) {
        Arguments arguments{"/usr/bin/env", "-u", "OMP_WAIT_POLICY", "-u", "GOMP_SPINCOUNT"};
        arguments.insert(arguments.end(), settings.begin(), settings.end());
        for (const std::string& argument : ptbench_arguments(call(1, {"--overwrite"}))) {
            arguments.push_back(argument);
        }
        EXPECT_EQ(run_command(arguments, in_repository()).exit_code, 0);
        return result().at("context").at("ptbench.openmp_environment").get<std::string>();
    };
    EXPECT_NE(environment_of({}).find("GOMP_SPINCOUNT=10000"), std::string::npos);
    const std::string own = environment_of({"OMP_WAIT_POLICY=active"});
    EXPECT_NE(own.find("OMP_WAIT_POLICY=active"), std::string::npos) << own;
    EXPECT_EQ(own.find("GOMP_SPINCOUNT"), std::string::npos) << own;
}

TEST_F(RunCommandTest, ListsOfDepthsSamplesAndSizesAreCells) {
    const CommandResult listed = ptbench({"run", "--scene", "cornell_open", "--backend", "cpu", "--depth", "2,4,8",
                                          "--spp", "1,16", "--resolution", "8x6,4x3", "--dry-run"});
    EXPECT_EQ(listed.exit_code, 0) << listed.err;
    for (const std::string size : {"8x6", "4x3"}) {
        for (const std::string depth : {"2", "4", "8"}) {
            for (const std::string spp : {"1", "16"}) {
                const std::string cell = "/" + size + "/depth:" + depth + "/spp:" + spp + "\n";
                EXPECT_NE(listed.out.find(cell), std::string::npos) << cell << listed.out;
            }
        }
    }
    EXPECT_TRUE(listed.out.ends_with("\n12 cells, 108 samples, 0 not applicable\n")) << listed.out;
}

TEST_F(RunCommandTest, MergeLooksAtTheSamplesOfItsShards) {
    const std::string one = folder.file("one.json"), two = folder.file("two.json"), whole = folder.file("whole.json");
    for (const auto& [file, shard] : {std::pair(one, "1/2"), std::pair(two, "2/2")}) {
        Arguments arguments = call(3, {"--depth", "2,3", "--shard", shard});
        *std::find(arguments.begin(), arguments.end(), out) = file;
        ASSERT_EQ(ptbench(arguments).exit_code, 0);
    }
    const json sound = json::parse(content_of(one));
    const auto refused_with = [&](const json& changed, const std::string& found) {
        write_text(one, changed.dump());
        const CommandResult merged = ptbench({"merge", one, two, "--out", whole});
        EXPECT_EQ(merged.exit_code, 2);
        EXPECT_NE(merged.err.find(found), std::string::npos) << merged.err;
        EXPECT_FALSE(std::filesystem::exists(whole));
    };
    json changed = sound;
    changed["benchmarks"].push_back(sound["benchmarks"][0]);
    refused_with(changed, "found sample 0 twice, allowed: each sample once");
    changed = sound;
    changed["benchmarks"].erase(1);
    refused_with(changed, "found 2 samples, allowed: 3");
    changed = sound;
    changed["benchmarks"][0]["real_time"] = 0;
    refused_with(changed, "found sample 0 with a time of 0, allowed: a time above 0");
    changed = sound;
    changed["benchmarks"][0]["film_hash"] = "0123456789abcdef";
    refused_with(changed, "found sample 0 with the film \"0123456789abcdef\"");
    write_text(one, sound.dump());
    EXPECT_EQ(ptbench({"merge", one, two, "--out", whole}).exit_code, 0);
    EXPECT_EQ(ptbench({"merge", one, two, "--out", whole}).exit_code, 2);  // it is there
    EXPECT_EQ(ptbench({"merge", one, two, "--out", whole, "--overwrite"}).exit_code, 0);
}

TEST_F(RunCommandTest, AllScenesAreTheShippedOnes) {
    const CommandResult listed = ptbench({"run", "--scene", "all", "--backend", "cpu", "--dry-run"});
    EXPECT_EQ(listed.exit_code, 0) << listed.err;
    std::size_t scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::in_source("scenes"))) {
        const bool is_scene = entry.path().extension() == ".json";
        scenes += is_scene ? 1u : 0u;
        EXPECT_TRUE(!is_scene || listed.out.find("/scene:" + entry.path().stem().string() + "/") != std::string::npos)
            << entry.path();
    }
    EXPECT_GT(scenes, 10u);
}

// Cells are found by name: by walking through those before them, a hundred thousand took minutes.
TEST_F(RunCommandTest, APlanOfAHundredThousandCellsIsThereAtOnce) {
    std::string depths = "1";
    for (int depth = 2; depth <= 10000; ++depth) {
        depths += "," + std::to_string(depth);
    }
    RunningCommand listing(
        ptbench_arguments({"run", "--scene", "cornell_open", "--backend", "cpu", "--axis", "compaction=all", "--axis",
                           "layout=aos,soa", "--depth", depths, "--dry-run"}),
        in_repository());
    const CommandResult listed = listing.wait();
    EXPECT_EQ(listed.exit_code, 0) << listed.err;
    EXPECT_NE(listed.out.rfind("\n100000 cells, 900000 samples, "), std::string::npos)
        << listed.out.substr(listed.out.size() - std::min<std::size_t>(200, listed.out.size()));
}

TEST_F(RunCommandTest, ASuiteFileCanBeOverriddenAndTheDefaultOutIsResults) {
    write_text(folder.file("suite.json"), R"({"name": "mine", "repetitions": 2, "studies": [
        {"name": "a", "scenes": ["cornell_open"], "axes": {"layout": ["aos"]}, "depth": [2, 3], "resolution": [8, 6]}]})");
    const CommandResult run = ptbench(
        {"run", "--suite", "suite.json", "--depth", "4", "--resolution", "6x5", "--spp", "3", "--axis", "layout=soa"},
        {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const std::string machine = ptbench({"machine"}).out;
    out = folder.file("results/" + machine.substr(0, machine.size() - 1) + "/mine.json");
    const json file = result();
    ASSERT_EQ(file.at("ptbench").at("cells").size(), 1u);
    EXPECT_EQ(file.at("ptbench").at("cells")[0].at("cell"),
              "wavefront/layout:soa/scene:cornell_open/backend:cpu/6x5/depth:4/spp:3");
    EXPECT_EQ(file.at("context").at("ptbench.suite"), "mine");
}

TEST_F(RunCommandTest, AKilledRunGoesOnWhereItWasKilled) {
    constexpr int repetitions = 600;
    RunningCommand killed(ptbench_arguments(call(repetitions)), in_repository());
    ASSERT_TRUE(wait_until([&] { return samples_in_journal() >= 20 || !killed.is_running(); }));
    killed.signal(SIGKILL);
    ASSERT_EQ(killed.wait().exit_code, 128 + SIGKILL);
    EXPECT_EQ(folder.content(), Arguments{"result.json.journal.jsonl"});  // no half-written result
    const std::size_t kept = samples_in_journal();
    ASSERT_LT(kept, 2u * repetitions);
    const std::string before = content_of(journal);

    const CommandResult refused = ptbench(call(repetitions));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(refused.err,
              "ptbench: " + journal +
                  ": found an unfinished run, allowed: --resume, which goes on, or --overwrite, which starts over\n");
    const CommandResult other = ptbench(call(repetitions, {"--resume", "--seed", "4"}));
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_EQ(other.err.find("ptbench: " + journal + ": line 1: found another run"), 0u) << other.err;
    EXPECT_EQ(content_of(journal), before);

    const CommandResult resumed = ptbench(call(repetitions, {"--resume"}));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_complete(repetitions);
    // The samples from before the kill are in the result, unchanged.
    std::set<double> timestamps;
    for (const json& row : samples(result())) {
        timestamps.insert(row.at("pt_timestamp").get<double>());
    }
    std::size_t found = 0;
    for (std::size_t start = 0, end = before.find('\n'); end != std::string::npos;
         start = end + 1, end = before.find('\n', start)) {
        const json line = json::parse(before.substr(start, end - start));
        found += line.at("type") == "sample" && timestamps.contains(line.at("sample").at("pt_timestamp").get<double>())
                     ? 1u
                     : 0u;
    }
    EXPECT_EQ(found, kept);
}

// Before the first sample, between samples, and again and again: what is there is whole, and the run goes on from it.
TEST_F(RunCommandTest, ARunMayBeKilledAtAnyMoment) {
    constexpr int repetitions = 120;
    std::size_t kept = 0;
    for (const std::size_t more : {0u, 1u, 2u, 30u, 5u}) {
        RunningCommand killed(ptbench_arguments(call(repetitions, {"--resume"})), in_repository());
        const auto is_time = [&] {
            return (std::filesystem::exists(journal) && samples_in_journal() >= kept + more) || !killed.is_running();
        };
        ASSERT_TRUE(wait_until(is_time));
        killed.signal(SIGKILL);
        ASSERT_EQ(killed.wait().exit_code, 128 + SIGKILL);
        EXPECT_EQ(folder.content(), Arguments{"result.json.journal.jsonl"});
        EXPECT_GE(samples_in_journal(), kept + more);
        kept = samples_in_journal();
        ASSERT_LT(kept, 2u * repetitions);
        // Every line that has an end is whole.
        const std::string text = content_of(journal);
        for (std::size_t start = 0, end = text.find('\n'); end != std::string::npos;
             start = end + 1, end = text.find('\n', start)) {
            EXPECT_TRUE(json::accept(text.substr(start, end - start))) << text.substr(start, end - start);
        }
    }
    const CommandResult resumed = ptbench(call(repetitions, {"--resume"}));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_complete(repetitions);
}

// The limit on the size of a file stands for a full disk.
TEST_F(RunCommandTest, AFullDiskEndsTheRunAndItGoesOnWhenThereIsRoom) {
    constexpr int repetitions = 60;
    std::string command = "ulimit -f 8; exec";
    for (const std::string& argument : ptbench_arguments(call(repetitions))) {
        command += " '" + argument + "'";
    }
    const CommandResult full = run_command({"/bin/sh", "-c", command}, in_repository());
    EXPECT_EQ(full.exit_code, 3);
    EXPECT_EQ(full.err.rfind("ptbench: " + journal + ": cannot be written: "), full.err.rfind("ptbench: ")) << full.err;
    EXPECT_EQ(folder.content(), Arguments{"result.json.journal.jsonl"});
    EXPECT_EQ(content_of(journal).back(), '\n');  // no half line
    const CommandResult resumed = ptbench(call(repetitions, {"--resume"}));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_complete(repetitions);
}

// --compile is for machines without a GPU, on which no other command would say what is wrong.
TEST_F(RunCommandTest, CompileTellsWhyAProgramDoesNotCompile) {
    if (!cuda_is_built()) {
        GTEST_SKIP() << "this build has no CUDA backend";
    }
    write_text(folder.file("plain"), "a file, not a folder");
    CommandOptions options = in_repository();
    options.environment.emplace_back("XDG_CACHE_HOME", folder.file("plain"));
    const CommandResult result =
        run_command(ptbench_arguments({"run", "--scene", "cornell_open", "--axis", "integrator=megakernel", "--backend",
                                       "cuda", "--compile", "--arch", "sm_90"}),
                    options);
    EXPECT_EQ(result.exit_code, 3);
    const std::size_t said = result.err.rfind("ptbench: ");
    ASSERT_NE(said, std::string::npos);
    EXPECT_NE(result.err.find(" did not compile; the first: " + folder.file("plain") + "/ptbench", said),
              std::string::npos)
        << result.err;
    EXPECT_NE(result.err.find("set XDG_CACHE_HOME", said), std::string::npos) << result.err;
    EXPECT_EQ(folder.content(), Arguments{"plain"});
}

TEST_F(RunCommandTest, AnInterruptedRunEndsWithAFileAndGoesOn) {
    constexpr int repetitions = 600;
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        RunningCommand interrupted(ptbench_arguments(call(repetitions)), in_repository());
        ASSERT_TRUE(wait_until([&] { return samples_in_journal() >= 20 || !interrupted.is_running(); }));
        interrupted.signal(number);
        const CommandResult ended = interrupted.wait();
        EXPECT_EQ(ended.exit_code, 130);
        std::string again = test::program_file();
        for (const std::string& argument : call(repetitions)) {
            again += " " + argument;
        }
        EXPECT_TRUE(ended.out.ends_with("; interrupted with 2 cells unfinished\ngo on with: " + again + " --resume\n"))
            << ended.out;
        const json cut = result();
        EXPECT_EQ(cut.at("context").at("ptbench.status"), "interrupted");
        EXPECT_EQ(samples(cut).size(), samples_in_journal());
        EXPECT_GE(samples(cut).size(), 20u);
        EXPECT_EQ(folder.content(), (Arguments{"result.json", "result.json.journal.jsonl"}));

        const CommandResult resumed = ptbench(call(repetitions, {"--resume"}));
        EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
        expect_complete(repetitions);
        std::filesystem::remove(out);
    }
}

TEST_F(RunCommandTest, ASecondRunOnTheSameFileIsRefused) {
    RunningCommand first(ptbench_arguments(call(10000)), in_repository());
    ASSERT_TRUE(wait_until([&] { return samples_in_journal() >= 1 || !first.is_running(); }));
    const CommandResult second = ptbench(call(10000, {"--resume"}));
    EXPECT_EQ(second.exit_code, 3);
    EXPECT_EQ(second.err, "ptbench: " + journal + ": another run is writing it\n");
    EXPECT_TRUE(first.is_running());
}

}  // namespace
}  // namespace pt::test
