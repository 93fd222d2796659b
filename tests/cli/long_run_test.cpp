// Long runs: killed at any moment and gone on with, full disks, and parts on several machines put together.
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/places.h"
#include "tests/support/same_result.h"

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

Arguments lines_of(const std::string& text) {
    Arguments lines;
    for (std::size_t start = 0, end = text.find('\n'); end != std::string::npos;
         start = end + 1, end = text.find('\n', start)) {
        lines.push_back(text.substr(start, end - start));
    }
    return lines;
}

// Rows of samples by cell and repetition; each must be there once.
std::map<std::pair<std::string, int>, json> sample_rows(const json& result) {
    std::map<std::pair<std::string, int>, json> rows;
    for (const json& row : result.at("benchmarks")) {
        if (row.at("run_type") == "iteration") {
            EXPECT_TRUE(rows.emplace(std::pair(row.at("run_name"), row.at("repetition_index")), row).second) << row;
        }
    }
    return rows;
}

// ---- Kills ----

constexpr int cells = 2;
constexpr int repetitions = 9;

struct Moment {
    std::size_t operation = 0;  // on the files of the run, from 0
    double part = 0;            // of a write, how much of it is done; of another, whether it is (from 0.5 on)
};

class KilledRunTest : public testing::Test {
protected:
    TemporaryFolder folder;  // of the run
    TemporaryFolder logs;
    std::string out = folder.file("result.json");
    std::string journal = out + ".journal.jsonl";

    Arguments call(const Arguments& added = {}) const {
        Arguments arguments{"run",
                            "--scene",
                            "cornell_open",
                            "--resolution",
                            "4x3",
                            "--depth",
                            "2",
                            "--backend",
                            "cpu",
                            "--quiet",
                            "--axis",
                            "integrator=wavefront,depth_first",
                            "--repetitions",
                            std::to_string(repetitions),
                            "--retakes",  // this machine may be busy: each run has the same samples
                            "0",
                            "--out",
                            out};
        arguments.insert(arguments.end(), added.begin(), added.end());
        return arguments;
    }
    CommandResult run(const Arguments& arguments, const Moment* end = nullptr, const std::string& log = "") const {
        CommandOptions options{.environment = {{"OMP_NUM_THREADS", "1"},  // twelve pixels
                                               {"LD_PRELOAD", test::kill_at_library()},
                                               {"KILL_AT_FOLDER", folder.path().string()},
                                               {"KILL_AT_LOG", log}}};
        if (end != nullptr) {
            options.environment.emplace_back("KILL_AT_OPERATION", std::to_string(end->operation));
            options.environment.emplace_back("KILL_AT_PART", std::to_string(end->part));
        }
        return ptbench(arguments, options);
    }
    // What a whole run does to its files, one line an operation.
    Arguments operations_of_a_run() const {
        const std::string log = logs.file("log");
        const CommandResult whole = run(call(), nullptr, log);
        EXPECT_EQ(whole.exit_code, 0) << whole.err;
        return lines_of(content_of(log));
    }
    json result() const { return json::parse(content_of(out)); }
    // The samples of the journal's whole lines.
    std::vector<json> samples_in_journal() const {
        std::vector<json> samples;
        for (const std::string& line : lines_of(content_of(journal))) {
            const json fact = json::parse(line);
            if (fact.at("type") == "sample") {
                samples.push_back(fact);
            }
        }
        return samples;
    }
    void expect_kept(const std::vector<json>& samples) const {
        std::set<std::pair<std::string, double>> taken;  // by cell and the moment at which it ended
        for (const auto& [id, row] : sample_rows(result())) {
            taken.emplace(id.first, row.at("pt_timestamp"));
        }
        for (const json& fact : samples) {
            EXPECT_TRUE(taken.contains({fact.at("cell"), fact.at("sample").at("pt_timestamp")})) << fact;
        }
    }
    // Expects of a completed run every sample once, in the order of time once, and nothing else than an uninterrupted
    // run has.
    void expect_as_uninterrupted(const json& uninterrupted) const {
        EXPECT_EQ(folder.content(), Arguments{"result.json"});
        const json ended = result();
        EXPECT_EQ(without_times(ended), without_times(uninterrupted));
        const auto rows = sample_rows(ended);
        EXPECT_EQ(rows.size(), static_cast<std::size_t>(cells * repetitions));
        std::set<int> orders;
        for (const auto& [id, row] : rows) {
            orders.insert(row.at("pt_order").get<int>());
        }
        EXPECT_EQ(orders.size(), rows.size());
        EXPECT_EQ(*orders.rbegin(), static_cast<int>(rows.size()) - 1);
        int in_sessions = 0;
        for (const json& session : ended.at("ptbench").at("run").at("sessions")) {
            in_sessions += session.at("samples").get<int>();
        }
        EXPECT_EQ(in_sessions, cells * repetitions);
    }
};

