// `list` as a user calls it: what there is, what applies where, and what a kernel leaves out.
#include <algorithm>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using nlohmann::json;

std::vector<std::string> names_in(const json& array) {
    std::vector<std::string> names;
    for (const json& element : array) {
        names.push_back(element.at("name"));
    }
    return names;
}

void expect_same_backends(const std::string& axis, const json& choice) {
    json expected = json::array();
    for (const Backend backend : all_backends) {
        if (Registry::instance().find(axis, choice.at("name").get<std::string>(), backend) != nullptr) {
            expected.push_back(to_string(backend));
        }
    }
    EXPECT_EQ(choice.at("backends"), expected) << axis << "=" << choice.at("name");
    EXPECT_FALSE(expected.empty());
}

// Python and the schemas read from the committed file what the program says.
void expect_committed(const std::string& topic) {
    const CommandResult result = ptbench({"list", topic, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, content_of(in_source("analysis/ptbench/io/" + topic + ".json"))) << "./run lists";
}

TEST(ListTest, FeaturesAreThoseOfTheFileThatPythonReads) {
    expect_committed("features");
    const std::string text = ptbench({"list", "features"}).out;
    for (const std::string& name : feature_names(~no_features)) {
        EXPECT_NE(text.find("\n  " + name + "\n"), std::string::npos) << name;
    }
}

TEST(ListTest, AxesAreThoseOfTheFileThatPythonReads) {
    expect_committed("axes");
    const std::string text = ptbench({"list", "axes"}).out;
    for (const std::string_view axis : axis_names) {
        EXPECT_NE(text.find("\n  " + std::string(axis) + " "), std::string::npos) << axis;
    }
}

TEST(ListTest, JsonHasAxesScenesSuitesAndBackends) {
    const CommandResult result = ptbench({"list", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const json all = json::parse(result.out);
    EXPECT_EQ(names_in(all.at("axes")), std::vector<std::string>(std::begin(axis_names), std::end(axis_names)));
    for (const json& axis : all.at("axes")) {
        EXPECT_TRUE(axis.at("choices").at(0).at("baseline").get<bool>());
        std::set<std::string> baseline_on;
        for (const json& choice : axis.at("choices")) {
            for (const char* key : {"name", "summary", "origin", "claim", "claim_note"}) {
                EXPECT_TRUE(choice.at(key).is_string());
            }
            expect_same_backends(axis.at("name"), choice);
            EXPECT_EQ(choice.at("baseline").get<bool>(), !choice.at("baseline_on").empty());
            for (const json& backend : choice.at("baseline_on")) {
                EXPECT_TRUE(baseline_on.insert(backend).second) << axis.at("name");
            }
        }
        EXPECT_TRUE(baseline_on.contains("cpu"));
        EXPECT_TRUE(baseline_on.contains("cuda") || !cuda_is_built());
        const std::vector<std::string> names = names_in(axis.at("choices"));
        EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    }
    const std::vector<std::string> scenes = names_in(all.at("scenes"));
    EXPECT_GE(scenes.size(), 20u);
    EXPECT_TRUE(std::is_sorted(scenes.begin(), scenes.end()));
    for (const json& scene : all.at("scenes")) {
        EXPECT_EQ(scene.at("hash").get<std::string>().size(), 16u);
        EXPECT_FALSE(scene.at("features").empty());
        const bool jitter = scene.at("features").dump().find("\"jitter\"") != std::string::npos;
        EXPECT_EQ(scene.at("not_applicable").contains("first_bounce=cached"), jitter) << scene.at("name");
        const json& by_backend = scene.at("not_applicable_on");
        EXPECT_EQ(by_backend.at("cpu"), scene.at("not_applicable"));
        EXPECT_EQ(by_backend.contains("cuda"), cuda_is_built());
        for (const json& reasons : by_backend) {
            EXPECT_EQ(reasons.contains("first_bounce=cached"), jitter) << scene.at("name");
        }
        if (cuda_is_built()) {
            EXPECT_EQ(by_backend.at("cuda").at("sort_key=ray"), "sort_key=ray needs a sort, not sorting=none");
        }
    }
    const std::vector<std::string> suites = names_in(all.at("suites"));
    EXPECT_NE(std::find(suites.begin(), suites.end(), "quick"), suites.end());
    EXPECT_NE(std::find(suites.begin(), suites.end(), "cis565"), suites.end());
    EXPECT_EQ(names_in(all.at("backends")), (std::vector<std::string>{"cpu", "cuda"}));
    EXPECT_EQ(all.at("backends").at(0).at("status"), "available");
    const std::string cuda = all.at("backends").at(1).at("status");
    EXPECT_EQ(cuda.find("not available ("), 0u) << cuda;
    EXPECT_TRUE(cuda.size() > std::string("not available ()").size() && cuda.ends_with(")")) << cuda;
}

TEST(ListTest, JsonHasTheTunablesOfEveryChoice) {
    const json all = json::parse(ptbench({"list", "--scene", "cornell_open", "--json"}).out);
    std::set<std::string> names;
    for (const json& axis : all.at("axes")) {
        for (const json& choice : axis.at("choices")) {
            for (const json& tunable : choice.at("tunables")) {
                names.insert(tunable.at("name"));
                EXPECT_TRUE(tunable.at("summary").is_string());
                EXPECT_LE(tunable.at("lowest"), tunable.at("default_value"));
                EXPECT_LE(tunable.at("default_value"), tunable.at("highest"));
                EXPECT_GE(tunable.at("multiple_of"), 1);
            }
            if (choice.at("name") == "cached_jitters") {
                EXPECT_EQ(choice.at("claim"), "biased");
                EXPECT_EQ(choice.at("backends"), json({"cpu", "cuda"}));
                ASSERT_EQ(choice.at("tunables").size(), 1u);
                EXPECT_EQ(choice.at("tunables")[0], json({{"name", "jitters"},
                                                          {"default_value", 16},
                                                          {"lowest", 1},
                                                          {"highest", 4096},
                                                          {"multiple_of", 1},
                                                          {"summary", "camera rays of a pixel that are kept (K)"}}));
            }
        }
    }
    std::string joined;
    for (const std::string& name : names) {
        joined += (joined.empty() ? "" : ", ") + name;
    }
    EXPECT_EQ(joined, tunable_names());
}

TEST(ListTest, JsonSaysWhatAKernelOfASceneLeavesOut) {
    const json list = json::parse(ptbench({"list", "--json"}).out);
    for (const json& scene : list.at("scenes")) {
        std::multiset<std::string> all;
        for (const char* part : {"features", "left_out"}) {
            const std::vector<std::string> names = scene.at(part);
            all.insert(names.begin(), names.end());
        }
        const std::vector<std::string> known = feature_names(all_features);
        EXPECT_EQ(all, std::multiset<std::string>(known.begin(), known.end())) << scene.at("name");
        EXPECT_FALSE(scene.contains("kernels")) << "nothing is compiled unless asked for";
    }
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

// Names as words: each stands there, on a line of its axis's own.
TEST(ListTest, IsOneScreen) {
    const CommandResult result = ptbench({"list"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::vector<std::string> lines = lines_of(result.out);
    EXPECT_LE(lines.size(), 40u) << result.out;
    const json all = json::parse(ptbench({"list", "--json"}).out);
    for (std::size_t i = 0; i < all.at("axes").size(); ++i) {
        std::istringstream words(lines.at(1 + i));
        std::vector<std::string> found;
        for (std::string word; words >> word;) {
            found.push_back(word.substr(0, word.find_first_of("*'")));
        }
        std::vector<std::string> expected{all.at("axes")[i].at("name")};
        for (const std::string& name : names_in(all.at("axes")[i].at("choices"))) {
            expected.push_back(name);
        }
        EXPECT_EQ(found, expected);
    }
    for (const char* kind : {"scenes", "suites", "backends"}) {
        for (const std::string& name : names_in(all.at(kind))) {
            EXPECT_NE((result.out + " ").find(" " + name), std::string::npos) << name;
        }
    }
    // Without a toolkit a choice of CUDA's is known by the name of its file, so what both have is marked only with one.
    EXPECT_EQ(result.out.find(" packet' ") != std::string::npos, cuda_is_built()) << result.out;
    EXPECT_EQ(result.out.find(" megakernel* ") != std::string::npos, cuda_is_built());
}

TEST(ListTest, AnAxisInFull) {
    const CommandResult result = ptbench({"list", "first_bounce"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string backends = "cpu, cuda";  // also of a program that was built without a toolkit
    for (const std::string& text :
         {std::string("first_bounce: whether first hits are kept and used again\n"),
          "  off  (" + backends +
              ")  the baseline\n    every sample traces its camera ray\n    origin: cis565, cache off\n",
          std::string("    claim: bitwise\n"), "  cached_jitters  (" + backends + ")\n",
          std::string(
              "    claim: biased: pixel, lens and shutter are sampled at K points, however many samples are taken\n"
              "    tunable jitters=16 (1 to 4096): camera rays of a pixel that are kept (K)\n")}) {
        EXPECT_NE(result.out.find(text), std::string::npos) << text << result.out;
    }
    EXPECT_EQ(json::parse(ptbench({"list", "first_bounce", "--json"}).out),
              json::parse(ptbench({"list", "--json"}).out).at("axes").at(Variant::index("first_bounce")));
}

// A choice that is a baseline on one backend alone says on which.
TEST(ListTest, ABaselineOfOneBackendSaysSo) {
    const std::string precise = "  precise  (cuda)  the baseline\n",
                      exact = "  exact  (cpu, cuda)  the baseline on cpu\n";
    const std::string listed = ptbench({"list", "arithmetic"}).out;
    EXPECT_TRUE(listed.find(precise) != std::string::npos && listed.find(exact) != std::string::npos) << listed;
}

TEST(ListTest, ScenesAndSuitesInFull) {
    EXPECT_NE(ptbench({"list", "scenes"}).out.find("\n  cornell_open  "), std::string::npos);
    EXPECT_NE(ptbench({"list", "suites"}).out.find("\n  quick            Under 4 minutes"), std::string::npos);
    EXPECT_EQ(names_in(json::parse(ptbench({"list", "suites", "--json"}).out)),
              lines_of(ptbench({"list", "--names", "suites"}).out));
}

TEST(ListTest, ASceneSaysWhatAppliesToIt) {
    const CommandResult result = ptbench({"list", "--scene", "cornell_open"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    for (const char* text :
         {"Scenes\n", "  cornell_open ", "   needs sphere axis_box diffuse emitter mirror jitter\n",
          "   leaves out ellipsoid oriented_box quad motion mix dielectric rough_conductor "
          "rough_dielectric principled subsurface emission absorption subsurface_boundary multiple_scattering "
          "environment lens final_bounce next_event multiple_importance area_sampling projected_sampling "
          "automatic_sampling power_selection "
          "tree_selection one_sample environment_map russian_roulette adjoint_roulette near_sphere textures "
          "shading_normals\n",
          "   n/a: first_bounce=cached needs jitter off (camera.jitter is true in the scene)\n", "Backends\n", "  cpu ",
          "  cuda                       not available ("}) {
        EXPECT_NE(result.out.find(text), std::string::npos) << text;
    }
    EXPECT_EQ(result.out.find("cornell_closed"), std::string::npos);
}

TEST(ListTest, NamesStandAloneOneALine) {
    const json all = json::parse(ptbench({"list", "--json"}).out);
    const auto names = [](const std::string& what) { return lines_of(ptbench({"list", "--names", what}).out); };
    for (const char* kind : {"axes", "scenes", "suites", "backends"}) {
        EXPECT_EQ(names(kind), names_in(all.at(kind)));
    }
    for (const json& axis : all.at("axes")) {
        EXPECT_EQ(names(axis.at("name")), names_in(axis.at("choices")));
    }
    const std::vector<std::string> tunables = names("tunables"), commands = names("commands");
    EXPECT_NE(std::find(tunables.begin(), tunables.end(), "jitters"), tunables.end());
    EXPECT_NE(std::find(commands.begin(), commands.end(), "render"), commands.end());
}

}  // namespace
}  // namespace pt::test
