// Suites and plans: what a suite file may say, and which cells follow from it.
#include "harness/bench/suite.h"

#include <cstdlib>
#include <map>
#include <set>

#include <array>

#include <gtest/gtest.h>

#include "harness/bench/passport.h"
#include "harness/failure.h"
#include "harness/scene/places.h"
#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

std::string scene_text(const std::string& name, bool jitter, int depth = 3) {
    return R"({"name": ")" + name + R"(", "max_depth": )" + std::to_string(depth) + R"(, "environment": [1, 1, 1],
        "camera": {"eye": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 60,
                   "resolution": [8, 6], "jitter": )" +
           (jitter ? "true" : "false") + R"(},
        "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
        "objects": [{"shape": "sphere", "material": "white", "translate": [0, 0, 3]}]})";
}

template <class Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// A home with the scenes "jittered" and "still".
class SuiteTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("suite.json");

    void SetUp() override {
        std::filesystem::create_directories(folder.path() / "scenes" / "suites");
        test::write_text(folder.file("scenes/jittered.json"), scene_text("jittered", true));
        test::write_text(folder.file("scenes/still.json"), scene_text("still", false));
        ::setenv("PTBENCH_HOME", folder.path().c_str(), 1);
    }
    void TearDown() override { ::unsetenv("PTBENCH_HOME"); }

    Suite load(const std::string& text) const {
        test::write_text(file, text);
        return load_suite(file);
    }
    Suite load_studies(const std::string& studies) const {
        return load(R"({"name": "s", "studies": [)" + studies + "]}");
    }
    Plan plan(const std::string& studies) const { return make_plan(load_studies(studies)); }
};

const std::string known_axes =
    "integrator, compaction, sorting, sort_key, first_bounce, direct_light, russian_roulette, sampler, layout, "
    "specialisation, launch, "
    "arithmetic, "
    "precision, robustness, accelerator, builder, traversal, traversal_stack, levels, light_sampling, "
    "devices, partition, light_selection, subsurface_sampling";
const std::string baseline_name = "wavefront";

std::vector<std::string> cell_names(const Plan& plan) {
    std::vector<std::string> names;
    for (const Cell& cell : plan.cells) {
        names.push_back(cell.name);
    }
    return names;
}

// ---- Files ----

TEST_F(SuiteTest, ReadsEveryKey) {
    const Suite suite = load(R"({"name": "n", "description": "d", "repetitions": 3, "studies": [
        {"name": "one", "title": "t", "compares": "compaction", "along": "depth", "scenes": ["jittered", "still"],
         "axes": {"compaction": ["none", "thrust_remove_if"], "layout": ["soa"]}, "tunables": {"jitters": [4, 1]},
         "resolution": [20, 10], "depth": [2, 4], "spp": 5},
        {"name": "two", "scenes": ["still"]},
        {"name": "three", "scenes": ["still"], "resolution": [[20, 10], [5, 7], [8192, 1]]}]})");
    EXPECT_EQ(suite.name, "n");
    EXPECT_EQ(suite.description, "d");
    EXPECT_EQ(suite.repetitions, 3);
    ASSERT_EQ(suite.studies.size(), 3u);
    const Study& one = suite.studies[0];
    EXPECT_EQ(one.title, "t");
    EXPECT_EQ(one.compares, "compaction");
    EXPECT_EQ(one.along, "depth");
    EXPECT_EQ(one.scenes, (std::vector<std::string>{"jittered", "still"}));
    EXPECT_EQ(one.axes, (AxisChoices{{"compaction", {"none", "thrust_remove_if"}}, {"layout", {"soa"}}}));
    EXPECT_EQ(one.width, 20u);
    EXPECT_EQ(one.height, 10u);
    EXPECT_TRUE(one.more_sizes.empty());
    EXPECT_EQ(one.tunables, (TunableValues{{"jitters", {4, 1}}}));
    EXPECT_EQ(one.depths, (std::vector<std::uint32_t>{2, 4}));
    EXPECT_EQ(one.spp, 5u);
    const Study& two = suite.studies[1];
    EXPECT_EQ(two.title, "two");
    EXPECT_EQ(two.compares + two.along, "");
    EXPECT_TRUE(two.axes.empty());
    EXPECT_EQ(two.width, 0u);
    EXPECT_TRUE(two.depths.empty());
    EXPECT_EQ(two.spp, 1u);
    EXPECT_TRUE(two.tunables.empty());
    EXPECT_TRUE(two.more_sizes.empty());
    const Study& three = suite.studies[2];
    EXPECT_EQ(three.width, 20u);
    EXPECT_EQ(three.height, 10u);
    EXPECT_EQ(three.more_sizes, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{5, 7}, {8192, 1}}));
    EXPECT_EQ(load_studies(R"({"name": "one", "scenes": ["still"]})").repetitions, 9);
}