// Fifty moments: in every stretch of the run, in the middle of a line or of the result, and before and after each of
// the operations with which a run ends.
std::vector<Moment> fifty_moments(std::size_t operations, std::size_t at_the_end, std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Moment> moments;
    for (std::size_t i = 0; i < at_the_end; ++i) {
        moments.push_back({operations - 1 - i, 0});
        moments.push_back({operations - 1 - i, 1});
    }
    const std::size_t others = 50 - moments.size();
    for (std::size_t i = 0; i < others; ++i) {
        const double position = (static_cast<double>(i) + uniform(random)) / static_cast<double>(others);
        moments.push_back({static_cast<std::size_t>(position * static_cast<double>(operations)), uniform(random)});
    }
    return moments;
}

TEST_F(KilledRunTest, LosesNothingButTheSampleInFlightAtFiftyMoments) {
    const Arguments operations = operations_of_a_run();
    const json uninterrupted = result();
    // The run, the session, the cells, the samples; then the result, and the journal goes.
    const Arguments ending(operations.end() - 5, operations.end());
    EXPECT_EQ(operations.size(), 2u + cells + cells * repetitions + ending.size());
    EXPECT_EQ(ending[0].find("write result.json.partial"), 0u) << ending[0];
    EXPECT_EQ(ending[1].find("fsync result.json.partial"), 0u) << ending[1];
    EXPECT_EQ(ending[2].find("rename result.json.partial"), 0u) << ending[2];
    EXPECT_EQ(ending[3], "fsync " + folder.path().filename().string());
    EXPECT_EQ(ending[4], "unlink result.json.journal.jsonl");

    std::mt19937 random(20240611);
    const std::vector<Moment> moments = fifty_moments(operations.size(), ending.size(), random);
    ASSERT_EQ(moments.size(), 50u);
    for (std::size_t i = 0; i < moments.size(); ++i) {
        SCOPED_TRACE("killed at operation " + std::to_string(moments[i].operation) + ", part " +
                     std::to_string(moments[i].part));
        std::filesystem::remove(out);
        ASSERT_EQ(run(call(), &moments[i]).exit_code, 128 + SIGKILL);
        std::vector<json> kept = std::filesystem::exists(journal) ? samples_in_journal() : std::vector<json>();
        if (std::filesystem::exists(journal)) {
            // What was written before is there: of each operation before this one, its line.
            const std::size_t lines = lines_of(content_of(journal)).size();
            EXPECT_GE(lines, std::min(moments[i].operation, operations.size() - ending.size()));
        } else {
            EXPECT_EQ(moments[i].operation, operations.size() - 1);
        }
        if (std::filesystem::exists(out)) {  // whole, from its first moment
            EXPECT_EQ(without_times(result()), without_times(uninterrupted));
        }
        if (i % 5 == 4) {  // and once more, as it goes on
            const Moment second{std::uniform_int_distribution<std::size_t>(0, 9)(random),
                                std::uniform_real_distribution<double>(0, 1)(random)};
            const int exit_code = run(call({"--resume"}), &second).exit_code;
            EXPECT_TRUE(exit_code == 128 + SIGKILL || exit_code == 0) << exit_code;
            if (std::filesystem::exists(journal)) {
                EXPECT_GE(samples_in_journal().size(), kept.size());
                kept = samples_in_journal();
            }
        }
        const std::string before = std::filesystem::exists(journal) ? "" : content_of(out);
        const CommandResult resumed = run(call({"--resume"}));
        ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
        expect_kept(kept);
        expect_as_uninterrupted(uninterrupted);
        if (!before.empty()) {  // it was done: nothing is measured again
            EXPECT_EQ(content_of(out), before);
            EXPECT_NE(resumed.out.find("nothing left to do: this run is complete\n"), std::string::npos) << resumed.out;
        }
    }
}

