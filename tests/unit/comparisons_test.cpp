// The pairs and verdicts of a run: those of the pages drawn from its file, row by row, and the table that shows them.
#include "harness/bench/comparisons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include <gtest/gtest.h>

#include "harness/bench/error_table.h"
#include "harness/bench/older_suites.h"
#include "harness/bench/result_file.h"
#include "harness/bench/retakes.h"
#include "harness/bench/short_names.h"
#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

Sample sample(double wall, double foreign = 0) { return {.wall_ms = wall, .cpu_ms = wall, .foreign_cpu_ms = foreign}; }

Study study_of(const std::string& name, const std::string& compares, const std::string& along = "") {
    Study study;
    study.name = name;
    study.title = "The " + name;
    study.compares = compares;
    study.along = along;
    return study;
}

std::shared_ptr<const Scene> scene_called(const std::string& name) {
    Scene scene = test::SceneBuilder().scene;
    scene.name = name;
    return std::make_shared<Scene>(scene);
}

// ---- A committed result file as the run that wrote it ----

struct CommittedRun {
    test::TemporaryFolder folder;
    Journal journal{folder.file("journal"), Json::object(), false};
    Suite suite{.name = "", .description = "", .studies = {}};
    Plan plan;

    explicit CommittedRun(const Json& file) {
        for (const Json& study : file.at("ptbench").at("studies")) {
            suite.studies.push_back(study_of(study.at("name"), ""));
            if (const Json figure = study.at(older_figure_key); figure != "" && figure != "convergence") {
                // A tunable may be one that no cell on this backend has.
                const Compared compared = compared_by_figure(JsonValue(figure, "", "$"), {figure});
                suite.studies.back().compares = compared.compares;
                suite.studies.back().along = compared.along;
            }
        }
        for (const Json& facts : file.at("ptbench").at("cells")) {
            plan.cells.push_back(cell_of(facts));
            add_errors(plan.cells.back(), facts);
        }
        std::vector<Json> rows;
        for (const Json& row : file.at("benchmarks")) {
            if (row.at("run_type") == "iteration") {
                rows.push_back(row);
                rows.back()["cpu_ms"] = row.at("cpu_time");
            }
        }
        std::stable_sort(rows.begin(), rows.end(), [](const Json& a, const Json& b) {
            return a.at("repetition_index").get<int>() < b.at("repetition_index").get<int>();
        });
        for (const Json& row : rows) {
            journal.add_sample(row.at("run_name"), sample_of_result(row));
        }
    }

    // Adds the reference that a cell's images were compared with, if it is of a study of error.
    void add_errors(Cell& cell, const Json& facts) {
        const auto convergence = facts.find("convergence");
        if (convergence == facts.end()) {
            return;
        }
        const Json& reference = convergence->at("reference");
        cell.convergence = CellConvergence();
        cell.convergence->checkpoints = convergence->at("checkpoints").get<std::vector<std::uint32_t>>();
        cell.convergence->reference.scene = scene_called(reference.at("scene"));
        cell.convergence->reference.depth = reference.at("depth");
        journal.set_cell(cell.name,
                         {.status = facts.at("status"), .convergence = Json(*convergence).get<ConvergenceFacts>()});
    }

    static Cell cell_of(const Json& facts) {
        Variant variant = Registry::instance().baseline();  // of axes that came after the file
        for (const auto& [axis, choice] : facts.at("axes").items()) {
            variant.set(axis, choice);
        }
        for (const Tunable& t : tunables_of(variant, Backend::cpu)) {
            const std::string name(t.name);
            const std::uint32_t value = facts.value("tunables", Json::object()).value(name, t.default_value);
            if (value != t.default_value) {
                variant.tuning[name] = value;
            }
        }
        return {.name = facts.at("cell"),
                .studies = facts.at("studies"),
                .scene = scene_called(facts.at("scene")),
                .variant = variant,
                .settings = {.width = facts.at("resolution").at(0),
                             .height = facts.at("resolution").at(1),
                             .depth = facts.at("depth")},
                .spp = facts.at("spp")};
    }

