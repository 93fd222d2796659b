// The result file, from a plan and a journal made by hand: every row, aggregate and status that follows from them.
#include "harness/bench/result_file.h"

#include <set>

#include <gtest/gtest.h>

#include "harness/bench/result_check.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

TEST(AggregateTest, MatchesNumbersWorkedOutByHand) {
    const Aggregates odd = aggregate({6, 1, 2});
    EXPECT_DOUBLE_EQ(odd.mean, 3);
    EXPECT_DOUBLE_EQ(odd.median, 2);
    EXPECT_DOUBLE_EQ(odd.stddev, std::sqrt(7.0));  // ((3)^2 + 2^2 + 1^2) / 2
    EXPECT_DOUBLE_EQ(odd.cv, std::sqrt(7.0) / 3);
    const Aggregates even = aggregate({4, 1, 2, 9});
    EXPECT_DOUBLE_EQ(even.mean, 4);
    EXPECT_DOUBLE_EQ(even.median, 3);
    const Aggregates one = aggregate({5});
    EXPECT_DOUBLE_EQ(one.mean, 5);
    EXPECT_DOUBLE_EQ(one.median, 5);
    EXPECT_DOUBLE_EQ(one.stddev, 0);
    EXPECT_DOUBLE_EQ(one.cv, 0);
    EXPECT_DOUBLE_EQ(aggregate({0, 0}).cv, 0);  // and not a NaN, which JSON cannot hold
}

Sample sample(double wall, double cpu, std::uint64_t seed) {
    return {.wall_ms = wall,
            .cpu_ms = cpu,
            .device_ms = wall,
            .seed = seed,
            .paths = 9,
            .rays = 77,
            .rays_per_second = 5e7,
            .film_hash = "0123456789abcdef"};
}

// ---- The schema ----

using Keys = std::set<std::string>;

struct KeyCollector {
    Keys& keys;

    template <class T>
    void operator()(const char* key, const T&) const {
        keys.insert(key);
    }
    template <class T>
    void or_null(const char* key, const T&) const {
        keys.insert(key);
    }
};

template <HasFields T>
Keys keys_of() {
    Keys keys;
    T facts;
    T::fields(facts, KeyCollector{keys});
    return keys;
}

// The keys that the schema of results describes of one of its objects.
Keys described(const std::string& object) {
    static const Json schema =
        Json::parse(test::content_of(test::in_source("analysis/ptbench/schema/ptbench-result.schema.json")));
    Keys keys;
    for (const auto& [key, meaning] : schema.at("$defs").at(object).at("properties").items()) {
        keys.insert(key);
    }
    return keys;
}

// A field of a sample is in three files: its struct, where it is measured, and the schema. The journal's schema has a
// sample from there, but for the time whose key in a row is Google Benchmark's.
TEST(SchemaTest, DescribesEachFieldThatIsWritten) {
    Keys sample = described("sample");
    sample.insert("cpu_ms");
    EXPECT_EQ(keys_of<Sample>(), sample);
    EXPECT_EQ(keys_of<CheckpointFacts>(), described("checkpoint"));
    EXPECT_EQ(keys_of<CellFacts>(), described("cell_facts"));
    EXPECT_EQ(keys_of<InstrumentedFacts>(), described("instrumented"));
    EXPECT_EQ(keys_of<ConvergenceFacts>(), described("convergence"));
    EXPECT_EQ(keys_of<ComparisonFacts>(), described("comparison"));
    EXPECT_EQ(keys_of<RunRecord>(), described("run"));
}