// What a disk may make of the end of a file that was being written when the power went.
TEST_F(KilledRunTest, GoesOnFromAJournalThatIsCutAnywhere) {
    (void)operations_of_a_run();
    const json uninterrupted = result();
    const Moment last{2 + cells + cells * repetitions, 0};
    std::filesystem::remove(out);
    ASSERT_EQ(run(call(), &last).exit_code, 128 + SIGKILL);
    const std::string whole = content_of(journal);
    std::mt19937 random(7);
    for (int i = 0; i < 12; ++i) {
        const std::size_t size = std::uniform_int_distribution<std::size_t>(0, whole.size())(random);
        SCOPED_TRACE(size);
        std::filesystem::remove(out);
        write_text(journal, whole.substr(0, size));
        const std::vector<json> kept = samples_in_journal();
        const CommandResult resumed = run(call({"--resume"}));
        ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
        expect_kept(kept);
        expect_as_uninterrupted(uninterrupted);
    }
}

// ---- Shards ----

class ShardedRunTest : public testing::Test {
protected:
    TemporaryFolder folder;
    std::string whole = folder.file("whole.json");
    std::string merged = folder.file("merged.json");

    // Four settings of two cells each, and variants that do not apply.
    void SetUp() override {
        write_text(folder.file("suite.json"), R"({"name": "mine", "repetitions": 3, "studies": [
            {"name": "a", "title": "A", "figure": "layout", "scenes": ["cornell_open", "cornell_closed"],
             "axes": {"layout": ["aos", "soa"], "first_bounce": ["off", "cached"]},
             "depth": [2, 3], "resolution": [4, 3]}]})");
    }
    CommandResult run(const std::string& out, const Arguments& added = {}) const {
        Arguments arguments{
            "run", "--suite", folder.file("suite.json"), "--backend", "cpu", "--quiet", "--retakes", "0", "--out", out};
        arguments.insert(arguments.end(), added.begin(), added.end());
        return ptbench(arguments);
    }
    std::string shard(int index) const { return folder.file("shard" + std::to_string(index) + ".json"); }
    void run_shards(int count, const Arguments& added = {}) const {
        for (int index = 1; index <= count; ++index) {
            Arguments arguments = added;
            arguments.insert(arguments.end(), {"--shard", std::to_string(index) + "/" + std::to_string(count)});
            const CommandResult result = run(shard(index), arguments);
            EXPECT_EQ(result.exit_code, 0) << result.err;
        }
    }
    CommandResult merge(const Arguments& files) const {
        Arguments arguments{"merge"};
        arguments.insert(arguments.end(), files.begin(), files.end());
        arguments.insert(arguments.end(), {"--out", merged});
        return ptbench(arguments);
    }
    void expect_refusal(const Arguments& files, const std::string& message) const {
        const CommandResult result = merge(files);
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_EQ(result.err.find("ptbench: " + message), 0u) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_FALSE(std::filesystem::exists(merged));
    }
    // A shard's file with one value changed.
    std::string changed(int index, const json::json_pointer& place, const json& value) const {
        nlohmann::ordered_json result = nlohmann::ordered_json::parse(content_of(shard(index)));
        result[nlohmann::ordered_json::json_pointer(place.to_string())] = value;
        write_text(folder.file("changed.json"), result.dump());
        return folder.file("changed.json");
    }
};

json parsed(const std::string& file) { return json::parse(content_of(file)); }

