// Whole runs of a tiny study of error against time, in this process: its rows, what is shared, what is refused, what a
// kill loses.
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "harness/bench/convergence_study.h"
#include "harness/bench/error_book.h"
#include "harness/bench/runner.h"
#include "harness/interrupt.h"
#include "tests/support/command.h"
#include "variants/compaction/thrust_compaction.h"

namespace pt {
namespace {

// Works like thrust_remove_if and calls a hook when it is made, once a render.
std::function<void()> on_render;
const Registration hooked({.axis = "compaction",
                           .name = "test_hooked",
                           .summary = "calls back into a test",
                           .origin = "this test",
                           .check_counters = compacted_every_bounce},
                          {.compaction = [] {
                              if (on_render) {
                                  on_render();
                              }
                              return Registry::instance().find("compaction", "thrust_remove_if")->hook.compaction();
                          }});

template <class Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

constexpr const char* scene_text = R"({
  "name": "tiny", "max_depth": 3, "environment": [1, 1, 1],
  "camera": {"eye": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [8, 6]},
  "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
  "objects": [{"shape": "box", "material": "white", "translate": [0, 0, 3], "rotate_degrees": [10, 20, 30]},
              {"shape": "box", "material": "white", "translate": [0, -1, 3], "scale": [9, 0.1, 9]}]
})";

class ConvergenceTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string out = folder.file("out/result.json");
    std::string journal_file = out + ".journal.jsonl";

    void SetUp() override {
        std::filesystem::create_directories(folder.path() / "scenes" / "suites");
        test::write_text(folder.file("scenes/tiny.json"), scene_text);
        std::string still = scene_text;
        still.replace(still.find("tiny"), 4, "still");
        still.replace(still.find("\"resolution\""), 0, "\"jitter\": false, ");
        test::write_text(folder.file("scenes/still.json"), still);
        ::setenv("PTBENCH_HOME", folder.path().c_str(), 1);
    }
    void TearDown() override { ::unsetenv("PTBENCH_HOME"); }

    Suite suite(const std::string& studies) const {
        const std::string file = folder.file("scenes/suites/tiny_suite.json");
        test::write_text(file, R"({"name": "tiny_suite", "repetitions": 8, "studies": [)" + studies + "]}");
        return load_suite(file);
    }
    RunOptions options() const {
        return {.out = out,
                .command_line = "the test",
                .repetitions = 3,
                .retakes = 0,  // this machine may be busy: each run has the same samples
                .reference_cache = folder.file("cache"),
                .grace = std::chrono::hours(24)};
    }
    int run(const Suite& what, const RunOptions& how) {
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        std::exception_ptr failure;
        int code = -1;
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

// Without what is said of a clock beside those of all other samples: a later sample may change it.
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

std::vector<Json> cells_of_study(const Json& result, const std::string& study) {
    std::vector<Json> cells;
    for (const Json& cell : result.at("ptbench").at("cells")) {
        if (std::find(cell.at("studies").begin(), cell.at("studies").end(), study) != cell.at("studies").end()) {
            cells.push_back(cell);
        }
    }
    return cells;
}

const std::string two_integrators = R"({"name": "errors", "type": "convergence", "figure": "convergence",
    "scenes": ["tiny"], "axes": {"integrator": ["wavefront", "depth_first"]}, "spp": 12,
    "reference": {"variance": 1e-3, "most_spp": 65536}, "images": true})";

