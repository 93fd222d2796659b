// Whole runs of a tiny suite, in this process: what they leave behind when all is well, when a choice fails, when they
// are interrupted, and when they go on after a kill.
#include "harness/bench/runner.h"

#include <csignal>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "harness/bench/journal.h"
#include "harness/counted.h"
#include "harness/interrupt.h"
#include "tests/support/command.h"
#include "tests/support/sealed_lines.h"
#include "variants/compaction/thrust_compaction.h"

namespace pt {
namespace {

// ---- Choices of this test: they work like thrust_remove_if, and call a hook when they are made, once a render ----

std::function<void()> on_render;  // may throw
std::function<void(PathQueue&)> on_compact;

class HookedCompaction final : public Compaction {
public:
    void compact(PathQueue& queue) override {
        original_->compact(queue);
        if (on_compact) {
            on_compact(queue);
        }
    }

private:
    std::unique_ptr<Compaction> original_ =
        Registry::instance().find("compaction", "thrust_remove_if")->hook.compaction();
};

const Registration hooked({.axis = "compaction",
                           .name = "test_hooked",
                           .summary = "calls back into a test",
                           .origin = "this test",
                           .check_counters = compacted_every_bounce},
                          {.compaction = [] {
                              if (on_render) {
                                  on_render();
                              }
                              return std::make_unique<HookedCompaction>();
                          }});

// ---- Runs ----

constexpr int repetitions = 3;
constexpr const char* scene_text = R"({
  "name": "tiny", "max_depth": 3, "environment": [1, 1, 1],
  "camera": {"eye": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [8, 6]},
  "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
  "objects": [{"shape": "box", "material": "white", "translate": [0, 0, 3], "rotate_degrees": [10, 20, 30]},
              {"shape": "box", "material": "white", "translate": [0, -1, 3], "scale": [9, 0.1, 9]}]
})";

class RunnerTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string out = folder.file("out/result.json");
    std::string journal_file = out + ".journal.jsonl";

    void SetUp() override {
        std::filesystem::create_directories(folder.path() / "scenes" / "suites");
        test::write_text(folder.file("scenes/tiny.json"), scene_text);
        ::setenv("PTBENCH_HOME", folder.path().c_str(), 1);
    }
    void TearDown() override {
        on_render = nullptr;
        on_compact = nullptr;
        ::unsetenv("PTBENCH_HOME");
    }

    Suite suite(const AxisChoices& axes) const {
        Study study;
        study.name = "study";
        study.title = "Title";
        study.compares = "compaction";
        study.scenes = {"tiny"};
        study.axes = axes;
        study.spp = 2;
        return {.name = "tiny_suite", .description = "", .repetitions = repetitions, .studies = {study}};
    }
    RunOptions options() const {
        // Nothing is abandoned, however slow this machine is: the process would end.
        // And this machine may be busy: each run has the same samples.
        return {.out = out, .command_line = "the test", .retakes = 0, .grace = std::chrono::hours(24)};
    }
    // Runs with what it prints kept in `printed`.
    int run(const Suite& what, const RunOptions& how) {
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        int code = -1;
        std::exception_ptr failure;
        try {
            code = run_suite(what, how);
        } catch (...) {
            failure = std::current_exception();
        }
        printed = testing::internal::GetCapturedStdout();
        progress = testing::internal::GetCapturedStderr();
        if (failure) {
            std::rethrow_exception(failure);
        }
        return code;
    }
    Json result() const { return Json::parse(test::content_of(out)); }

    std::string printed, progress;
};

// Without what is said of a clock beside those of all other samples.
std::map<std::string, std::vector<Json>> sample_rows(const Json& result) {
    std::map<std::string, std::vector<Json>> rows;
    for (Json row : result.at("benchmarks")) {
        if (row.at("run_type") == "iteration" && !row.contains("error_occurred")) {
            row.erase("pt_low_clock");
            rows[row.at("run_name")].push_back(row);
        }
    }
    return rows;
}

std::map<std::string, std::string> statuses(const Json& result) {
    std::map<std::string, std::string> found;
    for (const Json& cell : result.at("ptbench").at("cells")) {
        const std::string reason = cell.at("reason");
        found[cell.at("axes").at("compaction")] =
            cell.at("status").get<std::string>() + (reason.empty() ? "" : ": " + reason);
    }
    return found;
}

const AxisChoices three_compactions{{"compaction", {"none", "thrust_remove_if", "test_hooked"}}};