    Cells cells_of(const Study& study) const {
        Cells cells;
        for (const Cell& cell : plan.cells) {
            if (std::find(cell.studies.begin(), cell.studies.end(), study.name) != cell.studies.end()) {
                cells.push_back(&cell);
            }
        }
        return cells;
    }

    // The pairs as tests/analysis/test_run_verdicts.py writes them.
    Json pairs() const {
        Json pairs = Json::array();
        for (const Comparison& comparison : comparisons_of(plan, suite, journal)) {
            if (comparison.baseline) {
                pairs.push_back({comparison.study, index_of(comparison.cell), index_of(*comparison.baseline),
                                 comparison.ratio->value, comparison.ratio->interval->low,
                                 comparison.ratio->interval->high, to_text(comparison.verdict.word)});
            }
        }
        return pairs;
    }

    std::ptrdiff_t index_of(const std::string& cell) const {
        return std::find_if(plan.cells.begin(), plan.cells.end(), [&](const Cell& one) { return one.name == cell; }) -
               plan.cells.begin();
    }
};

// The errors as tests/analysis/test_run_errors.py writes them: study, cell, baseline, and for MSE and relMSE the mean
// error, the efficiency and the ends of its interval.
Json errors_in(const CommittedRun& run) {
    Json rows = Json::array();
    for (const Study& study : run.suite.studies) {
        Cells cells = run.cells_of(study);
        std::erase_if(cells, [](const Cell* cell) { return !cell->convergence; });
        for (const Cells& group : by_image(cells)) {
            const std::vector<LastErrors> errors = last_errors(run.plan, group, run.journal);
            const LastErrors* const baseline = baseline_of(errors, run.journal);
            for (const LastErrors& one : errors) {
                Json row = {study.name, one.cell - run.plan.cells.data(), baseline->cell - run.plan.cells.data()};
                for (const auto& [values, efficiency] :
                     {std::pair(one.mse, one.efficiency_by_mse(*baseline)),
                      std::pair(one.rel_mse, one.efficiency_by_rel_mse(*baseline))}) {
                    row.push_back(std::accumulate(values.begin(), values.end(), 0.0) /
                                  static_cast<double>(values.size()));
                    const bool is_told = &one != baseline && efficiency.has_value();
                    row.push_back(is_told ? Json(efficiency->value) : Json());
                    row.push_back(is_told ? Json(efficiency->interval->low) : Json());
                    row.push_back(is_told ? Json(efficiency->interval->high) : Json());
                }
                rows.push_back(row);
            }
        }
    }
    return rows;
}

// A committed result, which is stored compressed; empty where gzip cannot read it.
std::string content_of_result(const std::string& file) {
    const std::string command = "gzip -dc '" + test::in_source(file) + ".gz'";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::string content;
    std::array<char, 65536> block;
    while (pipe != nullptr) {
        const std::size_t count = std::fread(block.data(), 1, block.size(), pipe.get());
        content.append(block.data(), count);
        if (count == 0) {
            break;
        }
    }
    return content;
}

// Python judges files that hold no comparisons: the pairs and ratios are these, bit for bit. Its intervals have other
// random numbers, so an end may lie at another value; where that decides, one of the two is UNSURE.
TEST(ComparisonsTest, CommittedResultsHaveTheVerdictsThatPythonGivesThem) {
    const Json expected = Json::parse(test::content_of(test::in_source("tests/support/run_verdicts.json")));
    ASSERT_GE(expected.size(), 4u);
    std::size_t count = 0, same_word = 0;
    for (const auto& [file, pairs] : expected.items()) {
        const CommittedRun run(Json::parse(content_of_result(file)));
        const Json found = run.pairs();
        ASSERT_EQ(found.size(), pairs.size()) << file;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            for (const std::size_t place : {0, 1, 2, 3}) {
                EXPECT_EQ(found[i][place], pairs[i][place]) << file << ": " << pairs[i];
            }
            count += 1;
            same_word += found[i][6] == pairs[i][6] ? 1 : 0;
            EXPECT_TRUE(found[i][6] == pairs[i][6] || found[i][6] == "UNSURE" || pairs[i][6] == "UNSURE") << pairs[i];
        }
    }
    EXPECT_GE(same_word, count - count / 50) << "of " << count;
}