TEST_F(ConvergenceTest, EveryCheckpointHasItsErrorsAndClocks) {
    ASSERT_EQ(run(suite(two_integrators), options()), exit_good) << progress;
    const Json file = result();
    EXPECT_EQ(file.at("ptbench").at("studies"),
              Json::parse(R"([{"name": "errors", "title": "errors", "compares": "", "along": "", "type": "convergence"},
                              {"name": "errors_without_checkpoints", "title": "errors, without checkpoints",
                               "compares": "", "along": "", "type": "time"}])"));
    const std::vector<Json> cells = cells_of_study(file, "errors");
    ASSERT_EQ(cells.size(), 2u);
    ASSERT_EQ(cells_of_study(file, "errors_without_checkpoints").size(), 2u);
    auto rows = sample_rows(file);
    for (const Json& cell : cells) {
        const std::string name = cell.at("cell");
        SCOPED_TRACE(name);
        EXPECT_TRUE(name.ends_with("/depth:3/spp:12/checkpoints:octaves"));
        EXPECT_EQ(cell.at("status"), "ok");
        const Json& convergence = cell.at("convergence");
        EXPECT_EQ(convergence.at("checkpoints"), (std::vector<int>{1, 2, 4, 8, 12}));
        EXPECT_EQ(convergence.at("independent_samples"), true);
        EXPECT_TRUE(convergence.at("biases").empty());
        EXPECT_EQ(convergence.at("metrics").at("me_rgb"), "mean over pixels of (x-r), by channel");
        const Json& reference = convergence.at("reference");
        EXPECT_EQ(reference.at("name"), "tiny/8x6/depth:3/cpu");
        EXPECT_EQ(reference.at("scene"), "tiny");
        EXPECT_EQ(reference.at("scene_hash"), cell.at("scene_hash"));
        EXPECT_EQ(reference.at("kind"), "rendered");
        EXPECT_LE(reference.at("variance").get<double>(), 1e-3);
        EXPECT_EQ(reference.at("seeds"), (std::vector<std::uint64_t>{reference_seeds[0], reference_seeds[1]}));

        ASSERT_EQ(rows[name].size(), 3u);
        for (const Json& row : rows[name]) {
            const Json& checkpoints = row.at("pt_checkpoints");
            ASSERT_EQ(checkpoints.size(), 5u);
            double wall = 0;
            for (std::size_t i = 0; i < checkpoints.size(); ++i) {
                const Json& c = checkpoints[i];
                EXPECT_EQ(c.at("spp"), convergence.at("checkpoints")[i]);
                EXPECT_GT(c.at("wall_ms").get<double>(), wall);
                wall = c.at("wall_ms");
                EXPECT_EQ(c.at("nonfinite"), 0);
                EXPECT_EQ(c.at("me_rgb").size(), 3u);
                EXPECT_GT(c.at("mse").get<double>(), 0);
                // r is the mean of the halves: mean (x-r)^2 = mean (x-r1)(x-r2) + mean (r1-r2)^2 / 4.
                EXPECT_NEAR(c.at("mse").get<double>(),
                            c.at("mse_dual").get<double>() + reference.at("variance").get<double>(), 1e-12);
                EXPECT_GT(c.at("rel_mse").get<double>(), 0);
                EXPECT_GT(c.at("smape").get<double>(), 0);
                // Half as many samples are no checkpoint of 1 and of 12.
                EXPECT_EQ(c.at("bias2").is_null(), i == 0 || i == 4);
            }
            EXPECT_EQ(wall, row.at("pt_wall_ms"));
        }
    }
    // Cells with the same bits are measured once, on clocks of their own.
    EXPECT_EQ(cells[0].at("convergence").at("shared_with"), "");
    EXPECT_EQ(cells[1].at("convergence").at("shared_with"), cells[0].at("cell"));
    for (std::size_t sample = 0; sample < 3; ++sample) {
        const Json& own = rows[cells[0].at("cell")][sample];
        const Json& other = rows[cells[1].at("cell")][sample];
        for (std::size_t i = 0; i < 5; ++i) {
            Json a = own.at("pt_checkpoints")[i];
            Json b = other.at("pt_checkpoints")[i];
            EXPECT_EQ(a.at("shared"), false);
            EXPECT_EQ(b.at("shared"), true);
            EXPECT_NE(a.at("wall_ms"), b.at("wall_ms"));
            for (const char* key : {"wall_ms", "device_ms", "cpu_ms", "shared"}) {
                a.erase(key);
                b.erase(key);
            }
            EXPECT_EQ(a, b);
        }
    }
    // The first sample's images and the reference, beside the result.
    for (const Json& cell : cells) {
        const Json& images = cell.at("convergence").at("images");
        EXPECT_EQ(images.at("by_spp").size(), 5u);
        for (const Json& name : {images.at("reference"), images.at("by_spp").at("12")}) {
            const std::string image = test::content_of(folder.file("out/" + name.get<std::string>()));
            EXPECT_EQ(image.find("PF\n8 6\n-1.0\n"), 0u);
            EXPECT_EQ(image.size(), 12 + 8 * 6 * 12u);
        }
    }
}