// Suites of before 1.1 name a figure.
TEST_F(SuiteTest, AnOlderSuitesFigureSaysWhatItCompares) {
    const std::vector<std::array<std::string, 3>> all{{"remaining_paths", "live_paths", ""},
                                                      {"sorting_by_depth", "sorting", "depth"},
                                                      {"first_bounce_by_depth", "first_bounce", "depth"},
                                                      {"scaling_by_resolution", "", "resolution"},
                                                      {"scaling_by_depth", "", "depth"},
                                                      {"scaling_by_materials", "", "materials"},
                                                      {"scaling_by_shading_fmas", "", "shading_fmas"},
                                                      {"layout", "layout", ""},
                                                      {"jitters", "jitters", ""}};
    for (const auto& [figure, compares, along] : all) {
        const Suite suite = load_studies(
            R"({"name": "one", "scenes": ["still"], "tunables": {"jitters": [1, 4]}, "figure": ")" + figure + "\"}");
        EXPECT_EQ(suite.studies[0].compares, compares) << figure;
        EXPECT_EQ(suite.studies[0].along, along) << figure;
    }
}

TEST_F(SuiteTest, RefusesBadFilesWithTheirPlace) {
    const std::string depths = "a whole number from 1 to 1000000, or an array of such";
    const struct {
        std::string studies, message;
    } cases[] = {
        {R"(7)", "$.studies[0]: found 7, allowed: an object"},
        {R"({"scenes": ["still"]})", "$.studies[0]: found no key \"name\", allowed: it is required"},
        {R"({"name": "a"})", "$.studies[0]: found no key \"scenes\", allowed: it is required"},
        {R"({"name": 5, "scenes": ["still"]})", "$.studies[0].name: found 5, allowed: a string"},
        {R"({"name": "a", "scenes": ["still"], "sppp": 1})",
         "$.studies[0]: found unknown key \"sppp\", allowed: name, type, title, scenes, axes, tunables, "
         "variants, resolution, depth, spp, figure, compares, along"},
        {R"({"name": "a", "scenes": "still"})", "$.studies[0].scenes: found \"still\", allowed: an array"},
        {R"({"name": "a", "scenes": []})", "$.studies[0].scenes: found [], allowed: at least one name"},
        {R"({"name": "a", "scenes": ["still", 3]})", "$.studies[0].scenes[1]: found 3, allowed: a string"},
        {R"({"name": "a", "scenes": ["still", "still"]})",
         "$.studies[0].scenes[1]: found \"still\" twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"]}, {"name": "a", "scenes": ["still"]})",
         "$.studies[1].name: found \"a\" twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "figure": "pie"})",
         "$.studies[0].figure: found \"pie\", allowed: \"first_bounce_by_depth\", "},
        {R"({"name": "a", "scenes": ["still"], "compares": "pie"})",
         "$.studies[0].compares: found \"pie\", allowed: \"live_paths\", "},
        {R"({"name": "a", "scenes": ["still"], "compares": "layout", "along": "time"})",
         "$.studies[0].along: found \"time\", allowed: \"resolution\", \"depth\", \"materials\", \"shading_fmas\""},
        {R"({"name": "a", "scenes": ["still"], "along": "depth"})",
         "$.studies[0].along: found \"depth\", allowed: none without an axis that the study compares"},
        {R"({"name": "a", "scenes": ["still"], "compares": "layout", "figure": "layout"})",
         "$.studies[0].figure: found \"layout\", allowed: `compares` alone, which has taken its place"},
        {R"({"name": "a", "scenes": ["still"], "axes": ["compaction"]})",
         "$.studies[0].axes: found [\"compaction\"], allowed: an object of arrays of choices, by axis"},
        {R"({"name": "a", "scenes": ["still"], "axes": {"compaction": "none"}})",
         "$.studies[0].axes.compaction: found \"none\", allowed: an array"},
        {R"({"name": "a", "scenes": ["still"], "axes": {"compaction": []}})",
         "$.studies[0].axes.compaction: found [], allowed: at least one name"},
        {R"({"name": "a", "scenes": ["still"], "axes": {"colour": ["red"]}})",
         "$.studies[0].axes: found axis \"colour\", allowed: " + known_axes},
        {R"({"name": "a", "scenes": ["still"], "axes": {"compaction": ["none", "magic"]}})",
         "$.studies[0].axes.compaction: found \"magic\", allowed: " + test::choice_names("compaction")},
        {R"({"name": "a", "scenes": ["still"], "axes": {"compaction": ["none", "none"]}})",
         "$.studies[0].axes.compaction[1]: found \"none\" twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [5]})",
         "$.studies[0].resolution: found [5], allowed: an array of 2 whole numbers, [width, height]"},
        {R"({"name": "a", "scenes": ["still"], "resolution": 5})",
         "$.studies[0].resolution: found 5, allowed: an array"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [5, 0]})",
         "$.studies[0].resolution[1]: found 0, allowed: a whole number from 1 to 8192"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [5.5, 5]})",
         "$.studies[0].resolution[0]: found 5.5, allowed: a whole number from 1 to 8192"},
        {R"({"name": "a", "scenes": ["still"], "resolution": []})",
         "$.studies[0].resolution: found [], allowed: an array of 2 whole numbers, [width, height]"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [[5, 6], [7]]})",
         "$.studies[0].resolution[1]: found [7], allowed: an array of 2 whole numbers, [width, height]"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [[5, 6], 7]})",
         "$.studies[0].resolution[1]: found 7, allowed: an array"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [5, [6, 7]]})",
         "$.studies[0].resolution[1]: found [6,7], allowed: a whole number from 1 to 8192"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [[5, 6], [7, 8193]]})",
         "$.studies[0].resolution[1][1]: found 8193, allowed: a whole number from 1 to 8192"},
        {R"({"name": "a", "scenes": ["still"], "resolution": [[5, 6], [6, 5], [5, 6]]})",
         "$.studies[0].resolution[2]: found [5,6] twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "resolution": {"cpu": [5, 6]}})",
         "$.studies[0].resolution: found no key \"cuda\", allowed: it is required"},
        {R"({"name": "a", "scenes": ["still"], "resolution": {"cpu": [5, 6], "cuda": [0, 6]}})",
         "$.studies[0].resolution.cuda[0]: found 0, allowed: a whole number from 1 to 8192"},
        {R"({"name": "a", "scenes": ["still"], "tunables": ["jitters"]})",
         "$.studies[0].tunables: found [\"jitters\"], allowed: an object of arrays of whole numbers, by tunable"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": 4}})",
         "$.studies[0].tunables.jitters: found 4, allowed: an array"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": []}})",
         "$.studies[0].tunables.jitters: found [], allowed: at least one value"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": ["4"]}})",
         "$.studies[0].tunables.jitters[0]: found \"4\", allowed: a whole number"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": [4, 1.5]}})",
         "$.studies[0].tunables.jitters[1]: found 1.5, allowed: a whole number"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": [-1]}})",
         "$.studies[0].tunables.jitters[0]: found -1, allowed: a whole number"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": [4, 0]}})",
         "$.studies[0].tunables.jitters[1]: found 0, allowed: a whole number from 1 to 4096"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": [4097]}})",
         "$.studies[0].tunables.jitters[0]: found 4097, allowed: a whole number from 1 to 4096"},
        {R"({"name": "a", "scenes": ["still"], "tunables": {"jitters": [4, 4]}})",
         "$.studies[0].tunables.jitters[1]: found 4 twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "depth": 0})", "$.studies[0].depth: found 0, allowed: " + depths},
        {R"({"name": "a", "scenes": ["still"], "depth": "8"})", "$.studies[0].depth: found \"8\", allowed: " + depths},
        {R"({"name": "a", "scenes": ["still"], "depth": []})",
         "$.studies[0].depth: found [], allowed: at least one depth"},
        {R"({"name": "a", "scenes": ["still"], "depth": [2, -1]})",
         "$.studies[0].depth[1]: found -1, allowed: " + depths},
        {R"({"name": "a", "scenes": ["still"], "depth": [2, 2]})",
         "$.studies[0].depth[1]: found 2 twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "spp": 0})",
         "$.studies[0].spp: found 0, allowed: a whole number from 1 to 1000000"},
        {R"({"name": "a", "scenes": ["still"], "spp": 1.0})",
         "$.studies[0].spp: found 1.0, allowed: a whole number from 1 to 1000000"},
        {R"({"name": "a", "scenes": ["still"], "spp": []})",
         "$.studies[0].spp: found [], allowed: at least one number of samples"},
        {R"({"name": "a", "scenes": ["still"], "spp": [4, 4]})", "$.studies[0].spp[1]: found 4 twice, allowed: once"},
        {R"({"name": "a", "scenes": ["still"], "spp": {"cpu": 1}})",
         "$.studies[0].spp: found no key \"cuda\", allowed: it is required"},
        {R"({"name": "a", "scenes": ["still"], "spp": {"cpu": 1, "cuda": 0}})",
         "$.studies[0].spp.cuda: found 0, allowed: a whole number from 1 to 1000000"},
        {R"({"name": "a", "scenes": ["still"], "spp": {"cpu": 1, "cuda": 2, "gpu": 3}})",
         "$.studies[0].spp: found unknown key \"gpu\", allowed: cpu, cuda"},
    };
    for (const auto& c : cases) {
        const std::string message = refusal([&] { load_studies(c.studies); });
        EXPECT_EQ(message.find(file + ": " + c.message), 0u) << c.studies << "\n" << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
}