// What only a merged result has.
json without_shards(json result) {
    for (json& cell : result.at("ptbench").at("cells")) {
        EXPECT_EQ(cell.erase("shard"), 1u);
    }
    EXPECT_EQ(result.at("ptbench").erase("shards"), 1u);
    return result;
}

TEST_F(ShardedRunTest, MergedItIsWhatOneRunWrites) {
    ASSERT_EQ(run(whole).exit_code, 0);
    run_shards(3);
    const CommandResult result = merge({shard(2), shard(3), shard(1)});  // in any order
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string host = parsed(whole).at("context").at("host_name");
    EXPECT_EQ(result.out,
              merged + "\n8 cells, 24 samples, 0 failed, 4 not applicable, from 3 shards on " + host + "\n");
    const json one = parsed(whole), parts = parsed(merged);
    EXPECT_EQ(without_times(without_shards(parts)), without_times(one));
    EXPECT_EQ(sample_rows(parts).size(), 24u);

    // The order of keys too, but for what only one of them has.
    const auto ordered = nlohmann::ordered_json::parse(content_of(merged));
    EXPECT_EQ(ordered.begin().key(), "context");
    std::vector<std::string> shards;
    for (const json& part : parts.at("ptbench").at("shards")) {
        shards.push_back(part.at("shard"));
        EXPECT_EQ(part.at("host_name"), host);
        EXPECT_NE(part.at("ptbench.command_line").get<std::string>().find("--shard " + shards.back()),
                  std::string::npos);
    }
    EXPECT_EQ(shards, (Arguments{"1/3", "2/3", "3/3"}));
    // Cells that are compared with each other come from one machine.
    std::map<std::string, std::set<std::string>> shards_of;
    for (const json& cell : parts.at("ptbench").at("cells")) {
        const std::string name = cell.at("cell");
        shards_of[name.substr(name.find("/scene:"))].insert(cell.at("shard").get<std::string>());
    }
    EXPECT_EQ(shards_of.size(), 4u);
    for (const auto& [setting, found] : shards_of) {
        EXPECT_EQ(found.size(), 1u) << setting;
    }
    // The merged file is the run's own result: nothing is left for a run that goes on.
    EXPECT_NE(run(merged, {"--resume"}).out.find("nothing left to do"), std::string::npos);
}

// The rows of one result in the place of those that a shard has of the same cells.
json with_rows_of(json shard, const json& whole) {
    json rows = json::array();
    for (std::size_t i = 0; i < shard.at("ptbench").at("cells").size(); ++i) {
        for (const json& row : whole.at("benchmarks")) {
            if (row.at("run_name") == shard.at("ptbench").at("cells")[i].at("cell")) {
                rows.push_back(row);
                rows.back().at("family_index") = i;
            }
        }
    }
    EXPECT_EQ(rows.size(), shard.at("benchmarks").size());
    shard.at("benchmarks") = rows;
    return shard;
}

// Each of four shards has one setting, and none can tell by its own cells what the first study compares: where cached
// first hits do not apply, the first axis that varies is another one.
TEST_F(ShardedRunTest, SamplesHaveTheirVerdictsWhicheverShardTheyAreOf) {
    write_text(folder.file("suite.json"), R"({"name": "mine", "repetitions": 9, "studies": [
        {"name": "open", "title": "A", "figure": "scaling_by_depth",
         "scenes": ["cornell_open", "cornell_closed_unjittered"],
         "axes": {"layout": ["aos", "soa"], "first_bounce": ["off", "cached"]}, "depth": [2, 3], "resolution": [4, 3]},
        {"name": "tunable", "title": "B", "compares": "jitters", "scenes": ["cornell_open"],
         "axes": {"first_bounce": ["cached_jitters"]}, "tunables": {"jitters": [4, 8, 16]}, "depth": [2, 3],
         "resolution": [4, 3]}]})");
    ASSERT_EQ(run(whole).exit_code, 0);
    run_shards(4);
    const json one = parsed(whole);
    for (int index = 1; index <= 4; ++index) {
        write_text(shard(index), with_rows_of(parsed(shard(index)), one).dump());
    }
    const CommandResult result = merge({shard(1), shard(2), shard(3), shard(4)});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json& comparisons = one.at("ptbench").at("comparisons");
    EXPECT_EQ(parsed(merged).at("ptbench").at("comparisons"), comparisons);
    for (const std::string& file : {whole, merged, shard(1), shard(2), shard(3), shard(4)}) {
        EXPECT_EQ(parsed(file).at("ptbench").at("studies")[0].at("compares"), "first_bounce") << file;
    }
    std::multiset<std::string> studies;
    for (const json& comparison : comparisons) {
        studies.insert(comparison.at("study").get<std::string>());
    }
    EXPECT_EQ(studies,
              (std::multiset<std::string>{"open", "open", "open", "open", "tunable", "tunable", "tunable", "tunable"}));
}