// Four cells: measured, failed, cut short, not reached.
class ResultFileTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    Plan plan;
    Suite suite{.name = "hand", .description = "", .studies = {}};
    Json result;

    void SetUp() override {
        suite.studies.push_back({.name = "a",
                                 .title = "Title",
                                 .compares = "compaction",
                                 .scenes = {},
                                 .axes = {},
                                 .tunables = {},
                                 .more_sizes = {},
                                 .depths = {}});
        auto scene = std::make_shared<Scene>(test::SceneBuilder().scene);
        scene->name = "dark";
        scene->hash = "fedcba9876543210";
        for (const char* name : {"ok", "failed", "short", "missing"}) {
            plan.cells.push_back({.name = name,
                                  .studies = {"a"},
                                  .scene = scene,
                                  .variant = Registry::instance().baseline(),
                                  .settings = {.width = 20, .height = 10, .depth = 4},
                                  .spp = 2});
        }
        Variant tuned = Registry::instance().baseline();
        tuned.set("first_bounce", "cached_jitters");
        tuned.tuning["jitters"] = 4;
        plan.cells[2].variant = tuned;
        plan.cells[3].variant.set("first_bounce", "cached_jitters");
        Variant cached = Registry::instance().baseline();
        cached.set("first_bounce", "cached");
        plan.not_applicable.push_back({"a",
                                       "dark",
                                       Backend::cpu,
                                       cached,
                                       {"needs_no_jitter", "first_bounce=cached needs jitter off", "first_bounce"}});
        Journal journal(folder.file("journal"), Json("identity"), false);
        journal.set_cell("ok", {.film_hash = "abc", .instrumented = InstrumentedFacts{.spp = 2}});
        journal.set_cell("failed", {.status = CellStatus::failed, .reason = "film differs"});
        journal.set_cell("short", {});
        std::uint64_t seed = 1;
        for (const double wall : {6.0, 1.0, 2.0}) {
            journal.add_sample("ok", sample(wall, 2 * wall, seed++));
        }
        journal.add_sample("short", sample(5, 7, 1));
        const std::string text = result_json(plan, suite, journal,
                                             {.command_line = "ptbench run \"x\"",
                                              .suite = "hand",
                                              .date = "2026-01-02T03:04:05+0000",
                                              .completed = false,
                                              .repetitions = 3});
        EXPECT_EQ(text.back(), '\n');
        result = Json::parse(text);
    }
    std::vector<Json> rows_of(const std::string& cell, const std::string& run_type) const {
        std::vector<Json> rows;
        for (const Json& row : result.at("benchmarks")) {
            if (row.at("run_name") == cell && row.at("run_type") == run_type) {
                rows.push_back(row);
            }
        }
        return rows;
    }
};

TEST(RowsOnLinesTest, AnElementIsALine) {
    const nlohmann::ordered_json value = nlohmann::ordered_json::parse(
        R"({"b": {"list": [{"x": [1, 2]}, {"x": []}], "empty": {}}, "a": 0.1, "none": []})");
    EXPECT_EQ(
        rows_on_lines(value),
        "{\n\"b\": {\n\"list\": [\n{\"x\":[1,2]},\n{\"x\":[]}\n],\n\"empty\": {}\n},\n\"a\": 0.1,\n\"none\": []\n}");
    EXPECT_EQ(nlohmann::ordered_json::parse(rows_on_lines(value)), value);
}

TEST_F(ResultFileTest, HasOneRowASampleInOrder) {
    const std::vector<Json> rows = rows_of("ok", "iteration");
    ASSERT_EQ(rows.size(), 3u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Json& row = rows[i];
        const double wall = std::vector{6.0, 1.0, 2.0}[i];
        EXPECT_EQ(row.at("name"), "ok");
        EXPECT_EQ(row.at("repetitions"), 3);
        EXPECT_EQ(row.at("repetition_index"), i);
        EXPECT_EQ(row.at("threads"), 1);
        EXPECT_EQ(row.at("iterations"), 1);
        EXPECT_EQ(row.at("real_time"), wall);
        EXPECT_EQ(row.at("cpu_time"), 2 * wall);
        EXPECT_EQ(row.at("time_unit"), "ms");
        EXPECT_EQ(row.at("pt_wall_ms"), wall);
        EXPECT_EQ(row.at("pt_seed"), i + 1);
        EXPECT_EQ(row.at("pt_rays"), 77);
        EXPECT_EQ(row.at("film_hash").get<std::string>().size(), 16u);
        EXPECT_FALSE(row.contains("error_occurred"));
    }
}

TEST_F(ResultFileTest, HasTheAggregatesOfTheSamples) {
    const std::vector<Json> rows = rows_of("ok", "aggregate");
    ASSERT_EQ(rows.size(), 4u);
    const double root = std::sqrt(7.0);
    const struct {
        const char* name;
        double real, cpu;
        const char* unit;
    } expected[] = {{"mean", 3, 6, "time"},
                    {"median", 2, 4, "time"},
                    {"stddev", root, 2 * root, "time"},
                    {"cv", root / 3, root / 3, "percentage"}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].at("name"), std::string("ok_") + expected[i].name);
        EXPECT_EQ(rows[i].at("aggregate_name"), expected[i].name);
        EXPECT_EQ(rows[i].at("aggregate_unit"), expected[i].unit);
        EXPECT_DOUBLE_EQ(rows[i].at("real_time"), expected[i].real);
        EXPECT_DOUBLE_EQ(rows[i].at("cpu_time"), expected[i].cpu);
        EXPECT_EQ(rows[i].at("time_unit"), "ms");
        EXPECT_EQ(rows[i].at("iterations"), 3);
    }
}