// A suite may name what only a build with a CUDA toolkit has: it does not apply, whatever this build is.
TEST_F(SuiteTest, KnowsTheChoicesOfEveryBuildByName) {
    const Plan made = plan(R"({"name": "a", "scenes": ["still"],
        "axes": {"compaction": ["none", "gap_fill", "cub_select_if"], "integrator": ["wavefront", "persistent"]}})");
    EXPECT_EQ(made.cells.size(), 1u);
    std::set<std::string> reasons;
    for (const NotApplicable& entry : made.not_applicable) {
        reasons.insert(entry.reason.text);
    }
    EXPECT_EQ(reasons, (std::set<std::string>{"integrator=persistent is not there on the backend cpu",
                                              "compaction=gap_fill is not there on the backend cpu",
                                              "compaction=cub_select_if is not there on the backend cpu"}));
    const std::string studies = R"({"name": "a", "scenes": ["still"], "tunables": {"payload": [0, 1]}})";
    for (const NotApplicable& entry : plan(studies).not_applicable) {
        EXPECT_EQ(entry.reason.text.find("payload="), 0u) << entry.reason.text;
        EXPECT_TRUE(entry.reason.text.ends_with(" tunes none of the variant's choices")) << entry.reason.text;
    }
    EXPECT_TRUE(plan(studies).cells.empty());
}