// A folder that has the name of a result's images keeps its files, but for those that the earlier result names.
TEST(ImagesFolderTest, KeepsWhatNoResultNames) {
    const test::TemporaryFolder folder;
    const std::string result = folder.file("room.json");
    std::filesystem::create_directories(folder.file("room_images/sub"));
    std::filesystem::create_directories(images_folder(result, true));
    for (const char* name : {"room_images/a.pfm", "room_images/b.pfm", "room_images/wall.png", "a.pfm"}) {
        test::write_text(folder.file(name), "old");
    }
    test::write_text(images_folder(result, true) + "/b.pfm", "new");
    test::write_text(images_folder(result, true) + "/c.pfm", "new");
    replace_images(result, {"room_images/a.pfm", "room_images/b.pfm", "a.pfm"});
    EXPECT_EQ(folder.content(),
              (std::vector<std::string>{"a.pfm", "room_images", "room_images/b.pfm", "room_images/c.pfm",
                                        "room_images/sub", "room_images/wall.png"}));
    EXPECT_EQ(test::content_of(folder.file("room_images/b.pfm")), "new");
}

TEST_F(ConvergenceTest, BiasesAreDeclaredAndSeen) {
    const Suite biased = suite(R"({"name": "frozen", "type": "convergence", "scenes": ["tiny"], "spp": 64,
            "variants": [{}, {"axes": {"first_bounce": ["cached_jitters"]}, "tunables": {"jitters": [1]}},
                         {"axes": {"first_bounce": ["off", "cached_jitters"]}, "tunables": {"jitters": [2]}}],
            "axes": {"integrator": ["depth_first"]}, "without_checkpoints": false,
            "reference": {"variance": 1e-5, "most_spp": 65536}},
        {"name": "cached", "type": "convergence", "scenes": ["still"], "spp": 64, "without_checkpoints": false,
            "axes": {"integrator": ["depth_first"], "first_bounce": ["cached"]},
            "reference": {"scene": "tiny", "variance": 1e-5, "most_spp": 65536}})");
    ASSERT_EQ(run(biased, options()), exit_good) << progress;
    const Json file = result();
    EXPECT_EQ(file.at("ptbench").at("studies").size(), 2u);
    auto rows = sample_rows(file);
    const auto last_bias = [&](const Json& cell) {
        double sum = 0;
        for (const Json& row : rows[cell.at("cell")]) {
            sum += row.at("pt_checkpoints").back().at("bias2").get<double>() / 3;
        }
        return sum;
    };
    const std::vector<Json> frozen = cells_of_study(file, "frozen");
    ASSERT_EQ(frozen.size(), 3u);
    EXPECT_TRUE(frozen[0].at("convergence").at("biases").empty());
    for (const Json& cell : {frozen[1], frozen[2]}) {
        EXPECT_EQ(cell.at("convergence").at("biases"),
                  Json({"first_bounce=cached_jitters: pixel, lens and shutter are sampled at K points, however many "
                        "samples are taken"}));
        EXPECT_EQ(cell.at("claim"), "biased");
    }
    const double one = last_bias(frozen[1]);
    const double two = last_bias(frozen[2]);
    EXPECT_GT(one, 10 * std::abs(last_bias(frozen[0])));
    EXPECT_GT(one / two, 1.3);
    EXPECT_LT(one / two, 3);
    const Json cached = cells_of_study(file, "cached").at(0);
    EXPECT_EQ(cached.at("convergence").at("reference").at("scene"), "tiny");
    EXPECT_EQ(cached.at("convergence").at("biases"), Json({"the scene is still, the reference's is tiny"}));
    EXPECT_GT(last_bias(cached), 10 * std::abs(last_bias(frozen[0])));
}

// A choice that sees one segment further runs at one less.
TEST_F(ConvergenceTest, AllVariantsOfAStudyHaveOneImageToConvergeTo) {
    const Suite lit = suite(R"({"name": "lit", "type": "convergence", "scenes": ["tiny"], "spp": 4, "depth": [1, 4],
        "axes": {"integrator": ["depth_first"], "direct_light": ["off", "final_bounce"]}})");
    const Plan plan = make_plan(lit);
    std::map<std::string, std::uint32_t> depths;
    for (const Cell& cell : plan.cells) {
        if (cell.convergence) {
            depths[cell.variant["direct_light"] + std::to_string(cell.convergence->reference.depth)] =
                cell.settings.depth;
        }
    }
    EXPECT_EQ(depths, (std::map<std::string, std::uint32_t>{{"off1", 1}, {"off4", 4}, {"final_bounce4", 3}}));
    ASSERT_EQ(plan.not_applicable.size(), 1u);
    EXPECT_EQ(plan.not_applicable[0].reason.text, "has no depth at which its mean is that of 1");
}