// Errors and efficiencies to rounding, as NumPy adds in another order; the intervals' ends by the width of a
// bootstrap's own noise, as Python draws other random numbers.
TEST(ComparisonsTest, CommittedResultsHaveTheErrorsAndEfficienciesThatPythonGivesThem) {
    const Json expected = Json::parse(test::content_of(test::in_source("tests/support/run_errors.json")));
    ASSERT_GE(expected.size(), 1u);
    for (const auto& [file, rows] : expected.items()) {
        const Json found = errors_in(CommittedRun(Json::parse(content_of_result(file))));
        ASSERT_EQ(found.size(), rows.size()) << file;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            ASSERT_EQ(found[i].size(), rows[i].size()) << file;
            for (std::size_t k = 0; k < rows[i].size(); ++k) {
                if (rows[i][k].is_number_float()) {
                    const double value = rows[i][k];
                    const bool is_end = k == 5 || k == 6 || k == 9 || k == 10;
                    EXPECT_NEAR(found[i][k].get<double>(), value, (is_end ? 0.05 : 1e-9) * std::abs(value))
                        << file << ": " << rows[i];
                } else {
                    EXPECT_EQ(found[i][k], rows[i][k]) << file << ": " << rows[i];
                }
            }
        }
    }
}

// ---- Runs made by hand ----

class TableTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    Journal journal{folder.file("journal"), Json::object(), false};
    Suite suite{.name = "hand", .description = "", .studies = {study_of("a", "layout")}};
    Plan plan;
    Backend backend = Backend::cpu;

    Cell& add(const std::map<std::string, std::string>& axes, double ms, int samples = 9) {
        Variant variant = Registry::instance().baseline(backend);
        for (const auto& [axis, choice] : axes) {
            variant.set(axis, choice);
        }
        plan.cells.push_back({.name = std::to_string(plan.cells.size()),
                              .studies = {"a"},
                              .scene = scene_called("box"),
                              .backend = backend,
                              .variant = variant,
                              .settings = {.width = 20, .height = 10, .depth = 4},
                              .spp = 2});
        if (samples > 0) {
            journal.set_cell(plan.cells.back().name, CellFacts());
        }
        for (int i = 0; i < samples; ++i) {
            journal.add_sample(plan.cells.back().name, sample(ms));
        }
        return plan.cells.back();
    }
    std::string table() const { return verdict_table(plan, suite, journal, comparisons()); }

    // The run's comparisons, which are those of its file too.
    std::vector<Comparison> comparisons() const {
        std::vector<Comparison> found = comparisons_of(plan, suite, journal);
        if (!suite.studies[0].convergence) {
            const ComparedRun run = compared_run(plan, journal);
            const auto file = nlohmann::ordered_json::parse(result_json(plan, suite, journal, RunFacts()));
            const ComparedRun written = compared_run(file.at("benchmarks"), file.at("ptbench").at("cells"),
                                                     nlohmann::ordered_json(run.baselines));
            EXPECT_EQ(facts_of(comparisons_of(written, suite.studies)), facts_of(found));
        }
        return found;
    }
    static Json facts_of(const std::vector<Comparison>& comparisons) {
        Json facts = Json::array();
        for (const Comparison& comparison : comparisons) {
            facts.push_back(comparison.facts());
        }
        return facts;
    }
};