TEST_F(RunnerTest, ACompletedRunHasEveryRow) {
    EXPECT_EQ(run(suite({{"compaction", {"none", "thrust_partition"}},
                         {"first_bounce", {"off", "cached"}},
                         {"integrator", {"wavefront", "depth_first"}},
                         {"direct_light", {"off", "final_bounce"}}}),
                  options()),
              exit_good);
    EXPECT_EQ(folder.content(),
              (std::vector<std::string>{"out", "out/result.json", "scenes", "scenes/suites", "scenes/tiny.json"}));
    const Json file = result();
    // wavefront with 2 compactions, depth_first; each with and without the final bounce; the cache does not apply.
    const std::size_t cells = 6;
    ASSERT_EQ(file.at("ptbench").at("cells").size(), cells);
    EXPECT_EQ(file.at("ptbench").at("not_applicable").size(), 16 - cells);
    EXPECT_EQ(file.at("benchmarks").size(), cells * (repetitions + 4));
    EXPECT_EQ(file.at("context").at("ptbench.status"), "completed");
    EXPECT_EQ(file.at("context").at("ptbench.suite"), "tiny_suite");
    EXPECT_EQ(file.at("context").at("ptbench.command_line"), "the test");

    std::set<std::int64_t> orders;
    std::set<std::string> plain_hashes;
    for (const Json& cell : file.at("ptbench").at("cells")) {
        const std::string name = cell.at("cell");
        SCOPED_TRACE(name);
        EXPECT_EQ(cell.at("status"), "ok");
        const bool is_lit = cell.at("axes").at("direct_light") == "final_bounce";
        EXPECT_EQ(cell.at("claim"), is_lit ? "statistical" : "bitwise");
        EXPECT_EQ(cell.at("claim_check").get<std::string>().find("film bits equal to depth_first "), 0u);
        EXPECT_EQ(cell.at("film_hash").get<std::string>().size(), 16u);
        if (!is_lit) {
            plain_hashes.insert(cell.at("film_hash"));
        }
        EXPECT_GT(cell.at("mean_rgb")[0].get<double>(), 0.1);
        EXPECT_EQ(cell.at("nonfinite"), 0);
        EXPECT_EQ(cell.at("negative"), 0);
        EXPECT_EQ(cell.at("unfinished_walks"), 0);
        const Json& pass = cell.at("instrumented");
        EXPECT_EQ(pass.at("paths"), 8 * 6 * 2);
        EXPECT_EQ(pass.at("spp"), 2);
        EXPECT_EQ(pass.at("live_paths")[0], 8 * 6 * 2);
        EXPECT_GE(pass.at("live_paths").size(), 3u);
        EXPECT_EQ(cell.at("tunables"), Json({{"room", 1}}));
        const Json& counters = cell.at("counters");
        EXPECT_EQ(counters.at("compactions") == 0, cell.at("axes").at("compaction") == "none");
        EXPECT_EQ(counters.at("cache_fills"), 0);
        for (const char* on_cuda : {"launches", "graph_nodes", "loop_rounds", "host_waits"}) {
            EXPECT_EQ(counters.at(on_cuda), 0);
        }
        EXPECT_FALSE(cell.contains("cuda"));
        EXPECT_FALSE(pass.at("stage_ms").empty());

        const std::vector<Json> rows = sample_rows(file)[name];
        ASSERT_EQ(rows.size(), static_cast<std::size_t>(repetitions));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            EXPECT_EQ(rows[i].at("repetition_index"), i);
            EXPECT_EQ(rows[i].at("pt_seed"), i + 1);
            EXPECT_EQ(rows[i].at("pt_spp"), 2);
            EXPECT_EQ(rows[i].at("pt_paths"), 8 * 6 * 2);
            EXPECT_EQ(rows[i].at("real_time"), rows[i].at("pt_wall_ms"));
            EXPECT_GT(rows[i].at("real_time").get<double>(), 0);
            EXPECT_GE(rows[i].at("pt_end_to_end_ms").get<double>(), rows[i].at("pt_wall_ms").get<double>());
            const bool has_clock = rows[i].at("pt_clock_unknown") == 0;  // on a busy machine it may be unknown
            for (const char* key : {"pt_clock_mhz_before", "pt_clock_mhz_after"}) {
                ASSERT_EQ(rows[i].contains(key), has_clock);
                EXPECT_GT(rows[i].value(key, 1.0), 0);
            }
            EXPECT_GT(rows[i].at("pt_timestamp").get<double>(), 1.5e9);
            orders.insert(rows[i].at("pt_order").get<std::int64_t>());
        }
    }
    EXPECT_EQ(plain_hashes.size(), 1u);
    EXPECT_EQ(orders.size(), cells * repetitions);  // 0, 1, 2, ...: each once
    EXPECT_EQ(*orders.rbegin(), static_cast<std::int64_t>(cells * repetitions - 1));
    EXPECT_NE(printed.find("6 cells, 18 samples, 0 failed, 10 not applicable\n"), std::string::npos) << printed;
    EXPECT_NE(progress.find("[6/6] verify: "), std::string::npos) << progress;
    EXPECT_NE(progress.find("[18/18] time: "), std::string::npos) << progress;
}

TEST_F(RunnerTest, TheSeedAndTheRepetitionsCanBeChosen) {
    RunOptions how = options();
    how.seed = 100;
    how.repetitions = 2;
    EXPECT_EQ(run(suite({}), how), exit_good);
    const std::vector<Json> rows = sample_rows(result()).begin()->second;
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].at("pt_seed"), 100);
    EXPECT_EQ(rows[1].at("pt_seed"), 101);
}

TEST_F(RunnerTest, EveryValueOfATunableIsACellOfItsOwn) {
    Suite tuned = suite({{"first_bounce", {"off", "cached_jitters"}}});
    tuned.studies[0].tunables = {{"jitters", {1, 16}}};
    EXPECT_EQ(run(tuned, options()), exit_good);
    const Json file = result();
    ASSERT_EQ(file.at("ptbench").at("cells").size(), 3u);
    ASSERT_EQ(file.at("ptbench").at("not_applicable").size(), 1u);
    EXPECT_EQ(file.at("ptbench").at("not_applicable")[0].at("reason"), "jitters=1 tunes none of the variant's choices");
    std::map<std::string, Json> cells;
    for (const Json& cell : file.at("ptbench").at("cells")) {
        EXPECT_EQ(cell.at("status"), "ok") << cell.at("reason");
        cells[cell.at("axes").at("first_bounce").get<std::string>() + cell.at("tunables").dump()] = cell;
        EXPECT_EQ(sample_rows(file)[cell.at("cell")].size(), static_cast<std::size_t>(repetitions));
    }
    const Json& off = cells.at("off{\"room\":1}");
    const Json& one = cells.at("cached_jitters{\"jitters\":1,\"room\":1}");
    const Json& many = cells.at("cached_jitters{\"jitters\":16,\"room\":1}");
    EXPECT_EQ(off.at("claim"), "bitwise");
    EXPECT_EQ(one.at("claim"), "biased");
    EXPECT_EQ(one.at("claim_check"),
              "film bits equal to "
              "depth_first first_bounce=cached_jitters specialisation=generic jitters=1");
    // Two samples: 16 rays are the rays of no cache, one ray is another image.
    EXPECT_EQ(many.at("film_hash"), off.at("film_hash"));
    EXPECT_NE(one.at("film_hash"), off.at("film_hash"));
    EXPECT_EQ(one.at("counters").at("cache_fills"), 8 * 6);
    EXPECT_EQ(one.at("counters").at("cache_hits"), 8 * 6);
    EXPECT_EQ(many.at("counters").at("cache_fills"), 8 * 6 * 2);
    EXPECT_EQ(many.at("counters").at("cache_hits"), 0);
}

