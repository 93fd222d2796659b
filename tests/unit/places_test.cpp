// Tests where scenes and suites are looked for.
#include "harness/scene/places.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

constexpr const char* tiny_scene = R"({
  "name": "tiny", "max_depth": 2, "environment": [1, 1, 1],
  "camera": {"eye": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [4, 3]},
  "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
  "objects": [{"shape": "sphere", "material": "white", "translate": [0, 0, 3]}]
})";

// A home of its own, with two scenes and one suite.
class PlacesTest : public testing::Test {
protected:
    test::TemporaryFolder folder;

    void SetUp() override {
        std::filesystem::create_directories(folder.path() / "scenes" / "suites");
        test::write_text(folder.file("scenes/tiny.json"), tiny_scene);
        test::write_text(folder.file("scenes/a.json"), tiny_scene);
        test::write_text(folder.file("scenes/notes.txt"), "no scene");
        test::write_text(folder.file("scenes/suites/small.json"), "{}");
        ::setenv("PTBENCH_HOME", folder.path().c_str(), 1);
    }
    void TearDown() override { ::unsetenv("PTBENCH_HOME"); }

    template <class Call>
    static std::string refusal(Call call) {
        try {
            call();
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
};

TEST_F(PlacesTest, ListsScenesAndSuitesByName) {
    EXPECT_EQ(home_folder(), folder.path());
    EXPECT_EQ(scene_names(), (std::vector<std::string>{"a", "tiny"}));
    EXPECT_EQ(suite_names(), (std::vector<std::string>{"small"}));
}

TEST_F(PlacesTest, FindsAShippedSceneByNameAndAnyFileByItsPath) {
    EXPECT_EQ(find_scene("tiny").name, "tiny");
    test::write_text(folder.file("elsewhere.json"), tiny_scene);
    EXPECT_EQ(find_scene(folder.file("elsewhere.json")).name, "tiny");
    EXPECT_EQ(find_suite_file("small"), folder.file("scenes/suites/small.json"));
    EXPECT_EQ(find_suite_file("other.json"), "other.json");
}

TEST_F(PlacesTest, SaysWhichNamesThereAre) {
    for (const std::string name :
         {"nope", "", "suites", "suites/none", "../scenes/tiny", "suites/../tiny", "notes.txt"}) {
        EXPECT_EQ(refusal([&] { find_scene(name); }),
                  "--scene: name: found \"" + name + "\", allowed: a file that ends in .json, or one of a, tiny");
    }
    EXPECT_EQ(refusal([] { find_suite_file("nope"); }),
              "--suite: name: found \"nope\", allowed: a file that ends in .json, or one of small");
    EXPECT_EQ(refusal([] { find_scene("missing.json"); }),
              "missing.json: the file: found no such file, allowed: a regular file of at most 64 MiB that can be read");
}

// A group of scenes lies in a folder of its own; it is not listed with the others.
TEST_F(PlacesTest, FindsASceneInAFolderOfScenes) {
    std::filesystem::create_directories(folder.path() / "scenes" / "group");
    test::write_text(folder.file("scenes/group/inner.json"), tiny_scene);
    test::write_text(folder.file("outside.json"), tiny_scene);
    EXPECT_EQ(find_scene("group/inner").name, "tiny");
    EXPECT_EQ(scene_names(), (std::vector<std::string>{"a", "tiny"}));
    for (const std::string& name : std::vector<std::string>{"group", "group/", "group/none", "../outside",
                                                            "group/../../outside", folder.file("outside")}) {
        EXPECT_EQ(refusal([&] { find_scene(name); }),
                  "--scene: name: found \"" + name + "\", allowed: a file that ends in .json, or one of a, tiny");
    }
    // A suite is no scene.
    const std::string file = folder.file("scenes/suites/small.json");
    EXPECT_EQ(refusal([] { find_scene("suites/small"); }).find(file + ": $: found no key "), 0u);
}

TEST_F(PlacesTest, AHomeWithoutScenesIsAnError) {
    const test::TemporaryFolder empty;
    ::setenv("PTBENCH_HOME", empty.path().c_str(), 1);
    EXPECT_EQ(refusal([] { home_folder(); }),
              "no folder scenes/ in " + empty.path().string() + ": set PTBENCH_HOME to the folder that holds it");
}

TEST_F(PlacesTest, EveryShippedSceneIsNamedAsItsFile) {
    ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
    ASSERT_GE(scene_names().size(), 20u);
    for (const std::string& name : scene_names()) {
        EXPECT_EQ(find_scene(name).name, name);
    }
}

}  // namespace
}  // namespace pt