// What gbench/report.py and compare.py of Google Benchmark 1.7.1 read of a row.
TEST_F(ResultFileTest, EveryRowHasWhatComparePyReads) {
    for (const Json& row : result.at("benchmarks")) {
        for (const char* key :
             {"name", "run_name", "run_type", "real_time", "cpu_time", "time_unit", "iterations", "repetitions"}) {
            EXPECT_TRUE(row.contains(key)) << key << " in " << row.dump();
        }
        EXPECT_EQ(row.contains("repetition_index"), row.at("run_type") == "iteration");
        EXPECT_EQ(row.contains("aggregate_name"), row.at("run_type") == "aggregate");
        EXPECT_TRUE(row.at("family_index").is_number());
    }
}

TEST_F(ResultFileTest, AFailedCellHasAnErrorRow) {
    const std::vector<Json> rows = rows_of("failed", "iteration");
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].at("error_occurred"), true);
    EXPECT_EQ(rows[0].at("error_message"), "film differs");
    EXPECT_TRUE(rows_of("failed", "aggregate").empty());
    EXPECT_TRUE(rows_of("missing", "iteration").empty());
}

TEST_F(ResultFileTest, CellsSayWhatTheyAreAndHowTheyEnded) {
    const Json& cells = result.at("ptbench").at("cells");
    ASSERT_EQ(cells.size(), 4u);
    const Json& ok = cells[0];
    EXPECT_EQ(ok.at("cell"), "ok");
    EXPECT_EQ(ok.at("studies"), Json({"a"}));
    EXPECT_EQ(ok.at("scene"), "dark");
    EXPECT_EQ(ok.at("scene_hash"), "fedcba9876543210");
    EXPECT_EQ(ok.at("backend"), "cpu");
    EXPECT_EQ(ok.at("variant"), "wavefront");
    EXPECT_EQ(ok.at("axes"), Json::parse(R"({"integrator": "wavefront", "compaction": "none", "sorting": "none",
        "sort_key": "material", "first_bounce": "off", "direct_light": "off", "russian_roulette": "off",
        "sampler": "pcg4d", "layout": "aos",
        "specialisation": "features", "launch": "stream", "arithmetic": "exact", "precision": "float", "robustness": "robust",
        "accelerator": "brute_force", "builder": "sah_binned", "traversal": "while_while", "traversal_stack": "local",
        "levels": "each_object", "light_sampling": "solid_angle", "devices": "1", "partition": "samples",
        "light_selection": "uniform", "subsurface_sampling": "classical"})"));
    EXPECT_EQ(ok.at("resolution"), Json({20, 10}));
    EXPECT_EQ(ok.at("depth"), 4);
    EXPECT_EQ(ok.at("spp"), 2);
    EXPECT_EQ(ok.at("claim"), "bitwise");
    EXPECT_EQ(ok.at("film_hash"), "abc");
    EXPECT_TRUE(ok.at("features").is_array());
    EXPECT_EQ(ok.at("instrumented").at("spp"), 2);
    const std::pair<std::string, std::string> ends[] = {
        {"ok", ""},
        {"failed", "film differs"},
        {"interrupted", "the run ended before this cell had all its samples"},
        {"interrupted", "the run ended before this cell was reached"},
    };
    for (std::size_t i = 0; i < std::size(ends); ++i) {
        EXPECT_EQ(cells[i].at("status"), ends[i].first);
        EXPECT_EQ(cells[i].at("reason"), ends[i].second);
    }
}

// With the value that each had, asked for or not.
TEST_F(ResultFileTest, CellsSayHowTheyWereTuned) {
    const Json& cells = result.at("ptbench").at("cells");
    EXPECT_EQ(cells[0].at("tunables"), Json({{"room", 1}}));
    EXPECT_EQ(cells[2].at("tunables"), Json({{"jitters", 4}, {"room", 1}}));
    EXPECT_EQ(cells[2].at("claim"), "biased");
    EXPECT_EQ(cells[2].at("variant"), "wavefront first_bounce=cached_jitters jitters=4");
    EXPECT_EQ(cells[3].at("tunables"), Json({{"jitters", 16}, {"room", 1}}));
    EXPECT_EQ(cells[3].at("variant"), "wavefront first_bounce=cached_jitters");
}

// What an axis is at where nothing was asked for: readers need no registry.
TEST_F(ResultFileTest, HasTheBaselineOfEveryAxis) {
    EXPECT_EQ(result.at("ptbench").at("baselines"), result.at("ptbench").at("cells")[0].at("axes"));
}