TEST_F(RunnerTest, SeveralResolutionsAreSoManyCells) {
    Suite sized = suite({});
    sized.studies[0].width = sized.studies[0].height = 5;
    sized.studies[0].more_sizes = {{7, 4}, {60, 3}};
    EXPECT_EQ(run(sized, options()), exit_good);
    std::set<std::string> resolutions;
    const Json file = result();
    for (const Json& cell : file.at("ptbench").at("cells")) {
        EXPECT_EQ(cell.at("status"), "ok") << cell.at("reason");
        resolutions.insert(cell.at("resolution").dump());
        const std::uint64_t pixels =
            cell.at("resolution")[0].get<std::uint64_t>() * cell.at("resolution")[1].get<std::uint64_t>();
        EXPECT_EQ(cell.at("instrumented").at("paths"), pixels * 2);
    }
    EXPECT_EQ(resolutions, (std::set<std::string>{"[5,5]", "[7,4]", "[60,3]"}));
    EXPECT_EQ(sample_rows(file).size(), 3u);
}

TEST_F(RunnerTest, RandomInterleavingMixesTheCells) {
    RunOptions how = options();
    how.repetitions = 20;
    EXPECT_EQ(run(suite({{"layout", {"aos", "soa"}}}), how), exit_good);
    std::map<std::int64_t, std::string> by_order;
    for (const auto& [name, rows] : sample_rows(result())) {
        for (const Json& row : rows) {
            by_order[row.at("pt_order").get<std::int64_t>()] = name;
        }
    }
    int changes = 0;
    for (auto position = std::next(by_order.begin()); position != by_order.end(); ++position) {
        changes += position->second != std::prev(position)->second ? 1 : 0;
    }
    EXPECT_GT(changes, 1);  // one would be all of one cell, then all of the other: 1 in 7e10
}

// ---- Failures ----

TEST_F(RunnerTest, AChoiceThatFailsItsClaimLeavesTheOthersAlone) {
    on_compact = [](PathQueue& queue) { queue.count -= queue.count > 0 ? 1 : 0; };
    EXPECT_EQ(run(suite(three_compactions), options()), exit_check_failed);
    const Json file = result();
    std::map<std::string, std::string> found = statuses(file);
    EXPECT_EQ(found["none"], "ok");
    EXPECT_EQ(found["thrust_remove_if"], "ok");
    EXPECT_EQ(found["test_hooked"].find("failed: film differs from "
                                        "depth_first specialisation=generic: "
                                        "first at pixel "),
              0u)
        << found["test_hooked"];
    EXPECT_EQ(sample_rows(file).size(), 2u);
    EXPECT_EQ(file.at("benchmarks").size(), 2 * (repetitions + 4) + 1u);  // and the error row
    EXPECT_EQ(file.at("context").at("ptbench.status"), "completed");
    EXPECT_NE(printed.find("3 cells, 6 samples, 1 failed, 0 not applicable\n"), std::string::npos) << printed;
    EXPECT_FALSE(std::filesystem::exists(journal_file));
}

TEST_F(RunnerTest, EveryCellFailingIsStillAResult) {
    on_compact = [](PathQueue& queue) { queue.count -= queue.count > 0 ? 1 : 0; };
    EXPECT_EQ(run(suite({{"compaction", {"test_hooked"}}}), options()), exit_check_failed);
    EXPECT_EQ(result().at("benchmarks").size(), 1u);
}

// Verified, instrumented and warmed up, it throws in its first sample: Google Benchmark must not abort.
TEST_F(RunnerTest, AChoiceThatFailsLateFailsAloneAndForGood) {
    int renders = 0;
    on_render = [&renders] {
        if (++renders > 4) {
            throw std::runtime_error("out of luck");
        }
    };
    EXPECT_EQ(run(suite(three_compactions), options()), exit_check_failed);
    const Json file = result();
    std::map<std::string, std::string> found = statuses(file);
    EXPECT_EQ(found["none"], "ok");
    EXPECT_EQ(found["thrust_remove_if"], "ok");
    EXPECT_EQ(found["test_hooked"], "failed: sample 0 (seed 1): out of luck");
    EXPECT_EQ(renders, 5);  // not tried again
    for (const auto& [name, rows] : sample_rows(file)) {
        EXPECT_EQ(rows.size(),
                  name.find("test_hooked") != std::string::npos ? 1u : static_cast<std::size_t>(repetitions));
    }
    EXPECT_NE(progress.find("failed: "
                            "wavefront/compaction:test_hooked/scene:tiny/backend:cpu/8x6/depth:3/spp:2: "
                            "sample 0 (seed 1): out of luck\n"),
              std::string::npos);
}

TEST_F(RunnerTest, AChoiceThatThrowsWhileItIsVerifiedFailsAlone) {
    RunOptions how = options();
    how.overwrite = true;
    for (const int renders_before : {0, 1}) {  // in verification, in the instrumented pass
        int renders = 0;
        on_render = [&] {
            if (renders++ == renders_before) {
                throw std::runtime_error("out of luck");
            }
        };
        EXPECT_EQ(run(suite(three_compactions), how), exit_check_failed);
        std::map<std::string, std::string> found = statuses(result());
        EXPECT_EQ(found["none"], "ok");
        EXPECT_EQ(found["thrust_remove_if"], "ok");
        EXPECT_EQ(found["test_hooked"], "failed: a render before the timed ones: out of luck");
        EXPECT_EQ(result().at("benchmarks").size(), 2u * (repetitions + 4) + 1u);
    }
}

// Verification is done at small size; a film that is wrong only at full size is found when it is timed.
TEST_F(RunnerTest, AFilmThatIsWrongAtFullSizeOnlyIsFound) {
    on_compact = [](PathQueue& queue) {
        const auto pixel_in = [&](std::size_t slot) {
            return std::visit([&](const auto& paths) { return paths.pixel(slot); }, queue.paths);
        };
        queue.count -= queue.count > 0 && pixel_in(queue.count - 1) >= 48 * 48 ? 1 : 0;
    };
    Suite large = suite(three_compactions);
    large.studies[0].width = large.studies[0].height = 64;
    EXPECT_EQ(run(large, options()), exit_check_failed);
    // The variant with the wrong film is blamed, whatever the order: the reference variant sets the film.
    for (const auto& [compaction, status] : statuses(result())) {
        if (compaction == "test_hooked") {
            EXPECT_EQ(status.find("failed: at full size, 2 spp, seed 1: film "), 0u) << status;
        } else {
            EXPECT_EQ(status, "ok") << compaction;
        }
    }
}

