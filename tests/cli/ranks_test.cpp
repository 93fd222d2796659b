// Runs and renders on several ranks of MPI: the films of one process, errors said once, and what a killed rank leaves.
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++count;
    }
    return count;
}

#if !defined(PTBENCH_MPIEXEC)

TEST(RanksTest, ABuildWithoutMpiSaysSoOnce) {
    for (const char* rank : {"0", "1"}) {
        const CommandResult result =
            ptbench({"list"}, {.environment = {{"OMPI_COMM_WORLD_RANK", rank}, {"OMPI_COMM_WORLD_SIZE", "2"}}});
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(count_of(result.err, "this build of ptbench has no MPI"), *rank == '0' ? 1u : 0u) << result.err;
    }
}

#else

// More ranks than cores, as root, in containers that forbid to read another process's memory.
CommandOptions for_ranks(CommandOptions options = {}) {
    for (const auto& [name, value] :
         {std::pair("OMPI_ALLOW_RUN_AS_ROOT", "1"), std::pair("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
          std::pair("OMPI_MCA_rmaps_base_oversubscribe", "1"), std::pair("OMPI_MCA_hwloc_base_binding_policy", "none"),
          std::pair("OMPI_MCA_btl_vader_single_copy_mechanism", "none"), std::pair("OMP_NUM_THREADS", "1")}) {
        options.environment.emplace_back(name, value);
    }
    return in_repository(options);
}

Arguments on_ranks(int count, Arguments arguments) {
    arguments = ptbench_arguments(std::move(arguments));
    arguments.insert(arguments.begin(), {PTBENCH_MPIEXEC, "-n", std::to_string(count)});
    return arguments;
}

CommandResult run_on_ranks(int count, const Arguments& arguments, const CommandOptions& options = {}) {
    return run_command(on_ranks(count, arguments), for_ranks(options));
}

Arguments joined(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

class RanksTest : public testing::Test {
protected:
    TemporaryFolder folder;

    Arguments render(const std::string& out, const Arguments& more = {}) const {
        return joined(
            {"render", "--scene", "ball_glass", "--backend", "cpu", "--resolution", "13x11", "--out", folder.file(out)},
            more);
    }
    Arguments run(const std::string& out, const Arguments& more = {}) const {
        return joined({"run", "--backend", "cpu", "--quiet", "--out", folder.file(out)}, more);
    }
    json result(const std::string& name) const { return json::parse(content_of(folder.file(name))); }
};

using FilmOfSample = std::map<std::pair<std::string, int>, std::string>;

// The hashes of each sample's film, at its checkpoints too, and its paths, by cell and repetition.
FilmOfSample films_of(const json& result) {
    FilmOfSample films;
    for (const json& row : result.at("benchmarks")) {
        if (row.at("run_type") != "iteration") {
            continue;
        }
        std::string film = row.at("film_hash").get<std::string>() + " " + row.at("pt_paths").dump();
        for (const json& checkpoint : row.value("pt_checkpoints", json::array())) {
            film += " " + checkpoint.at("film_hash").get<std::string>() + checkpoint.at("mse").dump();
        }
        EXPECT_TRUE(films.emplace(std::pair(row.at("run_name"), row.at("repetition_index")), film).second) << row;
    }
    return films;
}

// ---- Films ----

TEST_F(RanksTest, AnyNumberOfRanksRendersTheFilmOfOneProcess) {
    const Arguments five_samples{"--spp", "5", "--seed", "7"};
    const CommandResult alone = ptbench(render("alone.pfm", five_samples), for_ranks());
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    const json expected = json::parse(alone.out);
    EXPECT_FALSE(expected.contains("ranks"));
    for (const int count : {1, 2, 3, 4}) {
        const CommandResult split = run_on_ranks(count, render("split.pfm", five_samples));
        ASSERT_EQ(split.exit_code, 0) << split.err;
        const json summary = json::parse(split.out);  // once, by rank 0
        for (const char* key : {"film_hash", "mean_rgb", "paths", "rays", "nonfinite", "negative", "saturated"}) {
            EXPECT_EQ(summary.at(key), expected.at(key)) << key << " of " << count;
        }
        EXPECT_EQ(summary.value("ranks", 1), count);
        EXPECT_EQ(content_of(folder.file("split.pfm")), content_of(folder.file("alone.pfm")));
        if (count > 1) {
            EXPECT_DOUBLE_EQ(
                summary.at("render_seconds").get<double>(),
                summary.at("slowest_rank_seconds").get<double>() + summary.at("reduce_seconds").get<double>());
        }
    }
}

TEST_F(RanksTest, ARankWithoutASampleAddsNothing) {
    const CommandResult alone = ptbench(render("alone.pfm", {"--spp", "2"}), for_ranks());
    const CommandResult split = run_on_ranks(4, render("split.pfm", {"--spp", "2"}));
    ASSERT_EQ(split.exit_code, 0) << split.err;
    EXPECT_EQ(json::parse(split.out).at("film_hash"), json::parse(alone.out).at("film_hash"));
}

// Every integrator, with queues that hold several samples, and errors at checkpoints.
TEST_F(RanksTest, ARunHasTheFilmsOfOneProcess) {
    write_text(folder.file("suite.json"), R"({
        "name": "ranks", "description": "d", "repetitions": 8, "studies": [
        {"name": "t", "title": "t", "figure": "integrator", "scenes": ["cornell_open"], "axes": {"integrator": ["depth_first", "wavefront", "packet"], "compaction": ["thrust_partition"]},
         "resolution": [9, 7], "depth": 4, "spp": 6},
        {"name": "e", "title": "e", "figure": "convergence", "type": "convergence", "scenes": ["cornell_open"],
         "axes": {"integrator": ["depth_first"]}, "resolution": [4, 4], "depth": 3, "spp": 8,
         "reference": {"variance": 1e-2, "most_spp": 1024}}]})");
    const Arguments suite{"--suite", folder.file("suite.json"), "--reference-cache", folder.file("references")};
    const CommandResult alone = ptbench(run("alone.json", suite), for_ranks());
    ASSERT_EQ(alone.exit_code, 0) << alone.err << alone.out;
    const CommandResult split = run_on_ranks(3, run("split.json", suite));
    ASSERT_EQ(split.exit_code, 0) << split.err << split.out;
    EXPECT_EQ(films_of(result("split.json")), films_of(result("alone.json")));
    const json context = result("split.json").at("context");
    EXPECT_EQ(context.at("ptbench.ranks"), "3");
    EXPECT_EQ(context.at("ptbench.rank_hosts").size(), 3u);
    EXPECT_TRUE(context.at("ptbench.machine").get<std::string>().ends_with("-3-ranks"));
    for (const json& row : result("split.json").at("benchmarks")) {
        if (row.at("run_type") == "iteration") {
            EXPECT_EQ(row.at("pt_ranks"), 3);
            EXPECT_NEAR(row.at("pt_wall_ms").get<double>(),
                        row.at("pt_slowest_rank_ms").get<double>() + row.at("pt_reduce_ms").get<double>(), 1e-6);
            EXPECT_LE(row.at("pt_fastest_rank_ms"), row.at("pt_slowest_rank_ms"));
        }
    }
}

// ---- Errors: one line, whatever the number of ranks ----

TEST_F(RanksTest, BadInputIsSaidOnce) {
    const std::vector<std::pair<Arguments, std::string>> calls{
        {render("a.png", {"--axis", "integrator=none_such"}), "none_such"},
        {render("a.png", {"--no-such-option"}), "--no-such-option"},
        {{"verify", "--scene", "cornell_open"}, "one for `ptbench verify`"},
        {render("a.png", {"--axis", "robustness=naive"}), "rounds sums of samples"},
        {run("a.json", {"--scene", "cornell_open", "--axis", "sampler=minstd_by_position"}), "order of the samples"},
    };
    for (const auto& [arguments, part] : calls) {
        const CommandResult result = run_on_ranks(3, arguments);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_EQ(count_of(result.err, "ptbench: "), 1u) << result.err;
        EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
        EXPECT_EQ(folder.content(), Arguments{});
    }
}

// Times would be of two machines.
TEST_F(RanksTest, RanksOnMachinesThatDifferAreRefused) {
    const Arguments call = ptbench_arguments(run("a.json", {"--scene", "cornell_open", "--resolution", "4x3"}));
    Arguments arguments = joined({PTBENCH_MPIEXEC, "-n", "1"}, call);
    arguments = joined(arguments, joined({":", "-n", "1", "env", "OMP_NUM_THREADS=3"}, call));
    const CommandResult result = run_command(arguments, for_ranks());
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(count_of(result.err, "ptbench: rank 1 on "), 1u) << result.err;
    EXPECT_NE(result.err.find("ptbench.machine: found "), std::string::npos) << result.err;
    EXPECT_EQ(folder.content(), Arguments{});
}

// ---- A rank that is killed ----

// The process that renders for a rank, found by a variable that only this test's processes have.
pid_t process_of(int rank, const std::string& mark) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string pid = entry.path().filename();
        if (pid.find_first_not_of("0123456789") != std::string::npos) {
            continue;
        }
        const std::string environment = content_of(entry.path() / "environ");
        const auto has = [&](const std::string& setting) {
            return environment.find(setting + '\0') != std::string::npos;
        };
        if (!has("RANKS_TEST=" + mark) || !has("OMPI_COMM_WORLD_RANK=" + std::to_string(rank))) {
            continue;
        }
        // A rank's parent process, which waits for it, is of the same program.
        const std::string stat = content_of(entry.path() / "stat");
        const std::string parent = std::to_string(std::atoi(stat.c_str() + stat.rfind(')') + 4));
        std::error_code error;
        const auto program = [&](const std::string& of) {
            return std::filesystem::read_symlink("/proc/" + of + "/exe", error).string();
        };
        if (program(pid) == program(parent)) {
            return std::stoi(pid);
        }
    }
    return 0;
}