TEST_F(ConvergenceTest, AReferenceThatIsTooNoisyIsRefusedWithTheSamplesThatWouldDo) {
    const auto with_most = [&](std::uint64_t spp) {
        return suite(R"({"name": "errors", "type": "convergence", "scenes": ["tiny"],
            "axes": {"integrator": ["depth_first"]}, "spp": 1024, "without_checkpoints": false,
            "reference": {"variance": 1, "most_spp": )" +
                     std::to_string(spp) + "}}");
    };
    EXPECT_EQ(run(with_most(128), options()), exit_check_failed);
    const Json refused = cells_of_study(result(), "errors").at(0);
    EXPECT_EQ(refused.at("status"), "failed");
    const std::string reason = refused.at("reason");
    EXPECT_EQ(reason.find("its reference tiny/8x6/depth:3/cpu is too noisy with 128 spp a half: "), 0u) << reason;
    const std::size_t place = reason.find("; ");
    ASSERT_NE(place, std::string::npos) << reason;
    const auto would_do = static_cast<std::uint64_t>(std::stoull(reason.substr(place + 2)));
    EXPECT_TRUE(reason.ends_with(" spp a half would do (most_spp: 128)")) << reason;
    EXPECT_GT(would_do, 128u);
    // More than enough: it is rendered on as far as the study needs, not to the most that is allowed.
    RunOptions again = options();
    again.overwrite = true;
    ASSERT_EQ(run(with_most(1u << 20), again), exit_good) << progress;
    const std::uint64_t taken =
        cells_of_study(result(), "errors").at(0).at("convergence").at("reference").at("spp_per_half");
    EXPECT_GT(taken, 128u);
    EXPECT_LE(taken, 8 * would_do);
}

TEST_F(ConvergenceTest, AnInterruptedRunGoesOnWithTheSamplesThatItHad) {
    const Suite what = suite(R"({"name": "errors", "type": "convergence", "scenes": ["tiny"], "spp": 8,
        "axes": {"compaction": ["test_hooked"]}, "without_checkpoints": false, "reference": {"variance": 1e-3}})");
    RunOptions how = options();
    ASSERT_EQ(run(what, how), exit_good) << progress;
    const auto complete = sample_rows(result()).begin()->second;
    std::filesystem::remove(out);
    // Verification, two renders before the clock, the warm-up, and the second sample.
    int renders = 0;
    on_render = [&] {
        if (++renders == 6) {
            std::raise(SIGINT);
        }
    };
    ASSERT_EQ(run(what, how), exit_interrupted);
    on_render = nullptr;
    const auto cut = sample_rows(result()).begin()->second;
    ASSERT_EQ(cut.size(), 2u);

    // A reference that has become another one in the meantime would make two kinds of error out of one curve.
    const std::string journal = test::content_of(journal_file);
    how.resume = true;
    ReferenceTask better = make_plan(what).cells.at(0).convergence->reference;
    better.variance = 0;
    better.most_spp = 16384;
    (void)ReferenceMaker(how.reference_cache).make(better);
    EXPECT_NE(refusal([&] { run(what, how); }).find(" were compared with another reference than "), std::string::npos);
    EXPECT_EQ(test::content_of(journal_file), journal);

    std::filesystem::remove_all(how.reference_cache);
    ASSERT_EQ(run(what, how), exit_good) << progress;
    const auto resumed = sample_rows(result()).begin()->second;
    ASSERT_EQ(resumed.size(), 3u);
    for (std::size_t i = 0; i < resumed.size(); ++i) {
        EXPECT_EQ(resumed[i] == cut[std::min<std::size_t>(i, 1)], i < 2) << i;
        for (std::size_t c = 0; c < 4; ++c) {
            for (const char* key : {"film_hash", "mse", "mse_dual", "bias2", "me_rgb"}) {
                EXPECT_EQ(resumed[i].at("pt_checkpoints")[c].at(key), complete[i].at("pt_checkpoints")[c].at(key));
            }
        }
    }
}

TEST_F(ConvergenceTest, ASeedOfTheReferencesIsRefused) {
    RunOptions how = options();
    how.seed = reference_seeds[0] - 2;
    EXPECT_THROW(run(suite(two_integrators), how), InputError);
}