// It is the first to take the sample, and it was right until then.
TEST_F(RunnerTest, AFilmThatIsWrongInATimedSampleOnlyFailsItsCellAlone) {
    int renders = 0;
    on_render = [&] { ++renders; };
    on_compact = [&](PathQueue& queue) {
        std::visit(
            [&](auto& paths) {
                if (renders == 6 && queue.count > 0) {  // verification, two to prepare, the warm-up, a sample
                    Path<float> path = paths.load(0);
                    path.throughput *= 1.0001f;
                    paths.store(0, path);
                }
            },
            queue.paths);
    };
    RunOptions how = options();
    how.benchmark_flags = {"--benchmark_enable_random_interleaving=false"};
    EXPECT_EQ(run(suite({{"compaction", {"test_hooked", "none", "thrust_remove_if"}}}), how), exit_check_failed);
    std::map<std::string, std::string> found = statuses(result());
    EXPECT_EQ(found["none"], "ok");
    EXPECT_EQ(found["thrust_remove_if"], "ok");
    EXPECT_EQ(found["test_hooked"].find("failed: sample 1 (seed 2): film "), 0u) << found["test_hooked"];
    EXPECT_NE(found["test_hooked"].find(" of depth_first specialisation=generic"), std::string::npos);
    EXPECT_NE(printed.find("FAILED    wavefront compaction=test_hooked\n"), std::string::npos) << printed;
}

// ---- Interrupts and resuming ----

// Keeps what the journal held at every render of the hooked choice; the last is the fullest.
std::function<void()> keep_journal(const std::string& file, std::string& kept) {
    return [file, &kept] { kept = test::content_of(file); };
}

TEST_F(RunnerTest, ResumeKeepsTheSamplesThatWereTaken) {
    std::string kept;
    on_render = keep_journal(journal_file, kept);
    RunOptions how = options();
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    const auto complete = sample_rows(result());
    on_render = nullptr;
    how.resume = true;
    std::vector<std::size_t> ends;  // of the journal's lines
    for (std::size_t end = kept.find('\n'); end != std::string::npos; end = kept.find('\n', end + 1)) {
        ends.push_back(end + 1);
    }
    // The run, its session, the cells and, whatever the order of the samples, one of the hooked choice before its last
    // render.
    ASSERT_GE(ends.size(), 2u + 3u + 1u);

    for (std::size_t lines = 0; lines <= ends.size(); ++lines) {
        SCOPED_TRACE(lines);
        // The journal is as a kill leaves it: whole lines, and half of the next.
        const std::size_t size = lines == 0 ? 0 : ends[lines - 1];
        test::write_text(journal_file, kept.substr(0, size + (lines < ends.size() ? (ends[lines] - size) / 2 : 0)));
        ASSERT_EQ(run(suite(three_compactions), how), exit_good);
        EXPECT_FALSE(std::filesystem::exists(journal_file));
        const Json file = result();
        const auto resumed = sample_rows(file);
        EXPECT_EQ(file.at("benchmarks").size(), 3u * (repetitions + 4));
        EXPECT_EQ(file.at("context").at("ptbench.status"), "completed");

        std::size_t unchanged = 0;
        std::set<std::int64_t> orders;
        for (const auto& [name, rows] : resumed) {
            ASSERT_EQ(rows.size(), static_cast<std::size_t>(repetitions));
            for (std::size_t i = 0; i < rows.size(); ++i) {
                EXPECT_EQ(rows[i].at("pt_seed"), i + 1);
                EXPECT_EQ(rows[i].at("repetition_index"), i);
                unchanged += rows[i] == complete.at(name)[i] ? 1u : 0u;  // the timestamp too
                orders.insert(rows[i].at("pt_order").get<std::int64_t>());
            }
        }
        EXPECT_EQ(unchanged, lines > 5 ? lines - 5 : 0);
        EXPECT_EQ(orders.size(), 3u * repetitions);
    }
}

TEST_F(RunnerTest, AnInterruptEndsTheRunWithAResultAndAJournal) {
    // In verification, before and in the instrumented pass, in the warm-up, in the second sample.
    for (const int renders_before : {0, 1, 2, 3, 5}) {
        SCOPED_TRACE(renders_before);
        std::filesystem::remove(out);
        int renders = 0;
        on_render = [&] {
            if (renders++ == renders_before) {
                std::raise(SIGINT);
            }
        };
        RunOptions how = options();
        ASSERT_EQ(run(suite(three_compactions), how), exit_interrupted);
        EXPECT_TRUE(std::filesystem::exists(journal_file));
        EXPECT_TRUE(printed.ends_with("\ngo on with: the test --resume\n")) << printed;
        if (renders_before < 3) {  // nothing was measured: an older result of this name would not be replaced by it
            EXPECT_FALSE(std::filesystem::exists(out));
            EXPECT_NE(printed.find("interrupted before the first sample"), std::string::npos) << printed;
            on_render = nullptr;
            how.resume = true;
            ASSERT_EQ(run(suite(three_compactions), how), exit_good);
            continue;
        }
        const Json cut = result();
        EXPECT_EQ(cut.at("context").at("ptbench.status"), "interrupted");
        std::size_t unfinished = 0;  // other cells may be complete: chance mixes the samples of all
        for (const auto& [compaction, status] : statuses(cut)) {
            EXPECT_TRUE(status == "ok" || status.find("interrupted: the run ended before this cell ") == 0) << status;
            unfinished += status == "ok" ? 0u : 1u;
        }
        EXPECT_GE(unfinished, 1u);
        EXPECT_NE(printed.find("; interrupted with " + counted(unfinished, "cell") + " unfinished\n"),
                  std::string::npos)
            << printed;

        EXPECT_THROW(run(suite(three_compactions), how), InputError);  // unfinished, and not resumed
        on_render = nullptr;
        how.resume = true;
        ASSERT_EQ(run(suite(three_compactions), how), exit_good);
        EXPECT_EQ(result().at("benchmarks").size(), 3u * (repetitions + 4));
        EXPECT_FALSE(std::filesystem::exists(journal_file));
        for (const auto& [name, rows] : sample_rows(cut)) {
            for (std::size_t i = 0; i < rows.size(); ++i) {
                EXPECT_EQ(rows[i], sample_rows(result()).at(name)[i]);
            }
        }
    }
}