TEST_F(ResultFileTest, StudiesAndWhatDoesNotApply) {
    EXPECT_EQ(
        result.at("ptbench").at("studies"),
        Json::parse(R"([{"name": "a", "title": "Title", "compares": "compaction", "along": "", "type": "time"}])"));
    const Json& entries = result.at("ptbench").at("not_applicable");
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].at("study"), "a");
    EXPECT_EQ(entries[0].at("scene"), "dark");
    EXPECT_EQ(entries[0].at("variant"), "wavefront first_bounce=cached");
    EXPECT_EQ(entries[0].at("axes").at("first_bounce"), "cached");
    EXPECT_EQ(entries[0].at("reason"), "first_bounce=cached needs jitter off");
    EXPECT_EQ(entries[0].at("reason_code"), "needs_no_jitter");
    EXPECT_EQ(entries[0].at("reason_axis"), "first_bounce");
}

TEST_F(ResultFileTest, ContextHasGoogleBenchmarksKeysAndOurs) {
    const Json& context = result.at("context");
    EXPECT_EQ(context.at("date"), "2026-01-02T03:04:05+0000");
    EXPECT_EQ(context.at("executable"), "ptbench");
    EXPECT_TRUE(context.at("host_name").is_string());
    EXPECT_TRUE(context.at("num_cpus").is_number());
    EXPECT_TRUE(context.at("mhz_per_cpu").is_number());
    EXPECT_TRUE(context.at("caches").is_array());
    EXPECT_TRUE(context.at("load_avg").is_array());
    for (const char* key :
         {"schema_version", "version", "git_sha", "git_dirty", "command_line", "machine", "cpu_model", "os", "compiler",
          "compiler_flags", "backend", "threads", "thrust_version", "suite", "status"}) {
        const std::string prefixed = std::string("ptbench.") + key;
        ASSERT_TRUE(context.contains(prefixed)) << key;
        EXPECT_TRUE(context.at(prefixed).is_string()) << key;
        EXPECT_FALSE(context.at(prefixed).get<std::string>().empty()) << key;
    }
    EXPECT_EQ(context.at("ptbench.schema_version"), "1");
    EXPECT_EQ(context.at("ptbench.command_line"), "ptbench run \"x\"");
    EXPECT_EQ(context.at("ptbench.suite"), "hand");
    EXPECT_EQ(context.at("ptbench.backend"), "cpu");
    EXPECT_EQ(context.at("ptbench.status"), "interrupted");
}

// A journal that somebody edited, seal and all: refused in one line before a run goes on with it.
TEST_F(ResultFileTest, WhatNoRunWroteIsRefused) {
    const std::string file = folder.file("edited");
    const Sample good_sample = sample(1, 2, 3);
    const auto refusal = [&](bool has_cell, const Sample& edited) {
        std::filesystem::remove(file);
        Journal journal(file, "identity", false);
        if (has_cell) {
            journal.set_cell("ok", {});
        }
        journal.add_sample("ok", edited);
        try {
            check_journal(plan, journal);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal(true, good_sample), "");
    // Times and counts that no sample can have are refused.
    const auto with = [&](auto member, auto value) {
        Sample impossible = good_sample;
        impossible.*member = value;
        return fault_of_sample(impossible);
    };
    EXPECT_EQ(fault_of_sample(good_sample), "");
    EXPECT_EQ(with(&Sample::wall_ms, 0.0), "pt_wall_ms 0, not above 0");
    EXPECT_EQ(with(&Sample::wall_ms, INFINITY), "pt_wall_ms null");
    EXPECT_EQ(with(&Sample::clock_mhz_after, NAN), "pt_clock_mhz_after null");
    EXPECT_EQ(with(&Sample::device_ms, 0.0), "pt_device_ms 0, not above 0");
    EXPECT_EQ(with(&Sample::device_ms, 1.1), "pt_device_ms 1.1 above its pt_wall_ms 1");
    EXPECT_EQ(with(&Sample::end_to_end_ms, 0.9), "pt_end_to_end_ms 0.9 below its pt_wall_ms 1");
    Sample slow_device = good_sample;
    slow_device.device_ms = 1.1;
    EXPECT_EQ(refusal(true, slow_device),
              file +
                  ": ok: found a sample with pt_device_ms 1.1 above its pt_wall_ms 1, allowed: "
                  "what a render can leave; remove the file to start over");
    EXPECT_EQ(refusal(false, good_sample),
              file +
                  ": ok: found samples without the cell's own line, allowed: what ptbench wrote; remove the file to "
                  "start over");
    plan.cells[0].convergence = CellConvergence();
    EXPECT_EQ(refusal(true, good_sample),
              file +
                  ": ok: found a cell with checkpoints without its errors, allowed: what ptbench wrote; remove the "
                  "file to start over");
}

}  // namespace
}  // namespace pt