TEST_F(TableTest, HasALineACellWithItsVerdict) {
    suite.studies[0].compares = "compaction";
    add({}, 10);
    add({{"compaction", "thrust_remove_if"}}, 30);
    add({{"compaction", "thrust_partition"}}, 10);
    add({{"layout", "soa"}}, 20, 3);
    add({{"layout", "soa"}, {"compaction", "thrust_remove_if"}}, 18, 3);
    add({{"sorting", "bucket"}, {"compaction", "thrust_remove_if"}}, 18);    // its baseline was not run
    add({{"sorting", "bucket"}, {"compaction", "thrust_partition"}}, 1, 0);  // interrupted before it
    journal.set_cell(add({{"compaction", "thrust_copy_if_index"}}, 1).name, {.status = CellStatus::failed});
    EXPECT_EQ(table(),
              "box 20x10, depth 4, 2 spp on cpu: ratio to compaction=none, all else equal\n"
              "    ms/spp   ratio  95 % interval     verdict   variant\n"
              "         5                            baseline  wavefront\n"
              "        15   3.000  [3.000, 3.000]    SLOWER    wavefront compaction=thrust_remove_if\n"
              "         5   1.000  [1.000, 1.000]    SAME      wavefront compaction=thrust_partition\n"
              "        10                            baseline  wavefront layout=soa\n"
              "         9   0.900  [0.900, 0.900]    UNSURE    wavefront compaction=thrust_remove_if layout=soa\n"
              "         9                                      wavefront compaction=thrust_remove_if sorting=bucket\n"
              "                                      FAILED    wavefront compaction=thrust_copy_if_index\n"
              "UNSURE (1): n = 3, a verdict needs 9\n");
}