TEST_F(RunnerTest, AnotherRunsJournalIsRefused) {
    on_render = [raised = false]() mutable {
        if (!std::exchange(raised, true)) {
            std::raise(SIGINT);
        }
    };
    RunOptions how = options();
    ASSERT_EQ(run(suite(three_compactions), how), exit_interrupted);
    on_render = nullptr;
    how.resume = true;
    const std::string journal = test::content_of(journal_file);
    const auto refusal = [&](const Suite& other, const RunOptions& other_options) -> std::string {
        try {
            run(other, other_options);
        } catch (const InputError& error) {
            EXPECT_EQ(test::content_of(journal_file), journal);
            return error.what();
        }
        return "";
    };
    const auto message = [&](const std::string& differs) {
        return journal_file + ": line 1: found another run (" + differs +
               "), allowed: the run that it was started with; " + "remove the file to start over";
    };
    const std::string other_cells = refusal(suite({}), how);
    EXPECT_EQ(other_cells.find(journal_file + ": line 1: found another run (cells: 3 of them, here 1; number 2 is \""),
              0u)
        << other_cells;
    RunOptions other_seed = how;
    other_seed.seed = 2;
    EXPECT_EQ(refusal(suite(three_compactions), other_seed), message("seed: 1, here 2"));
    RunOptions other_repetitions = how;
    other_repetitions.repetitions = repetitions - 1;
    EXPECT_EQ(refusal(suite(three_compactions), other_repetitions), message("repetitions: 3, here 2"));
    // Another build, OpenMP with other settings.
    ::setenv("OMP_DISPLAY_ENV", "FALSE", 1);
    EXPECT_EQ(refusal(suite(three_compactions), how).find("found another run (machine ptbench.openmp_environment: \""),
              journal_file.size() + std::string(": line 1: ").size());
    ::unsetenv("OMP_DISPLAY_ENV");
    // A scene of the same name that was edited in between.
    std::string text = scene_text;
    text.replace(text.find("0.5, 0.5, 0.5"), 13, "0.5, 0.5, 0.6");
    test::write_text(folder.file("scenes/tiny.json"), text);
    EXPECT_NE(refusal(suite(three_compactions), how).find("found another run (scenes tiny: \""), std::string::npos);
}

// A journal of another machine: what ours says, but for one value.
TEST_F(RunnerTest, AnotherMachinesJournalIsRefused) {
    on_render = [raised = false]() mutable {
        if (!std::exchange(raised, true)) {
            std::raise(SIGINT);
        }
    };
    RunOptions how = options();
    ASSERT_EQ(run(suite(three_compactions), how), exit_interrupted);
    on_render = nullptr;
    how.resume = true;
    const std::string journal = test::content_of(journal_file);
    const Json identity = Json::parse(journal.substr(0, journal.find('\n'))).at("identity");
    const auto refusal_of = [&](const Json::json_pointer& place, bool other_host) -> std::string {
        Json other = identity;
        other[place] = "another";
        test::write_text(journal_file, test::sealed_lines(Json{{"type", "run"}, {"identity", other}}.dump() + "\n"));
        RunOptions so = how;
        so.other_host = other_host;
        try {
            run(suite(three_compactions), so);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const auto found = [&](const std::string& key) {
        return journal_file + ": line 1: found another run (" + key + ": \"another\", here ";
    };
    for (const std::string key : {"ptbench.cpu_model", "ptbench.program_hash", "ptbench.git_sha", "ptbench.os"}) {
        EXPECT_EQ(refusal_of(Json::json_pointer("/machine/" + key), true).find(found("machine " + key)), 0u) << key;
    }
    EXPECT_EQ(refusal_of(Json::json_pointer("/host_name"), false).find(found("host_name")), 0u);
    EXPECT_EQ(refusal_of(Json::json_pointer("/host_name"), true), "");
    EXPECT_EQ(result().at("context").at("ptbench.status"), "completed");
}

TEST_F(RunnerTest, ACompletedRunIsNotMeasuredAgainByResume) {
    RunOptions how = options();
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    const std::string before = test::content_of(out);
    how.resume = true;
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_EQ(printed, out + "\nnothing left to do: this run is complete\n");
    EXPECT_EQ(test::content_of(out), before);
    how.seed = 2;  // another run, whose result has no place here
    EXPECT_THROW(run(suite(three_compactions), how), InputError);
    EXPECT_EQ(test::content_of(out), before);
    how.overwrite = true;
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_NE(test::content_of(out), before);
}

TEST_F(RunnerTest, OverwriteDoesNotTakeARunningRunsJournal) {
    std::filesystem::create_directories(folder.path() / "out");
    RunOptions how = options();
    how.overwrite = true;
    {
        const Journal another(journal_file, {{"cells", 1}}, false);
        const std::string before = test::content_of(journal_file);
        EXPECT_THROW(run(suite({}), how), MachineError);
        EXPECT_EQ(test::content_of(journal_file), before);
        EXPECT_FALSE(std::filesystem::exists(journal_file + ".1"));
    }
    EXPECT_EQ(run(suite({}), how), exit_good);  // it has ended, and left its journal
    EXPECT_TRUE(std::filesystem::exists(journal_file + ".1"));
}

// ---- Earlier results ----

TEST_F(RunnerTest, AResultThatIsThereIsRefusedAndNamed) {
    ASSERT_EQ(run(suite({}), options()), exit_good);
    const std::string before = test::content_of(out);
    const auto refused = [&] {
        try {
            run(suite({}), options());
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string date = result().at("context").at("date");
    const std::string allowed =
        ", allowed: --overwrite, which replaces it when the new one is complete, or another --out";
    EXPECT_EQ(refused(), out + ": result file: found a complete result of " + date + allowed);
    EXPECT_EQ(test::content_of(out), before);
    test::write_text(out, "notes of mine");
    EXPECT_EQ(refused(), out + ": result file: found a file that is no result of ptbench" + allowed);
    EXPECT_EQ(test::content_of(out), "notes of mine");
    EXPECT_FALSE(std::filesystem::exists(journal_file));
}

// Ctrl-C over a complete result once left 9 of its 90 samples.
TEST_F(RunnerTest, AnEarlierResultStaysUntilTheNewOneIsComplete) {
    ASSERT_EQ(run(suite(three_compactions), options()), exit_good);
    const std::string before = test::content_of(out);
    RunOptions how = options();
    how.overwrite = true;
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {  // verification, two to prepare, the warm-up, and the second sample
            std::raise(SIGINT);
        }
    };
    ASSERT_EQ(run(suite(three_compactions), how), exit_interrupted);
    on_render = nullptr;
    EXPECT_EQ(test::content_of(out), before);
    EXPECT_NE(printed.find(out + " stays as it was, " + journal_file + " holds "), std::string::npos) << printed;
    how.resume = true;
    how.overwrite = false;  // the journal is of this very run, and so is the result: nothing of another's is lost
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_NE(test::content_of(out), before);
    EXPECT_EQ(sample_rows(result()).size(), 3u);
    EXPECT_FALSE(std::filesystem::exists(journal_file));
}

TEST_F(RunnerTest, GoingOnDoesNotOverwriteAnothersResultUnasked) {
    RunOptions how = options();
    how.overwrite = true;
    how.seed = 7;
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    const std::string others = test::content_of(out);
    how.seed = 1;
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {  // verification, two to prepare, the warm-up, and the second sample
            std::raise(SIGINT);
        }
    };
    ASSERT_EQ(run(suite(three_compactions), how), exit_interrupted);
    on_render = nullptr;
    how.resume = true;
    how.overwrite = false;
    EXPECT_THROW(run(suite(three_compactions), how), InputError);
    EXPECT_EQ(test::content_of(out), others);
    how.overwrite = true;  // as the line says that the interrupted call printed
    ASSERT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_NE(test::content_of(out), others);
}

// Another command may write the result's file meanwhile, as `ptbench merge` to the same name does.
TEST_F(RunnerTest, WhatAnotherCommandWroteMeanwhileStays) {
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {
            test::write_text(out, "another command's");
        }
    };
    EXPECT_THROW(run(suite(three_compactions), options()), MachineError);
    on_render = nullptr;
    EXPECT_EQ(test::content_of(out), "another command's");
    RunOptions how = options();
    how.resume = true;
    how.overwrite = true;
    EXPECT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_EQ(sample_rows(result()).size(), 3u);
}

TEST_F(RunnerTest, AJournalWithASampleLostOrTwiceIsRefused) {
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {  // the second sample of three
            std::raise(SIGINT);
        }
    };
    ASSERT_EQ(run(suite({{"compaction", {"test_hooked"}}}), options()), exit_interrupted);
    on_render = nullptr;
    const std::string journal = test::content_of(journal_file);
    std::vector<std::string> lines;
    std::istringstream stream(journal);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line + "\n");
    }
    std::vector<std::size_t> samples;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (lines[i].find("\"type\":\"sample\"") != std::string::npos) {
            samples.push_back(i);
        }
    }
    ASSERT_GE(samples.size(), 2u);
    RunOptions how = options();
    how.resume = true;
    for (const bool is_lost : {true, false}) {
        std::string changed;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            changed += is_lost && i == samples[0] ? "" : lines[i];
            changed += !is_lost && i == samples[0] ? lines[i] : "";
        }
        changed = test::sealed_lines(changed);
        test::write_text(journal_file, changed);
        EXPECT_THROW(run(suite({{"compaction", {"test_hooked"}}}), how), InputError);
        EXPECT_EQ(test::content_of(journal_file), changed);
    }
    test::write_text(journal_file, journal);
    EXPECT_EQ(run(suite({{"compaction", {"test_hooked"}}}), how), exit_good);
}