TEST_F(SuiteTest, RefusesUnknownTunables) {
    const std::string studies = R"({"name": "a", "scenes": ["still"], "tunables": {"colour": [4]}})";
    const std::string message = refusal([&] { load_studies(studies); });
    if (test::cuda_is_built()) {
        EXPECT_EQ(message, file + ": $.studies[0].tunables.colour[0]: found tunable \"colour\", allowed: " +
                               test::tunable_names());
        return;
    }
    // An unknown tunable may be one of CUDA's, which this build does not know: it tunes nothing.
    EXPECT_EQ(message, "");
    EXPECT_TRUE(plan(studies).cells.empty());
    EXPECT_EQ(plan(studies).not_applicable.at(0).reason.text, "colour=4 tunes none of the variant's choices");
}

TEST_F(SuiteTest, RefusesBadTopLevels) {
    const struct {
        std::string text, message;
    } cases[] = {
        {"", "not valid JSON: "},
        {"{", "not valid JSON: "},
        {"[]", "$: found [], allowed: an object"},
        {"{}", "$: found no key \"name\", allowed: it is required"},
        {R"({"name": "s"})", "$: found no key \"studies\", allowed: it is required"},
        {R"({"name": "s", "studies": {}})", "$.studies: found an object, allowed: an array"},
        {R"({"name": "s", "studies": []})", "$.studies: found [], allowed: at least one study"},
        {R"({"name": "s", "studies": [], "reps": 1})",
         "$: found unknown key \"reps\", allowed: name, description, repetitions, decide_seconds, studies"},
        {R"({"name": "s", "repetitions": 0, "studies": []})",
         "$.repetitions: found 0, allowed: a whole number from 1 to 10000"},
        {R"({"name": "s", "decide_seconds": -1, "studies": []})",
         "$.decide_seconds: found -1, allowed: a whole number of seconds from 0 to 86400"},
        {R"({"name": "s", "name": "t", "studies": []})", "$: found the key \"name\" twice, allowed: once"},
    };
    for (const auto& c : cases) {
        const std::string message = refusal([&] { load(c.text); });
        EXPECT_NE(message.find(c.message), std::string::npos) << c.text << "\n" << message;
        EXPECT_EQ(message.find(file), 0u) << message;
    }
    EXPECT_EQ(refusal([&] { load_suite(folder.file("none.json")); }),
              folder.file("none.json") +
                  ": the file: found no such file, allowed: a regular file of at most 64 MiB that can be read");
}