// What it left before it failed is no error of the variant's, nor a time.
TEST_F(TableTest, ACellThatFailedHasNoErrorAndNoEfficiency) {
    suite.studies[0].convergence = ConvergenceSettings{};
    for (const char* const layout : {"aos", "soa"}) {
        Cell& cell = add({{"layout", layout}}, 2, 0);
        cell.name += "/checkpoints:octaves";
        cell.convergence = CellConvergence();
        cell.convergence->checkpoints = {1, 2};
        cell.convergence->reference.scene = cell.scene;
        for (int i = 0; i < 9; ++i) {
            Sample row = sample(2);
            row.checkpoints = {{.mse_dual = 1, .rel_mse_dual = 1}, {.mse_dual = 0.5, .rel_mse_dual = 0.5}};
            journal.add_sample(cell.name, row);
        }
        journal.set_cell(cell.name, {.status = cell.variant["layout"] == "soa" ? CellStatus::failed : CellStatus::ok,
                                     .convergence = ConvergenceFacts{.independent_samples = true}});
    }
    const std::string text = table();
    EXPECT_NE(text.find("  baseline   wavefront\n"), std::string::npos) << text;
    EXPECT_NE(text.find("  FAILED     wavefront layout=soa\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("1.000 ["), std::string::npos) << text;
}

TEST_F(TableTest, TheFileHoldsEveryComparisonOrWhyThereIsNone) {
    suite.studies[0].compares = "compaction";
    suite.studies.push_back(study_of("b", live_paths));  // compares nothing
    add({}, 10);
    add({{"compaction", "thrust_remove_if"}}, 30).studies = {"a", "b"};
    add({{"layout", "soa"}}, 20);
    add({{"layout", "soa"}, {"compaction", "thrust_remove_if"}}, 18, 3);
    add({{"sorting", "bucket"}, {"compaction", "thrust_remove_if"}}, 18);
    add({{"sorting", "bucket"}, {"layout", "soa"}}, 1, 0);
    add({{"sorting", "bucket"}, {"layout", "soa"}, {"compaction", "thrust_partition"}}, 18);
    EXPECT_EQ(facts_of(comparisons()), Json::parse(R"([
        {"study": "a", "cell": "1", "baseline": "0", "ratio": 3.0, "interval": [3.0, 3.0], "word": "SLOWER",
         "reason_code": "", "in_time": "SLOWER", "in_cycles": null},
        {"study": "a", "cell": "3", "baseline": "2", "ratio": 0.9, "interval": [0.9, 0.9], "word": "UNSURE",
         "reason_code": "few_samples", "in_time": "UNSURE", "in_cycles": null},
        {"study": "a", "cell": "4", "baseline": null, "ratio": null, "interval": null, "word": null,
         "reason_code": "no_baseline", "in_time": null, "in_cycles": null},
        {"study": "a", "cell": "6", "baseline": "5", "ratio": null, "interval": null, "word": null,
         "reason_code": "baseline_not_measured", "in_time": null, "in_cycles": null}])"));
}

TEST_F(TableTest, ScenesAndSettingsStandTogetherAndStudiesHaveTheirTitles) {
    suite.studies.push_back(study_of("b", live_paths));
    add({}, 1).settings.depth = 8;
    add({}, 2).studies = {"a", "b"};
    add({{"layout", "soa"}}, 2).settings.depth = 8;
    EXPECT_EQ(table(),
              "a: The a\n"
              "box 20x10, depth 8, 2 spp on cpu: ratio to layout=aos, all else equal\n"
              "    ms/spp   ratio  95 % interval     verdict   variant\n"
              "       0.5                            baseline  wavefront\n"
              "         1   2.000  [2.000, 2.000]    SLOWER    wavefront layout=soa\n"
              "box 20x10, depth 4, 2 spp on cpu: ratio to layout=aos, all else equal\n"
              "    ms/spp   ratio  95 % interval     verdict   variant\n"
              "         1                            baseline  wavefront\n"
              "b: The b\n"
              "box 20x10, depth 4, 2 spp on cpu\n"
              "    ms/spp   ratio  95 % interval     verdict   variant\n"
              "         1                                      wavefront\n");
}

TEST_F(TableTest, ATunableIsHeldAgainstItsStandard) {
    suite.studies[0].compares = "jitters";
    add({{"first_bounce", "cached_jitters"}}, 2).variant.tuning["jitters"] = 2;
    add({{"first_bounce", "cached_jitters"}}, 1);
    EXPECT_NE(table().find(": ratio to jitters=16, all else equal\n"), std::string::npos) << table();
    EXPECT_NE(table().find("SLOWER    wavefront first_bounce=cached_jitters jitters=2\n"), std::string::npos)
        << table();
    EXPECT_NE(table().find("baseline  wavefront first_bounce=cached_jitters\n"), std::string::npos) << table();
}

TEST_F(TableTest, AStudyWithoutTheUsualBaselineIsHeldAgainstItsFirstChoice) {
    suite.studies[0] = study_of("a", "", along_depth);
    add({{"compaction", "thrust_remove_if"}}, 2);
    add({{"compaction", "thrust_partition"}}, 1);
    EXPECT_NE(table().find(": ratio to compaction=thrust_remove_if, all else equal\n"), std::string::npos) << table();
    EXPECT_NE(table().find("FASTER    wavefront compaction=thrust_partition\n"), std::string::npos) << table();
}

// Where nothing is sorted the key says nothing.
TEST_F(TableTest, ASortKeyNeedsNoBaselineOfItsOwn) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "there is one key on the CPU";
    }
    suite.studies[0].compares = "sorting";
    backend = Backend::cuda;
    add({}, 1);
    add({{"sorting", "bucket"}, {"sort_key", "ray"}}, 2);
    EXPECT_NE(table().find("SLOWER    wavefront sorting=bucket sort_key=ray\n"), std::string::npos) << table();
}

TEST_F(TableTest, EqualSamplesPerPixelArePreferredNotRequired) {
    add({}, 4).spp = 4;  // 1 ms/spp
    add({{"layout", "soa"}}, 4);
    const auto baseline = [&] { return comparisons().at(0).baseline; };
    EXPECT_EQ(baseline(), "0");
    add({}, 4);
    EXPECT_EQ(baseline(), "2");
}

// A tenth of a render's own CPU time may go to others, which a file's rows have by another key than a journal.
TEST_F(TableTest, ALongRenderIsNotDisturbedByAShortInterruption) {
    add({}, 300, 0);
    add({{"layout", "soa"}}, 600, 0);
    for (const auto& [cell, ms] : {std::pair("0", 300.0), std::pair("1", 600.0)}) {
        journal.set_cell(cell, CellFacts());
        for (int i = 0; i < 9; ++i) {
            journal.add_sample(cell, sample(ms, 25));
        }
    }
    EXPECT_NE(table().find("SLOWER "), std::string::npos) << table();
}

TEST_F(TableTest, MoreThanATenthOfTheSamplesDisturbedIsNoVerdict) {
    add({}, 100, 10);
    add({{"layout", "soa"}}, 200, 9);
    journal.add_sample("1", sample(200, 190));
    EXPECT_NE(table().find("SLOWER "), std::string::npos) << table();
    journal.add_sample("1", sample(200, 190));
    EXPECT_NE(table().find("UNSURE (1): other processes took CPU time"), std::string::npos) << table();
}

// A busy host can only make a render longer than the device worked.
TEST(DisturbedTest, OnAGpuTheDevicesClockTells) {
    Sample late = sample(200, 190), in_time = sample(200, 190);
    late.device_ms = 195;
    in_time.device_ms = 197;
    EXPECT_TRUE(is_disturbed(late, Backend::cuda));
    EXPECT_FALSE(is_disturbed(in_time, Backend::cuda));
    EXPECT_TRUE(is_disturbed(in_time, Backend::cpu));
    EXPECT_FALSE(is_disturbed(sample(200, 10), Backend::cpu));
}

// The device's clock goes on while the device waits, so it cannot tell.
TEST(DisturbedTest, ARenderThatWaitsForABusyHostIsDisturbed) {
    Sample waiting = sample(200, 190), alone = sample(200, 10);
    waiting.device_ms = alone.device_ms = 200;
    EXPECT_FALSE(is_disturbed(waiting, Backend::cuda));
    waiting.host_waits = alone.host_waits = 1;
    EXPECT_TRUE(is_disturbed(waiting, Backend::cuda));
    EXPECT_FALSE(is_disturbed(alone, Backend::cuda));
}

// However little else ran: the system itself withheld the time.
TEST(DisturbedTest, ASampleThatAQuotaThrottledIsDisturbed) {
    Sample throttled = sample(200), not_once = sample(200);
    throttled.throttled_periods = 1;
    throttled.throttled_ms = 0.01;
    EXPECT_TRUE(is_disturbed(throttled, Backend::cpu));
    EXPECT_FALSE(is_disturbed(not_once, Backend::cpu));
    throttled.device_ms = 200;
    EXPECT_FALSE(is_disturbed(throttled, Backend::cuda));
    throttled.host_waits = 1;
    EXPECT_TRUE(is_disturbed(throttled, Backend::cuda));

    const test::TemporaryFolder folder;
    Journal journal(folder.file("journal"), Json::object(), false);
    Plan plan;
    plan.cells.resize(1);
    plan.cells[0].name = "a";
    journal.set_cell("a", {});
    for (const Sample& facts : {throttled, not_once, sample(200, 190)}) {
        journal.add_sample("a", facts);
    }
    EXPECT_EQ(to_retake(plan.cells[0], journal, 9), (std::vector<std::size_t>{0, 2}));
    EXPECT_TRUE(times_of(plan.cells[0], journal).is_throttled);
    const Disturbance found = disturbance_of(plan, journal);
    EXPECT_EQ(in_words(found), "disturbed: 2 of 3 samples (other processes 1, CPU quota 1, low clock 0)");
    EXPECT_EQ(verdict_of({}, times_of(plan.cells[0], journal), {}).reason, WordReason::throttled);
}

TEST(DisturbedTest, AsManyAreTakenAgainAsTheLimitAllows) {
    const test::TemporaryFolder folder;
    Journal journal(folder.file("journal"), Json::object(), false);
    Plan plan;
    plan.cells.resize(2);
    plan.cells[0].name = "busy";
    plan.cells[1].name = "quiet";
    const auto numbered = [](std::uint64_t seed, double foreign) {
        Sample facts = sample(200, foreign);
        facts.seed = seed;
        return facts;
    };
    for (const Cell& cell : plan.cells) {
        journal.set_cell(cell.name, {});
        for (const std::uint64_t seed : {5, 6, 7}) {
            journal.add_sample(cell.name, numbered(seed, cell.name == "busy" && seed != 6 ? 190 : 10));
        }
    }
    const auto words = [&](int most) { return retakes_in_words(plan, journal, most); };
    EXPECT_EQ(to_retake(plan.cells[0], journal, 9), (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(to_retake(plan.cells[0], journal, 1), (std::vector<std::size_t>{0}));
    EXPECT_TRUE(to_retake(plan.cells[0], journal, 0).empty());
    EXPECT_TRUE(to_retake(plan.cells[1], journal, 9).empty());
    EXPECT_EQ(words(9), "retaken: 0 disturbed samples, at most 9 a cell; interrupted before 2 others could be");

    journal.retake_sample("busy", numbered(5, 190));  // disturbed again
    EXPECT_EQ(to_retake(plan.cells[0], journal, 9), (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(to_retake(plan.cells[0], journal, 2), (std::vector<std::size_t>{0}));
    EXPECT_TRUE(to_retake(plan.cells[0], journal, 1).empty());
    EXPECT_EQ(words(1),
              "retaken: 1 disturbed sample, at most 1 a cell; 1 cell came to that limit with disturbed samples left");

    journal.retake_sample("busy", numbered(5, 10));
    journal.retake_sample("busy", numbered(7, 10));
    EXPECT_TRUE(to_retake(plan.cells[0], journal, 9).empty());
    EXPECT_FALSE(times_of(plan.cells[0], journal).is_contended);
    EXPECT_EQ(words(9), "retaken: 3 disturbed samples, at most 9 a cell");
    EXPECT_EQ(words(3), "retaken: 3 disturbed samples, at most 3 a cell");
    const nlohmann::ordered_json file = retakes_json(plan, journal, 9);
    ASSERT_EQ(file.at("samples").size(), 3u);
    EXPECT_EQ(file.at("samples")[2].at("cell"), "busy");
    EXPECT_EQ(file.at("samples")[2].at("repetition_index"), 2);
    EXPECT_EQ(file.at("samples")[2].at("sample").at("pt_foreign_cpu_ms"), 190);
    journal.set_cell("busy", {.status = CellStatus::failed});
    journal.retake_sample("busy", numbered(7, 190));
    EXPECT_TRUE(to_retake(plan.cells[0], journal, 9).empty());  // nobody knows what it times
}

TEST(DisturbedTest, ARunCountsWhatItsVerdictsCount) {
    const test::TemporaryFolder folder;
    Journal journal(folder.file("journal"), Json::object(), false);
    Plan plan;
    plan.cells.resize(1);
    plan.cells[0].name = "cell";
    plan.cells[0].backend = Backend::cuda;
    for (const std::uint64_t waits : {0, 0, 2}) {
        Sample contended = sample(200, 190);
        contended.device_ms = 200;
        contended.host_waits = waits;
        journal.add_sample("cell", contended);
    }
    EXPECT_EQ(in_words(disturbance_of(plan, journal)).substr(0, 55),
              "disturbed: 1 of 3 samples (other processes 1, low clock");
}

TEST_F(TableTest, ShortNamesSayWhatDiffers) {
    add({}, 1);
    add({{"layout", "soa"}}, 1);
    EXPECT_EQ(ShortNames(plan).of(plan.cells[1]), "wavefront layout=soa, box");
    plan.cells[0].settings.depth = 8;
    EXPECT_EQ(ShortNames(plan).of(plan.cells[1]), "wavefront layout=soa, box, depth 4");
    plan.cells[0].settings.width = 8;
    plan.cells[0].spp = 1;
    EXPECT_EQ(ShortNames(plan).of(plan.cells[1]), "wavefront layout=soa, box, 20x10, depth 4, 2 spp");
}

}  // namespace
}  // namespace pt