// A run that goes on from a journal which says what no run found (with checksums, so that it is read) ends with a
// result that contradicts itself: the journal stays.
TEST_F(RunnerTest, AJournalStaysUntilTheResultDoesNotContradictItself) {
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {  // the second sample of three
            std::raise(SIGINT);
        }
    };
    const Suite what = suite({{"compaction", {"test_hooked"}}});
    ASSERT_EQ(run(what, options()), exit_interrupted);
    on_render = nullptr;
    const std::string journal = test::content_of(journal_file);
    const std::string key = R"("sample":{"cpu_ms")";
    const std::size_t hash = journal.find(R"("film_hash":")", journal.find(key)) + 13;
    RunOptions how = options();
    how.resume = true;
    std::string changed = journal;
    changed.replace(hash, 16, "0123456789abcdef");
    test::write_text(journal_file, changed);
    EXPECT_THROW(run(what, how), InputError);  // the line has another checksum
    EXPECT_EQ(test::content_of(journal_file), changed);

    test::write_text(journal_file, test::sealed_lines(changed));
    EXPECT_EQ(run(what, how), exit_check_failed);
    EXPECT_NE(printed.find("no good result: " + out + ": "), std::string::npos) << printed;
    EXPECT_NE(printed.find(": found sample 0 with the film \"0123456789abcdef\", allowed: "), std::string::npos)
        << printed;
    EXPECT_TRUE(printed.ends_with("\n" + journal_file + " stays\n")) << printed;
    EXPECT_TRUE(test::content_of(journal_file).starts_with(test::sealed_lines(changed)));

    std::filesystem::remove(out);
    test::write_text(journal_file, journal);
    EXPECT_EQ(run(what, how), exit_good);
    EXPECT_FALSE(std::filesystem::exists(journal_file));
}

TEST_F(RunnerTest, ALineThatAKillCutOffIsDroppedAndThatIsSaid) {
    on_render = [raised = 0]() mutable {
        if (++raised == 6) {
            std::raise(SIGINT);
        }
    };
    const Suite what = suite({{"compaction", {"test_hooked"}}});
    ASSERT_EQ(run(what, options()), exit_interrupted);
    on_render = nullptr;
    const std::string journal = test::content_of(journal_file);
    const std::size_t last = journal.rfind('\n', journal.size() - 2) + 1;
    test::write_text(journal_file, journal.substr(0, last + 40));
    RunOptions how = options();
    how.resume = true;
    EXPECT_EQ(run(what, how), exit_good);
    EXPECT_EQ(
        progress.find(journal_file + ": its last line was cut off after 40 bytes and is dropped; the run goes on from "
                                     "the lines before it\n"),
        0u)
        << progress;
}

// A journal whose sample 0 other processes disturbed, as far as it says.
class RetakeTest : public RunnerTest {
protected:
    const Suite what = suite({{"compaction", {"test_hooked"}}});
    static constexpr double foreign = 1e6;