// Programs that wrote no verdicts made shards without them; whoever reads what is merged of these judges it.
TEST_F(ShardedRunTest, ShardsWithoutVerdictsAreMergedWithoutVerdicts) {
    run_shards(2);
    for (int index = 1; index <= 2; ++index) {
        json result = parsed(shard(index));
        EXPECT_EQ(result.at("ptbench").erase("comparisons"), 1u);
        write_text(shard(index), result.dump());
    }
    EXPECT_EQ(merge({shard(1), shard(2)}).exit_code, 0);
    EXPECT_FALSE(parsed(merged).at("ptbench").contains("comparisons"));
}

TEST_F(ShardedRunTest, HostsOfOneKindMayBeMixedAndAreNamed) {
    run_shards(2);
    EXPECT_EQ(merge({shard(1), changed(2, json::json_pointer("/context/host_name"), "node17")}).exit_code, 0);
    const json result = parsed(merged);
    const std::string host = parsed(shard(1)).at("context").at("host_name");
    EXPECT_EQ(result.at("context").at("host_name"), host + ", node17");
    EXPECT_EQ(result.at("ptbench").at("shards")[0].at("host_name"), host);
    EXPECT_EQ(result.at("ptbench").at("shards")[1].at("host_name"), "node17");
}

// A sample's clock is judged by the highest of all machines. Both clocks are written here: on a busy machine a sample
// may be without one.
TEST_F(ShardedRunTest, ASlowMachineShows) {
    run_shards(2);
    const auto set_clock = [&](int index, double megahertz) {
        json result = parsed(shard(index));
        for (json& row : result.at("benchmarks")) {
            if (row.at("run_type") == "iteration") {
                row["pt_clock_mhz_before"] = row["pt_clock_mhz_after"] = megahertz;
                row.at("pt_low_clock") = 0;
                row.erase("pt_clock_unknown");
            }
        }
        write_text(shard(index), result.dump());
        return sample_rows(result).size();
    };
    const std::size_t fast = set_clock(1, 3000), slow = set_clock(2, 1);
    EXPECT_EQ(merge({shard(1), shard(2)}).exit_code, 0);
    std::map<double, std::size_t> low, samples;
    for (const auto& [id, row] : sample_rows(parsed(merged))) {
        const double clock = row.at("pt_clock_mhz_before");
        low[clock] += row.at("pt_low_clock") == 1 ? 1u : 0u;
        ++samples[clock];
    }
    EXPECT_EQ(samples, (std::map<double, std::size_t>{{1, slow}, {3000, fast}}));
    EXPECT_EQ(low, (std::map<double, std::size_t>{{1, slow}, {3000, 0}}));
}

TEST_F(ShardedRunTest, AShardUnderTwoNamesCountsOnce) {
    run_shards(2);
    ASSERT_EQ(merge({shard(1), shard(2)}).exit_code, 0);
    const json once = parsed(merged).at("benchmarks");
    std::filesystem::remove(merged);
    const std::string copy = folder.file("copy.json");
    std::filesystem::copy_file(shard(2), copy);
    const CommandResult result = merge({shard(1), copy, shard(2), shard(2)});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "ptbench: " + shard(2) + " is " + copy + " once more, and counts once\n" +
                              "ptbench: " + shard(2) + " is " + copy + " once more, and counts once\n");
    EXPECT_EQ(parsed(merged).at("benchmarks"), once);
}