TEST_F(SuiteTest, RefusesUnknownAndUnreadableScenes) {
    EXPECT_EQ(refusal([&] { plan(R"({"name": "a", "scenes": ["nope"]})"); }),
              "--scene: name: found \"nope\", allowed: a file that ends in .json, or one of jittered, still");
    test::write_text(folder.file("broken.json"), "{");
    EXPECT_NE(refusal([&] {
                  plan(R"({"name": "a", "scenes": [")" + folder.file("broken.json") + "\"]}");
              }).find("broken.json: not valid JSON"),
              std::string::npos);
}

// Cells are known by their scene's name, so two scenes of one name would be taken for one.
TEST_F(SuiteTest, TellsTwoScenesOfOneNameApartByTheirHashes) {
    const std::string other = folder.file("other.json");
    test::write_text(other, scene_text("still", false, 5));
    for (const std::string& scenes : {"\"still\", \"" + other + "\"", "\"" + other + "\", \"still\""}) {
        const Plan both = plan(R"({"name": "a", "scenes": [)" + scenes + "]}");
        ASSERT_EQ(both.cells.size(), 2u);
        std::set<std::string> names;
        for (const Cell& cell : both.cells) {
            EXPECT_EQ(cell.scene->name, "still@" + cell.scene->hash.substr(0, 8));
            EXPECT_NE(cell.name.find("/scene:" + cell.scene->name + "/"), std::string::npos) << cell.name;
            names.insert(cell.name);
        }
        EXPECT_EQ(names.size(), 2u);
    }
    // One scene's text in two places is one scene.
    test::write_text(other, scene_text("still", false));
    EXPECT_EQ(plan(R"({"name": "a", "scenes": ["still", ")" + other + "\"]}").cells.size(), 1u);
}

// ---- Plans ----

TEST_F(SuiteTest, ACellIsNamedAfterAllThatItIs) {
    const Plan made = plan(R"({"name": "a", "scenes": ["jittered"], "axes": {"compaction": ["thrust_remove_if"]},
                               "resolution": [20, 10], "depth": 4, "spp": 5})");
    ASSERT_EQ(made.cells.size(), 1u);
    const Cell& cell = made.cells[0];
    EXPECT_EQ(cell.name, "wavefront/compaction:thrust_remove_if/scene:jittered/backend:cpu/20x10/depth:4/spp:5");
    EXPECT_EQ(cell.studies, std::vector<std::string>{"a"});
    EXPECT_EQ(cell.scene->name, "jittered");
    EXPECT_EQ(shown_name(cell.variant, Backend::cpu), "wavefront compaction=thrust_remove_if");
    EXPECT_EQ(cell.settings.width, 20u);
    EXPECT_EQ(cell.settings.height, 10u);
    EXPECT_EQ(cell.settings.depth, 4u);
    EXPECT_EQ(cell.spp, 5u);
}

TEST_F(SuiteTest, TheScenesOwnSettingsAreTheDefault) {
    const Plan made = plan(R"({"name": "a", "scenes": ["jittered"]})");
    ASSERT_EQ(cell_names(made), std::vector<std::string>{"wavefront/scene:jittered/backend:cpu/8x6/depth:3/spp:1"});
}

TEST_F(SuiteTest, TheProductIsFullAndWhatDoesNotApplyIsListedWithItsReason) {
    const Plan made = plan(R"({"name": "a", "scenes": ["jittered", "still"], "depth": [2, 3],
        "axes": {"first_bounce": ["off", "cached"], "layout": ["aos", "soa"], "integrator": ["wavefront", "depth_first"]}})");
    // wavefront: 2 layouts, depth_first: aos only; cached only on the still scene; each at 2 depths.
    EXPECT_EQ(made.cells.size(), 2u * (3u + 6u));
    std::map<std::string, int> reasons;
    for (const NotApplicable& entry : made.not_applicable) {
        EXPECT_EQ(entry.study, "a");
        reasons[entry.scene + ": " + entry.reason.text] += 1;
    }
    const std::string layout =
        "integrator=depth_first keeps one path in registers, no array of paths: needs layout=aos, not soa";
    const std::string jitter = "first_bounce=cached needs jitter off (camera.jitter is true in the scene)";
    // Once a variant, not once a depth; the first axis that does not apply gives the reason.
    EXPECT_EQ(reasons, (std::map<std::string, int>{
                           {"jittered: " + layout, 2}, {"jittered: " + jitter, 3}, {"still: " + layout, 2}}));
    const std::vector<std::string> names = cell_names(made);
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