    std::string disturbed_journal() {
        int renders = 0;
        on_render = [&] {
            if (++renders == 6) {  // the second sample of three
                std::raise(SIGINT);
            }
        };
        EXPECT_EQ(run(what, options()), exit_interrupted);
        on_render = nullptr;
        std::filesystem::remove(out);
        std::string changed, text = test::content_of(journal_file);
        std::istringstream stream(text);
        bool is_first = true;
        for (std::string line; std::getline(stream, line);) {
            Json fact = Json::parse(line);
            fact.erase("check");
            if (fact.at("type") == "sample" && std::exchange(is_first, false)) {
                fact["sample"]["pt_foreign_cpu_ms"] = foreign;
            }
            changed += fact.dump() + "\n";
        }
        return test::sealed_lines(changed);
    }
    RunOptions going_on(int retakes) const {
        RunOptions how = options();
        how.resume = true;
        how.retakes = retakes;
        return how;
    }
};

TEST_F(RetakeTest, ADisturbedSampleIsTakenAgainWithItsSeedAndStaysInTheFile) {
    test::write_text(journal_file, disturbed_journal());
    EXPECT_EQ(run(what, going_on(1)), exit_good) << printed;
    const Json file = result();
    const Json& retakes = file.at("ptbench").at("retakes");
    EXPECT_EQ(retakes.at("most_per_cell"), 1);
    ASSERT_EQ(retakes.at("samples").size(), 1u);  // the limit, whatever else was disturbed
    const Json& before = retakes.at("samples")[0];
    EXPECT_EQ(before.at("repetition_index"), 0);
    EXPECT_EQ(before.at("sample").at("pt_foreign_cpu_ms"), foreign);
    const std::vector<Json> rows = sample_rows(file).begin()->second;
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(repetitions));
    EXPECT_EQ(before.at("cell"), rows[0].at("run_name"));
    EXPECT_LT(rows[0].at("pt_foreign_cpu_ms"), foreign);
    for (const char* same : {"pt_seed", "film_hash", "pt_rays"}) {
        EXPECT_EQ(rows[0].at(same), before.at("sample").at(same)) << same;
    }
    EXPECT_EQ(rows[0].at("pt_order"), repetitions);                              // after all others
    EXPECT_EQ(file.at("ptbench").at("run").at("sessions")[1].at("samples"), 2);  // the third, and the first again
    EXPECT_NE(printed.find("\nretaken: 1 disturbed sample, at most 1 a cell"), std::string::npos) << printed;
}

TEST_F(RetakeTest, WithoutRetakesItStaysWhereItIsAndThatIsSaid) {
    test::write_text(journal_file, disturbed_journal());
    EXPECT_EQ(run(what, going_on(0)), exit_good) << printed;
    const Json file = result();
    EXPECT_EQ(file.at("ptbench").at("retakes"), Json({{"most_per_cell", 0}, {"samples", Json::array()}}));
    EXPECT_EQ(sample_rows(file).begin()->second[0].at("pt_foreign_cpu_ms"), foreign);
    EXPECT_NE(printed.find("\nretaken: 0 disturbed samples, at most 0 a cell; 1 cell came to that limit with disturbed "
                           "samples left\n"),
              std::string::npos)
        << printed;
}

TEST_F(RetakeTest, ARunThatWasKilledBeforeARetakeGoesOnWithItAndHoldsItsFilm) {
    test::write_text(journal_file, disturbed_journal());
    std::string kept;  // what a kill in the last render leaves
    on_render = keep_journal(journal_file, kept);
    EXPECT_EQ(run(what, going_on(1)), exit_good) << printed;
    std::filesystem::remove(out);

    test::write_text(journal_file, kept);
    on_render = nullptr;
    EXPECT_EQ(run(what, going_on(1)), exit_good) << printed;
    EXPECT_EQ(result().at("ptbench").at("retakes").at("samples").size(), 1u);
    std::filesystem::remove(out);

    test::write_text(journal_file, kept);
    on_compact = [](PathQueue& queue) { queue.count -= queue.count > 0 ? 1 : 0; };
    EXPECT_EQ(run(what, going_on(1)), exit_check_failed) << printed;
    const std::string status = statuses(result()).at("test_hooked");
    EXPECT_EQ(status.find("failed: sample 0 (seed 1): film "), 0u) << status;
}

TEST_F(RunnerTest, ADeviceIsNoPlaceForAResult) {
    RunOptions how = options();
    how.overwrite = true;
    for (const std::string file : {"/dev/full", "/dev/null"}) {
        how.out = file;
        EXPECT_THROW(run(suite({}), how), InputError);
        EXPECT_TRUE(std::filesystem::is_character_file(file));
    }
    how.out = folder.file("pipe");
    ASSERT_EQ(::mkfifo(how.out.c_str(), 0600), 0);
    EXPECT_THROW(run(suite({}), how), InputError);
    EXPECT_TRUE(std::filesystem::is_fifo(how.out));
}

TEST_F(RunnerTest, TheHeadlineCountsDisturbedSamples) {
    ASSERT_EQ(run(suite({}), options()), exit_good);
    int disturbed = 0;
    const Json file = result();
    for (const Json& row : file.at("benchmarks")) {
        disturbed += row.value("pt_contended", 0) == 1 || row.value("pt_low_clock", 0) == 1 ? 1 : 0;
    }
    EXPECT_NE(printed.find("disturbed: " + std::to_string(disturbed) + " of 3 samples"), std::string::npos) << printed;
}

TEST_F(RunnerTest, ACompletedRunWithAFailureSaysSoAgain) {
    on_compact = [](PathQueue& queue) { queue.count -= queue.count > 0 ? 1 : 0; };
    RunOptions how = options();
    how.resume = true;
    EXPECT_EQ(run(suite(three_compactions), how), exit_check_failed);
    EXPECT_EQ(run(suite(three_compactions), how), exit_check_failed);
    EXPECT_EQ(printed, out + "\nnothing left to do: this run is complete\n");
}

TEST_F(RunnerTest, QuietShowsNoProgress) {
    RunOptions how = options();
    how.quiet = true;
    EXPECT_EQ(run(suite({}), how), exit_good);
    EXPECT_EQ(progress, "");
}