TEST_F(ShardedRunTest, MergeRefusesWhatIsNotOneRun) {
    run_shards(3);
    const std::string first = shard(1);
    expect_refusal({shard(1), shard(3)}, "merge: shards: found 2 of 3, without 2/3, allowed: every shard of the run");
    expect_refusal({shard(3)}, "merge: shards: found 1 of 3, without 1/3, 2/3, allowed: every shard of the run");
    const std::string again = changed(2, json::json_pointer("/context/load_avg"), json::array());
    expect_refusal({shard(1), shard(2), shard(3), again},
                   again + ": shard 2/3: found the shard that " + shard(2) + " is, allowed: each shard once");
    const auto foreign = [&](const std::string& place, const json& value, const std::string& what) {
        const std::string file = changed(2, json::json_pointer(place), value);
        expect_refusal({shard(1), file, shard(3)},
                       file + ": shard 2/3: found a part of another run than that of " + first + " (" + what);
    };
    foreign("/context/ptbench.machine", "other", "context ptbench.machine: ");
    foreign("/context/ptbench.cuda_device", "other", "context ptbench.cuda_device: none, here \"other\")");
    foreign("/context/ptbench.cuda_driver", "999", "context ptbench.cuda_driver: none, here \"999\")");
    foreign("/context/ptbench.os", "other", "context ptbench.os: ");
    foreign("/context/ptbench.program_hash", "0", "context ptbench.program_hash: ");
    foreign("/context/ptbench.git_sha", "0", "context ptbench.git_sha: ");
    foreign("/ptbench/run/scenes/cornell_open", "0", "run scenes cornell_open: ");
    foreign("/ptbench/run/seed", 7, "run seed: 1, here 7)");
    foreign("/ptbench/run/cells_hash", "0", "run cells_hash: ");
    foreign("/ptbench/run/identity", "0", "run identity: ");
    foreign("/ptbench/studies/0/title", "B", "studies: ");
    const std::string cut = changed(2, json::json_pointer("/context/ptbench.status"), "interrupted");
    expect_refusal({shard(1), cut, shard(3)}, cut + ": $.context.ptbench.status: found \"interrupted\", allowed: ");
    const std::string fewer = changed(2, json::json_pointer("/ptbench/run/shard"), "2/4");
    expect_refusal({shard(1), fewer, shard(3)},
                   fewer + ": shard 2/4: found one of 4, allowed: shards of 3, as " + first);
    const std::string elsewhere = changed(2, json::json_pointer("/ptbench/run/positions"),
                                          parsed(shard(1)).at("ptbench").at("run").at("positions"));
    const std::size_t cells_of_1 = parsed(shard(1)).at("ptbench").at("cells").size();
    if (cells_of_1 == parsed(shard(2)).at("ptbench").at("cells").size()) {
        expect_refusal({shard(1), elsewhere, shard(3)}, "merge: shards: found 8 cells at ");
    } else {
        expect_refusal({shard(1), elsewhere, shard(3)}, elsewhere + ": $.ptbench.run.positions: found ");
    }
    ASSERT_EQ(run(whole).exit_code, 0);
    expect_refusal({whole}, whole + ": $.ptbench.run.shard: found no shard of a run, allowed: ");
    write_text(whole, R"({"ptbench": {"run": {"shard": "1/2"}}})");
    expect_refusal({whole}, whole + ": $: found ");
    write_text(whole, "{");
    expect_refusal({whole}, whole + ": ");
    expect_refusal({folder.file("none.json")}, folder.file("none.json") + ": ");
    const CommandResult onto = ptbench({"merge", shard(1), shard(2), shard(3), "--out", shard(1)});
    EXPECT_EQ(onto.exit_code, 2);
    EXPECT_EQ(onto.err, "ptbench: --out: file name: found \"" + shard(1) + "\", a shard, allowed: a file of its own\n");
}