// A suite may compare what only one backend has: it says so instead of failing there.
TEST_F(SuiteTest, AChoiceOfAnotherBackendIsNotApplicable) {
    const std::string studies = R"({"name": "a", "scenes": ["still"],
        "axes": {"launch": ["stream", "graph"], "arithmetic": ["exact", "fast"]}})";
    const Plan made = plan(studies);
    EXPECT_EQ(cell_names(made), std::vector<std::string>{baseline_name + "/scene:still/backend:cpu/8x6/depth:3/spp:1"});
    std::vector<std::string> reasons;
    for (const NotApplicable& entry : made.not_applicable) {
        reasons.push_back(entry.reason.text);
    }
    // The first axis that is not there gives the reason.
    EXPECT_EQ(reasons, (std::vector<std::string>{"arithmetic=fast is not there on the backend cpu",
                                                 "launch=graph is not there on the backend cpu",
                                                 "launch=graph is not there on the backend cpu"}));
    if (!test::cuda_is_built()) {
        return;
    }
    const Plan on_gpu = make_plan(load_studies(R"({"name": "a", "scenes": ["still"],
        "axes": {"integrator": ["wavefront", "depth_first"], "launch": ["stream", "graph"]}})"),
                                  Backend::cuda);
    const std::string settings = "/scene:still/backend:cuda/8x6/depth:3/spp:1";
    EXPECT_EQ(cell_names(on_gpu),
              (std::vector<std::string>{"wavefront" + settings, "wavefront/launch:graph" + settings}));
    ASSERT_EQ(on_gpu.not_applicable.size(), 2u);
    EXPECT_EQ(on_gpu.not_applicable[0].reason.text, "integrator=depth_first is not there on the backend cuda");
    for (const Cell& cell : on_gpu.cells) {
        EXPECT_EQ(cell.backend, Backend::cuda);
    }
}

TEST_F(SuiteTest, SeveralResolutionsAreSoManyCells) {
    const Plan made = plan(R"({"name": "a", "scenes": ["still"], "axes": {"layout": ["aos", "soa"]}, "depth": [2, 3],
                               "resolution": [[20, 10], [5, 7], [4, 4]]})");
    EXPECT_EQ(made.cells.size(), 2u * 2u * 3u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sizes;
    for (const Cell& cell : made.cells) {
        sizes[{cell.settings.width, cell.settings.height}] += 1;
        EXPECT_NE(cell.name.find("/" + std::to_string(cell.settings.width) + "x" +
                                 std::to_string(cell.settings.height) + "/"),
                  std::string::npos)
            << cell.name;
    }
    EXPECT_EQ(sizes, (std::map<std::pair<std::uint32_t, std::uint32_t>, int>{{{20, 10}, 4}, {{5, 7}, 4}, {{4, 4}, 4}}));
    const std::vector<std::string> names = cell_names(made);
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

TEST_F(SuiteTest, ABackendMayHaveItsOwnSamples) {
    const std::string studies = R"({"name": "a", "scenes": ["still"], "spp": {"cpu": 3, "cuda": 40}},
                                   {"name": "b", "scenes": ["still"], "spp": 5})";
    const Suite suite = load_studies(studies);
    EXPECT_EQ(suite.studies[0].spps_for(Backend::cpu), std::vector<std::uint32_t>{3});
    EXPECT_EQ(suite.studies[0].spps_for(Backend::cuda), std::vector<std::uint32_t>{40});
    EXPECT_EQ(suite.studies[1].spps_for(Backend::cuda), std::vector<std::uint32_t>{5});
    const auto samples = [&](Backend backend) {
        std::vector<std::uint32_t> spp;
        for (const Cell& cell : make_plan(suite, backend).cells) {
            spp.push_back(cell.spp);
            EXPECT_TRUE(cell.name.ends_with("/spp:" + std::to_string(cell.spp))) << cell.name;
        }
        return spp;
    };
    EXPECT_EQ(samples(Backend::cpu), (std::vector<std::uint32_t>{3, 5}));
    if (test::cuda_is_built()) {
        EXPECT_EQ(samples(Backend::cuda), (std::vector<std::uint32_t>{40, 5}));
    }
}

TEST_F(SuiteTest, EveryValueOfATunableIsACell) {
    const Plan made = plan(R"({"name": "a", "scenes": ["jittered"], "axes": {"first_bounce": ["off", "cached_jitters"]},
                               "tunables": {"jitters": [4, 16]}})");
    const std::string kept = "wavefront/first_bounce:cached_jitters";
    const std::string settings = "/scene:jittered/backend:cpu/8x6/depth:3/spp:1";
    // 16 is the standard: no part of the name, and nothing that a variant without the tunable lacks.
    EXPECT_EQ(cell_names(made),
              (std::vector<std::string>{baseline_name + settings, kept + "/jitters:4" + settings, kept + settings}));
    ASSERT_EQ(made.not_applicable.size(), 1u);
    EXPECT_EQ(shown_name(made.not_applicable[0].variant, Backend::cpu), baseline_name + " jitters=4");
    EXPECT_EQ(made.not_applicable[0].reason.text, "jitters=4 tunes none of the variant's choices");
}