TEST_F(ConvergenceTest, ABackendMayHaveItsOwnReference) {
    const Plan plan = make_plan(suite(R"({"name": "a", "type": "convergence", "scenes": ["tiny"],
        "reference": {"variance": {"cpu": 0.25, "cuda": 0.5}, "most_spp": {"cpu": 7, "cuda": 9},
                      "axes": {"direct_light": "final_bounce"}}})"));
    const ReferenceTask& task = plan.cells.at(0).convergence->reference;
    EXPECT_EQ(task.variance, 0.25);
    EXPECT_EQ(task.most_spp, 7u);
    EXPECT_EQ(reference_variant(task)["direct_light"], "final_bounce");
    EXPECT_EQ(reference_variant(task)["sampler"], "philox");
    EXPECT_EQ(reference_variant(task)["precision"], "double");
}

TEST_F(ConvergenceTest, OctavesEndWithTheLastSample) {
    EXPECT_EQ(octaves(1), (std::vector<std::uint32_t>{1}));
    EXPECT_EQ(octaves(8), (std::vector<std::uint32_t>{1, 2, 4, 8}));
    EXPECT_EQ(octaves(9), (std::vector<std::uint32_t>{1, 2, 4, 8, 9}));
}

TEST_F(ConvergenceTest, RefusesBadStudiesWithTheirPlace) {
    const std::string file = folder.file("scenes/suites/tiny_suite.json");
    const std::string head = R"({"name": "a", "type": "convergence", "scenes": ["tiny"])";
    const struct {
        std::string study, message;
    } cases[] = {
        {R"({"name": "a", "type": "error", "scenes": ["tiny"]})",
         "$.studies[0].type: found \"error\", allowed: \"time\", \"convergence\""},
        {R"({"name": "a", "scenes": ["tiny"], "images": true})",
         "$.studies[0]: found unknown key \"images\", allowed: "},
        {head + R"(, "figure": "integrator"})", "$.studies[0].figure: found \"integrator\", allowed: \"convergence\""},
        {head + R"(, "images": 1})", "$.studies[0].images: found 1, allowed: true or false"},
        {head + R"(, "variants": []})", "$.studies[0].variants: found [], allowed: at least one set of choices"},
        {head + R"(, "variants": [{"axis": {}}]})",
         "$.studies[0].variants[0]: found unknown key \"axis\", allowed: axes, tunables"},
        {head + R"(, "variants": [{"axes": {"integrator": ["magic"]}}]})",
         "$.studies[0].variants[0].axes.integrator: found \"magic\", allowed: "},
        {head + R"(, "reference": {"spp": 4}})",
         "$.studies[0].reference: found unknown key \"spp\", allowed: scene, axes, variance, most_spp"},
        {head + R"(, "reference": {"variance": 0}})",
         "$.studies[0].reference.variance: found 0, allowed: a number above 0"},
        {head + R"(, "reference": {"variance": {"cpu": 1, "cuda": -1}}})",
         "$.studies[0].reference.variance.cuda: found -1, allowed: a number above 0"},
        {head + R"(, "reference": {"most_spp": 0}})",
         "$.studies[0].reference.most_spp: found 0, allowed: a whole number from 1 to 2147483648"},
        {head + R"(, "reference": {"most_spp": {"cpu": 4}}})",
         "$.studies[0].reference.most_spp: found no key \"cuda\", allowed: it is required"},
        {head + R"(, "reference": {"axes": {"direct_light": "moon"}}})",
         "$.studies[0].reference.axes.direct_light: found \"moon\", allowed: "},
        {head + R"(}, {"name": "a_without_checkpoints", "scenes": ["tiny"]})",
         "$.studies[0].name: found \"a\", allowed: a name to which _without_checkpoints can be added"},
    };
    for (const auto& c : cases) {
        const std::string message = refusal([&] { suite(c.study); });
        EXPECT_EQ(message.find(file + ": " + c.message), 0u) << c.study << "\n" << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
    test::write_text(file, R"({"name": "s", "repetitions": 7, "studies": [)" + head + "}]}");
    EXPECT_EQ(refusal([&] { load_suite(file); }),
              file + ": $.repetitions: found 7, allowed: 8 or more: the suite has a study of type convergence");
    // What only the plan can tell.
    EXPECT_EQ(refusal([&] {
                  make_plan(suite(head + R"(, "reference": {"axes": {"first_bounce": "cached"}}})"));
              }).find("study a: its reference depth_first first_bounce=cached "),
              0u);
    const std::string twice =
        head + R"(}, {"name": "b", "type": "convergence", "scenes": ["tiny"], "reference": {"scene": "still"}})";
    EXPECT_NE(refusal([&] { make_plan(suite(twice)); }).find("is compared with still/8x6/depth:3/cpu there and with "),
              std::string::npos);
}

}  // namespace
}  // namespace pt