// ---- A sample that does not end: run in a process of its own, by the tests after it ----

class RunThatHangsTest : public RunnerTest {
protected:
    // Interrupted so often in the sample that begins after so many renders, and that never ends.
    void run_and_hang(int signals) {
        out = std::getenv("PTBENCH_TEST_OUT");
        int renders = 0;
        on_render = [&renders, signals] {
            if (renders++ == 6) {
                for (int i = 0; i < signals; ++i) {
                    std::raise(SIGINT);
                }
                while (true) {
                    ::pause();
                }
            }
        };
        RunOptions how = options();
        how.grace = signals == 1 ? std::chrono::milliseconds(10) : std::chrono::hours(24);
        run_suite(suite({{"compaction", {"test_hooked"}}}), how);
    }
    // In another process; its exit code and what it printed.
    test::CommandResult in_a_process(const std::string& test) const {
        test::RunningCommand process({"/proc/self/exe", "--gtest_also_run_disabled_tests", "--gtest_filter=*" + test},
                                     {.environment = {{"PTBENCH_TEST_OUT", out}}});
        EXPECT_TRUE(test::wait_until([&] { return !process.is_running(); })) << test << " goes on and on";
        process.signal(SIGKILL);
        return process.wait();
    }
};

TEST_F(RunThatHangsTest, DISABLED_InterruptedOnce) { run_and_hang(1); }
TEST_F(RunThatHangsTest, DISABLED_InterruptedTwice) { run_and_hang(2); }

TEST_F(RunThatHangsTest, TheSampleInFlightIsAbandoned) {
    const test::CommandResult ended = in_a_process("DISABLED_InterruptedOnce");
    EXPECT_EQ(ended.exit_code, exit_interrupted) << ended.err;
    EXPECT_NE(ended.out.find("; interrupted with 1 cell unfinished\ngo on with: the test --resume\n"),
              std::string::npos)
        << ended.out;
    const Json cut = result();
    EXPECT_EQ(cut.at("context").at("ptbench.status"), "interrupted");
    const auto rows = sample_rows(cut).begin()->second;
    EXPECT_EQ(rows.size(), 2u);  // verification, two renders to prepare, a warm-up, two samples, and the third hangs
    EXPECT_TRUE(std::filesystem::exists(journal_file));
}

TEST_F(RunThatHangsTest, ASecondInterruptKills) {
    EXPECT_EQ(in_a_process("DISABLED_InterruptedTwice").exit_code, 128 + SIGINT);
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_TRUE(std::filesystem::exists(journal_file));
}

// ---- Full disks ----

// The limit on the size of a file stands for a full disk: the journal fits, the result, which says more, does not.
TEST_F(RunnerTest, AResultThatDoesNotFitIsMadeWhenThereIsRoom) {
    std::uintmax_t journal_size = 0;
    on_render = [&] {
        journal_size = std::filesystem::exists(journal_file) ? std::filesystem::file_size(journal_file) : 0;
    };
    ASSERT_EQ(run(suite(three_compactions), options()), exit_good);
    const std::uintmax_t result_size = std::filesystem::file_size(out);
    const std::uintmax_t limit = result_size - 1000;
    ASSERT_LT(journal_size + 3000, limit);  // a sample's line is less than 1000 bytes
    test::write_text(out, "an older one");
    on_render = nullptr;
    RunOptions how = options();
    how.overwrite = true;
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit unlimited{};
    ::getrlimit(RLIMIT_FSIZE, &unlimited);
    rlimit limited = unlimited;
    limited.rlim_cur = limit;
    ::setrlimit(RLIMIT_FSIZE, &limited);
    std::string message;
    try {
        run(suite(three_compactions), how);
    } catch (const MachineError& error) {
        message = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    std::signal(SIGXFSZ, SIG_DFL);
    EXPECT_EQ(message, out + ": cannot be written: File too large");
    EXPECT_EQ(test::content_of(out), "an older one");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.file("out")), {}), 2);  // and the journal
    int renders = 0;
    on_render = [&] { ++renders; };
    how.resume = true;
    EXPECT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_EQ(renders, 0);
    EXPECT_EQ(sample_rows(result()).size(), 3u);
    EXPECT_FALSE(std::filesystem::exists(journal_file));
}

// ---- Filters and plans ----

TEST_F(RunnerTest, AFilterChoosesCells) {
    RunOptions how = options();
    how.filter = "thrust_remove_if|test_hooked";
    how.repetitions = 1;
    EXPECT_EQ(run(suite(three_compactions), how), exit_good);
    EXPECT_EQ(sample_rows(result()).size(), 2u);
    how.filter = "-thrust_remove_if|test_hooked";
    how.overwrite = true;
    EXPECT_EQ(run(suite(three_compactions), how), exit_good);
    ASSERT_EQ(sample_rows(result()).size(), 1u);
    EXPECT_EQ(sample_rows(result()).begin()->first.find("wavefront/"), 0u);
    EXPECT_EQ(result().at("benchmarks").size(), 1 + 4u);
}

TEST_F(RunnerTest, RunsWithoutACellAreRefused) {
    const auto refusal = [&](const Suite& what, const std::string& filter) -> std::string {
        RunOptions how = options();
        how.filter = filter;
        try {
            run(what, how);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(suite(three_compactions), "no_such_cell"), "the run has no cell: the filter matches none");
    EXPECT_EQ(refusal(suite({{"first_bounce", {"cached"}}}), ""),
              "the run has no cell: n/a: first_bounce=cached needs jitter off (camera.jitter is true in the scene)");
    EXPECT_EQ(refusal(suite(three_compactions), "("),
              "--benchmark_filter: argument: found \"(\", allowed: a regular expression");
    EXPECT_FALSE(std::filesystem::exists(folder.file("out")));
}

TEST_F(RunnerTest, DescribesAPlan) {
    const Plan plan = make_plan(suite({{"first_bounce", {"off", "cached"}}}));
    EXPECT_EQ(describe_plan(plan, 5),
              "wavefront/scene:tiny/backend:cpu/8x6/depth:3/spp:2\nn/a: wavefront first_bounce=cached on tiny: "
              "first_bounce=cached needs jitter off (camera.jitter is true in the scene)\n1 cell, 5 samples, 1 not "
              "applicable\n");
}

}  // namespace
}  // namespace pt