TEST_F(SuiteTest, ACellThatTwoStudiesShareIsOneCellOfBoth) {
    const Plan made = plan(R"({"name": "a", "scenes": ["still"], "axes": {"layout": ["aos", "soa"]}},
                              {"name": "b", "scenes": ["still"], "axes": {"first_bounce": ["off", "cached"]}})");
    ASSERT_EQ(made.cells.size(), 3u);
    EXPECT_EQ(made.cells[0].studies, (std::vector<std::string>{"a", "b"}));  // the baseline
    EXPECT_EQ(made.cells[1].studies, std::vector<std::string>{"a"});
    EXPECT_EQ(made.cells[2].studies, std::vector<std::string>{"b"});
    // Studies of other settings share no cells.
    EXPECT_EQ(plan(R"({"name": "a", "scenes": ["still"]}, {"name": "b", "scenes": ["still"], "spp": 2})").cells.size(),
              2u);
}

TEST_F(SuiteTest, SamplesMayBeAList) {
    const Plan listed = plan(R"({"name": "a", "scenes": ["still"], "spp": [1, 16, 256]})");
    ASSERT_EQ(listed.cells.size(), 3u);
    EXPECT_EQ(listed.cells[0].spp, 1u);
    EXPECT_EQ(listed.cells[1].spp, 16u);
    EXPECT_EQ(listed.cells[2].spp, 256u);
}

TEST_F(SuiteTest, ExpansionCounts) {
    EXPECT_EQ(expand({}).size(), 1u);
    EXPECT_EQ(expand({})[0], Registry::instance().baseline());
    EXPECT_EQ(
        expand({{"layout", {"aos", "soa"}}, {"compaction", {"none", "thrust_partition", "thrust_remove_if"}}}).size(),
        6u);
    // The axes that have one choice on the CPU (sort_key, launch, arithmetic, devices) count for 1.
    AxisChoices axes = all_choices();
    axes.erase("accelerator");
    axes.erase("builder");
    axes.erase("levels");
    axes.erase("light_sampling");
    axes.erase("light_selection");
    axes.erase("subsurface_sampling");
    EXPECT_EQ(expand(axes).size(), 4u * 5u * 3u * 3u * 5u * 4u * 7u * 2u * 3u * 3u * 2u);
}

TEST_F(SuiteTest, AxisArguments) {
    AxisChoices axes;
    add_axis_argument(axes, "compaction=none,thrust_partition");
    EXPECT_EQ(axes.at("compaction"), (std::vector<std::string>{"none", "thrust_partition"}));
    add_axis_argument(axes, "sorting=all");
    EXPECT_EQ(axes.at("sorting"), (std::vector<std::string>{"none", "bucket", "thrust_sort_by_key"}));
    EXPECT_EQ(axes.size(), 2u);

    const std::string form = "allowed: NAME=CHOICE or NAME=CHOICE,CHOICE";
    const std::pair<std::string, std::string> cases[] = {
        {"", "--axis: argument: found \"\", " + form},
        {"sorting", "--axis: argument: found \"sorting\", " + form},
        {"=none", "--axis: argument: found \"=none\", " + form},
        {"sorting=", "--axis: argument: found \"sorting=\", " + form},
        {"sorting=none,", "--axis: argument.sorting: found \"\", allowed: " + test::choice_names("sorting")},
        {"sorting=,none", "--axis: argument.sorting: found \"\", allowed: " + test::choice_names("sorting")},
        {"sorting=quick", "--axis: argument.sorting: found \"quick\", allowed: " + test::choice_names("sorting")},
        {"sorting=all,none", "--axis: argument.sorting: found \"all\", allowed: " + test::choice_names("sorting")},
        {"sorting=none,none", "--axis: argument.sorting: found \"none\" twice, allowed: once"},
        {"compaction=thrust_remove_if",
         "--axis: argument: found compaction twice, allowed: once, with commas between its choices"},
        {"compactoin=none",
         "--axis: argument: found axis \"compactoin\", allowed: " + known_axes + " (did you mean \"compaction\"?)"},
        {"sorting=nonne", "--axis: argument.sorting: found \"nonne\", allowed: " + test::choice_names("sorting") +
                              " (did you mean \"none\"?)"},
        {"colour=red", "--axis: argument: found axis \"colour\", allowed: " + known_axes},
        {"colour=all", "--axis: argument: found axis \"colour\", allowed: " + known_axes},
    };
    const AxisChoices before = axes;
    for (const auto& [argument, message] : cases) {
        EXPECT_EQ(refusal([&, text = argument] { add_axis_argument(axes, text); }), message);
        EXPECT_EQ(axes, before);
    }
    // What only the other backend has is no error here; "all" is what the backend has.
    add_axis_argument(axes, "launch=stream,graph");
    EXPECT_EQ(axes.at("launch"), (std::vector<std::string>{"stream", "graph"}));
    add_axis_argument(axes, "arithmetic=all");
    EXPECT_EQ(axes.at("arithmetic"), std::vector<std::string>{"exact"});
    AxisChoices on_gpu;
    add_axis_argument(on_gpu, "arithmetic=all", Backend::cuda);
    EXPECT_EQ(on_gpu.at("arithmetic"), (std::vector<std::string>{"precise", "exact", "fast"}));
}