TEST_F(ShardedRunTest, AnotherShardsJournalIsRefused) {
    const std::string journal = whole + ".journal.jsonl";
    const CommandOptions killed{.environment = {{"LD_PRELOAD", test::kill_at_library()},
                                                {"KILL_AT_FOLDER", folder.path().string()},
                                                {"KILL_AT_OPERATION", "8"}}};
    const Arguments call{"run", "--suite", folder.file("suite.json"), "--backend", "cpu", "--out", whole, "--resume"};
    const auto with = [&](Arguments added) {
        added.insert(added.begin(), call.begin(), call.end());
        return added;
    };
    ASSERT_EQ(ptbench(with({"--shard", "1/3"}), killed).exit_code, 128 + SIGKILL);
    const CommandResult other = ptbench(with({"--shard", "2/3"}));
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_EQ(other.err, "ptbench: " + journal +
                             ": line 1: found another run (shard: \"1/3\", here \"2/3\"), allowed: the run that it "
                             "was started with; remove the file to start over\n");
    EXPECT_EQ(ptbench(with({})).exit_code, 2);
    EXPECT_EQ(ptbench(with({"--shard", "1/3"})).exit_code, 0);
}

TEST_F(ShardedRunTest, DryRunsListEachCellOnce) {
    const auto lines = [&](const Arguments& added) {
        Arguments arguments{"run", "--suite", folder.file("suite.json"), "--backend", "cpu", "--dry-run"};
        arguments.insert(arguments.end(), added.begin(), added.end());
        std::multiset<std::string> found;
        for (const std::string& line : lines_of(ptbench(arguments).out)) {
            if (line.find("/scene:") != std::string::npos) {
                found.insert(line);
            }
        }
        return found;
    };
    std::multiset<std::string> parts;
    for (const char* shard_name : {"1/3", "2/3", "3/3"}) {
        parts.merge(lines({"--shard", shard_name}));
    }
    EXPECT_EQ(parts.size(), 8u);
    EXPECT_EQ(parts, lines({}));
    const CommandResult many = run(whole, {"--shard", "1/5"});
    EXPECT_EQ(many.exit_code, 2);
    EXPECT_EQ(many.err,
              "ptbench: --shard: argument: found \"1/5\", allowed: at most 4 parts of this run: cells of one scene and "
              "setting stay together\n");
    EXPECT_FALSE(std::filesystem::exists(whole));
}

// Errors, their references and images: names beside the new file, and the files.
TEST_F(ShardedRunTest, ImagesComeAlong) {
    write_text(folder.file("suite.json"), R"({"name": "mine", "repetitions": 8, "studies": [
        {"name": "e", "type": "convergence", "scenes": ["cornell_open", "cornell_closed"], "images": true,
         "axes": {"integrator": ["depth_first"], "layout": ["aos", "soa"], "direct_light": ["off", "final_bounce"]},
         "reference": {"variance": 1}, "depth": [3], "resolution": [4, 3], "spp": 2}]})");
    const Arguments cache{"--reference-cache", folder.file("references")};
    ASSERT_EQ(run(whole, cache).exit_code, 0);
    run_shards(2, cache);
    EXPECT_EQ(merge({shard(1), shard(2)}).exit_code, 0);
    std::string text = content_of(merged);
    for (std::size_t at = text.find("merged_images/"); at != std::string::npos; at = text.find("merged_images/")) {
        text.replace(at, 7 + 6, "whole_images");
    }
    EXPECT_EQ(without_times(without_shards(json::parse(text))), without_times(parsed(whole)));
    std::size_t images = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.file("whole_images"))) {
        EXPECT_EQ(content_of(folder.file("merged_images/" + entry.path().filename().string())),
                  content_of(entry.path().string()));
        ++images;
    }
    EXPECT_GE(images, 2u * (1 + 2));
    EXPECT_EQ(images, static_cast<std::size_t>(
                          std::distance(std::filesystem::directory_iterator(folder.file("merged_images")), {})));
}

}  // namespace
}  // namespace pt::test