class KilledRankTest : public RanksTest, public testing::WithParamInterface<int> {
protected:
    static constexpr int repetitions = 400;
    std::string journal = folder.file("split.json") + ".journal.jsonl";
    Arguments small{"--scene",       "cornell_open",
                    "--resolution",  "16x12",
                    "--depth",       "4",
                    "--repetitions", std::to_string(repetitions)};

    std::size_t samples_in_journal() const { return count_of(content_of(journal), "\"type\":\"sample\""); }
};

TEST_P(KilledRankTest, EndsTheRunInSecondsAndItGoesOn) {
    {
        const std::string mark = folder.path().string();
        RunningCommand running(on_ranks(3, run("split.json", small)),
                               for_ranks({.environment = {{"RANKS_TEST", mark}}}));
        ASSERT_TRUE(wait_until([&] { return samples_in_journal() >= 3 || !running.is_running(); }));
        const pid_t rank = process_of(GetParam(), mark);
        ASSERT_GT(rank, 0);
        ::kill(rank, SIGKILL);
        ASSERT_TRUE(wait_until([&] { return !running.is_running(); }, std::chrono::seconds(30)));
        const CommandResult killed = running.wait();
        EXPECT_EQ(killed.exit_code, 3) << killed.err;
        EXPECT_EQ(count_of(killed.err, "was killed: Killed"), 1u) << killed.err;
        EXPECT_EQ(count_of(killed.err, "ptbench: rank " + std::to_string(GetParam()) + " of 3"), 1u) << killed.err;
        EXPECT_TRUE(wait_until([&] { return process_of(0, mark) + process_of(1, mark) + process_of(2, mark) == 0; }));
    }
    const std::size_t kept = samples_in_journal();
    EXPECT_GE(kept, 3u);
    ASSERT_LT(kept, static_cast<std::size_t>(repetitions));

    const CommandResult others = run_on_ranks(2, run("split.json", joined(small, {"--resume"})));
    EXPECT_EQ(others.exit_code, 2);
    EXPECT_EQ(samples_in_journal(), kept);

    const CommandResult resumed = run_on_ranks(3, run("split.json", joined(small, {"--resume"})));
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    const CommandResult alone = ptbench(run("alone.json", small), for_ranks());
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    const FilmOfSample films = films_of(result("split.json"));
    EXPECT_EQ(films.size(), static_cast<std::size_t>(repetitions));
    EXPECT_EQ(films, films_of(result("alone.json")));
    EXPECT_GE(result("split.json").at("ptbench").at("run").at("sessions").at(0).at("samples"), kept);
}

INSTANTIATE_TEST_SUITE_P(OfThree, KilledRankTest, testing::Values(0, 1));

#endif

}  // namespace
}  // namespace pt::test