TEST_F(SuiteTest, ABackendMayHaveItsOwnSizes) {
    const Suite sized = load_studies(R"({"name": "a", "scenes": ["still"], "axes": {"integrator": ["wavefront"]},
        "resolution": {"cpu": [5, 6], "cuda": [[7, 8], [9, 10]]}})");
    const Plan small = make_plan(sized);
    ASSERT_EQ(small.cells.size(), 1u);
    EXPECT_EQ(small.cells[0].settings.width, 5u);
    EXPECT_EQ(small.cells[0].settings.height, 6u);
    if (test::cuda_is_built()) {
        EXPECT_EQ(make_plan(sized, Backend::cuda).cells.size(), 2u);
    }
}

// ---- What is shipped ----

// Studies that have a cell on a backend.
std::set<std::string> studies_with_cells(const Suite& suite, Backend backend) {
    std::set<std::string> studies;
    for (const Cell& cell : make_plan(suite, backend).cells) {
        studies.insert(cell.studies.begin(), cell.studies.end());
    }
    return studies;
}

class ShippedSuitesTest : public testing::Test {
protected:
    void SetUp() override { ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1); }
    void TearDown() override { ::unsetenv("PTBENCH_HOME"); }
};

TEST_F(ShippedSuitesTest, LoadAndPlan) {
    const std::vector<std::string> names = suite_names();
    for (const char* name : {"quick", "cis565"}) {
        EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
    }
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const Suite suite = load_suite(find_suite_file(name));
        EXPECT_EQ(suite.name, name);
        EXPECT_FALSE(suite.description.empty());
        // Fewer samples allow no verdict; errors have more than one number a sample.
        const bool has_times = std::any_of(suite.studies.begin(), suite.studies.end(),
                                           [](const Study& study) { return !study.convergence; });
        EXPECT_GE(suite.repetitions, has_times ? 9 : 8);
        std::set<std::string> studies = studies_with_cells(suite, Backend::cpu);
        if (test::cuda_is_built()) {
            const std::set<std::string> on_cuda = studies_with_cells(suite, Backend::cuda);
            EXPECT_FALSE(on_cuda.empty());
            studies.insert(on_cuda.begin(), on_cuda.end());
            // A study is for one backend at least, and a suite too: memory's speed is a GPU's alone.
            for (const Study& study : suite.studies) {
                EXPECT_TRUE(studies.contains(study.name)) << study.name;
            }
        }
    }
}

// A render of fewer samples than a queue may hold in flight would measure a shorter queue.
TEST_F(ShippedSuitesTest, APassportFillsItsQueues) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "this build has no CUDA backend";
    }
    const Suite suite = load_suite(find_suite_file("passport"));
    std::set<std::uint32_t> least;
    for (const Study& study : suite.studies) {
        least.insert(least_samples(make_plan({.name = "one", .description = "", .studies = {study}}, Backend::cuda)));
    }
    EXPECT_EQ(least, (std::set<std::uint32_t>{1, 4}));
}

// The three graphs of cis565 and their compactions, on the CPU too.
TEST_F(ShippedSuitesTest, QuickAndCis565DrawTheGraphsOfCis565) {
    for (const char* name : {"quick", "cis565"}) {
        SCOPED_TRACE(name);
        const Suite suite = load_suite(find_suite_file(name));
        const std::set<std::string> studies = studies_with_cells(suite, Backend::cpu);
        std::set<std::string> compared;
        for (const Study& study : suite.studies) {
            if (studies.contains(study.name)) {
                compared.insert(study.compares + "/" + study.along);
            }
        }
        for (const char* what : {"live_paths/", "sorting/depth", "first_bounce/depth", "compaction/"}) {
            EXPECT_TRUE(compared.contains(what)) << what;
        }
    }
}

}  // namespace
}  // namespace pt
