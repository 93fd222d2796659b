// `new` as a user calls it: what it writes, what it refuses, and that it never leaves a part of it behind.
#include <gtest/gtest.h>

#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* axis_folder = "harness/templates/compaction";
constexpr const char* integrator_folder = "harness/templates/integrator";

// What of the repository the command looks at.
class NewCommandTest : public testing::Test {
protected:
    const TemporaryFolder home;

    void SetUp() override {
        for (const char* folder : {"scenes/suites", "variants/compaction", "variants/integrator", "tests/unit",
                                   "tests/image", axis_folder, integrator_folder}) {
            fs::create_directories(home.path() / folder);
        }
        for (const char* file : {"choice.cpp.in", "choice.cuh.in", "test.cpp.in"}) {
            fs::copy_file(fs::path(test::source_folder()) / axis_folder / file, home.path() / axis_folder / file);
        }
        for (const auto& entry : fs::directory_iterator(fs::path(test::source_folder()) / integrator_folder)) {
            fs::copy_file(entry.path(), home.path() / integrator_folder / entry.path().filename());
        }
        for (const char* folder : {"kernels/shapes", "kernels/materials", "harness/scene/materials",
                                   "harness/templates/shape", "harness/templates/material"}) {
            fs::create_directories(home.path() / folder);
        }
        for (const char* file :
             {"kernels/shape_list.h", "harness/templates/shape/shape.h.in", "harness/templates/shape/test.cpp.in",
              "kernels/material_list.h", "harness/templates/material/material.h.in",
              "harness/templates/material/kind.cpp.in", "harness/templates/material/test.cpp.in"}) {
            fs::copy_file(fs::path(test::source_folder()) / file, home.path() / file);
        }
    }
    CommandResult call(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "new");
        return ptbench(arguments, {.folder = home.path(), .environment = {{"PTBENCH_HOME", home.path()}}});
    }
    void expect_refusal(const std::vector<std::string>& arguments, const std::string& message,
                        int exit_code = 2) const {
        SCOPED_TRACE(message);
        const std::vector<std::string> before = home.content();
        const CommandResult result = call(arguments);
        EXPECT_EQ(result.exit_code, exit_code);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(result.err, "ptbench: " + message + "\n");
        EXPECT_EQ(home.content(), before);
    }
    std::string filled(const std::string& source, const std::string& name) const {
        std::string text = content_of(home.file(std::string(axis_folder) + "/" + source));
        for (std::size_t at = 0; (at = text.find("@NAME@", at)) != std::string::npos;) {
            text.replace(at, 6, name);
        }
        return text;
    }
};

TEST_F(NewCommandTest, WritesTheTemplatesUnderTheName) {
    const std::vector<std::string> before = home.content();
    const CommandResult result = call({"compaction", "my_scan2"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    std::vector<std::string> expected = before;
    for (const auto& [file, source] : {std::pair{"variants/compaction/my_scan2.cpp", "choice.cpp.in"},
                                       std::pair{"variants/compaction/my_scan2.cuh", "choice.cuh.in"},
                                       std::pair{"tests/unit/my_scan2_compaction_test.cpp", "test.cpp.in"}}) {
        // The text is as CMake fills it in for the test that compiles it.
        EXPECT_EQ(content_of(home.file(file)), filled(source, "my_scan2"));
        EXPECT_NE(content_of(home.file(file)).find("my_scan2"), std::string::npos);
        EXPECT_EQ(content_of(home.file(file)).find('@'), std::string::npos);
        EXPECT_NE(result.out.find(home.file(file) + "  "), std::string::npos) << result.out;
        expected.emplace_back(file);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(home.content(), expected);
    for (const char* next :
         {"./run build my_scan2_compaction_test && build/tests/my_scan2_compaction_test\n",
          "build/ptbench verify --scene cornell_open --axis compaction=my_scan2 --quiet\n",
          "build/ptbench inspect --scene cornell_open --axis compaction=my_scan2 --arch sm_90, which compiles its CUDA "
          "kernels without a GPU\n",
          "build/ptbench run --scene cornell_open,cornell_closed --axis compaction=none,my_scan2\n"}) {
        EXPECT_NE(result.out.find(next), std::string::npos) << result.out;
    }
    EXPECT_EQ(call({"compaction", "my_scan3"}).exit_code, 0);  // beside the first
}

TEST_F(NewCommandTest, WritesAnIntegratorUnderItsName) {
    std::vector<std::string> expected = home.content();
    const CommandResult result = call({"integrator", "my_tiles"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    for (const char* file : {"variants/integrator/my_tiles.h", "variants/integrator/my_tiles.cuh",
                             "tests/unit/my_tiles_integrator_test.cpp"}) {
        EXPECT_NE(content_of(home.file(file)).find("my_tiles"), std::string::npos) << file;
        EXPECT_EQ(content_of(home.file(file)).find('@'), std::string::npos) << file;
        EXPECT_NE(result.out.find(home.file(file) + "  "), std::string::npos) << result.out;
        expected.emplace_back(file);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(home.content(), expected);
    EXPECT_NE(result.out.find("--axis integrator=wavefront,my_tiles\n"), std::string::npos) << result.out;
    expect_refusal({"integrator", "depth_first"},
                   "new: NAME: found \"depth_first\", allowed: a name that is not taken: depth_first is a choice of "
                   "integrator (see ptbench list)");
}

TEST_F(NewCommandTest, AShapeIsAHeaderAndALineOfTheList) {
    const std::string before = content_of(home.file("kernels/shape_list.h"));
    std::vector<std::string> expected = home.content();
    const CommandResult result = call({"shape", "my_ball2"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    for (const char* file : {"kernels/shapes/my_ball2.h", "tests/unit/my_ball2_shape_test.cpp"}) {
        EXPECT_NE(content_of(home.file(file)).find("MyBall2Shape"), std::string::npos);
        EXPECT_EQ(content_of(home.file(file)).find('@'), std::string::npos);
        EXPECT_NE(result.out.find(home.file(file) + "  "), std::string::npos) << result.out;
        expected.emplace_back(file);
    }
    EXPECT_NE(result.out.find(home.file("kernels/shape_list.h") + "  "), std::string::npos) << result.out;
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(home.content(), expected);
    // A line after the last, and a second after that; but for these and their backslashes the list is what it was.
    ASSERT_EQ(call({"shape", "a_ball_of_rather_a_long_name"}).exit_code, 0);
    const std::string list = content_of(home.file("kernels/shape_list.h"));
    const std::size_t last = before.find(", more)\n\n") + 7;
    EXPECT_EQ(list.substr(0, last), before.substr(0, last));
    const std::string end = before.substr(last);
    EXPECT_EQ(list.substr(list.size() - end.size()), end);
    std::string added = list.substr(last, list.size() - end.size() - last);
    added.erase(std::remove(added.begin(), added.end(), ' '), added.end());
    EXPECT_EQ(added,
              "\\\nSHAPE(my_ball2,my_ball2s,MyBall2Shape,MY_BALL2S,more)\\\n"
              "SHAPE(a_ball_of_rather_a_long_name,a_ball_of_rather_a_long_names,ABallOfRatherALongNameShape,"
              "A_BALL_OF_RATHER_A_LONG_NAMES,more)");
    EXPECT_NE(call({"shape", "my_ball2"}).exit_code, 0);
}

TEST_F(NewCommandTest, AMaterialIsTwoFilesAndALineOfTheList) {
    const std::string before = content_of(home.file("kernels/material_list.h"));
    std::vector<std::string> expected = home.content();
    const CommandResult result = call({"material", "my_velvet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    for (const char* file : {"kernels/materials/my_velvet.h", "harness/scene/materials/my_velvet.cpp",
                             "tests/unit/my_velvet_material_test.cpp"}) {
        EXPECT_NE(content_of(home.file(file)).find("MyVelvetMaterial"), std::string::npos);
        EXPECT_EQ(content_of(home.file(file)).find('@'), std::string::npos);
        EXPECT_NE(result.out.find(home.file(file) + "  "), std::string::npos) << result.out;
        expected.emplace_back(file);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(home.content(), expected);
    const std::string list = content_of(home.file("kernels/material_list.h"));
    const std::size_t last = before.find(")\n\n#define PT_MATERIAL_TYPE") + 1;
    EXPECT_EQ(list.substr(0, last), before.substr(0, last));
    const std::string end = before.substr(last);
    EXPECT_EQ(list.substr(list.size() - end.size()), end);
    std::string added = list.substr(last, list.size() - end.size() - last);
    added.erase(std::remove(added.begin(), added.end(), ' '), added.end());
    EXPECT_EQ(added, "\\\nMATERIAL(my_velvet,MyVelvetMaterial,is_delta)");
    expect_refusal({"material", "mirror"},
                   "new: NAME: found \"mirror\", allowed: a name that is not taken: mirror is a feature of kernels");
}

TEST_F(NewCommandTest, RefusesAShapeThatWouldHideSomethingElse) {
    const auto taken = [](const std::string& name, const std::string& by) {
        return "new: NAME: found \"" + name + "\", allowed: a name that is not taken: " + by;
    };
    expect_refusal({"shape", "quad"}, taken("quad", "quad is a feature of kernels"));
    expect_refusal({"shape", "motion"}, taken("motion", "motion is a feature of kernels"));
    expect_refusal({"shape", "light"}, taken("light", "lights is an array of scenes"));
    write_text(home.file("kernels/shapes/mine.h"), "mine");
    expect_refusal({"shape", "mine"}, taken("mine", "there is a file " + home.file("kernels/shapes/mine.h")));
    write_text(home.file("kernels/shape_list.h"), "// no list\n");
    expect_refusal({"shape", "my_ball"},
                   "new: file: found kernels/shape_list.h, allowed: a list of lines SHAPE(..., more)");
}

TEST_F(NewCommandTest, RefusesWhatIsNoName) {
    for (const std::string name : {"", "MyScan", "2scan", "my-scan", "_scan", "scan_", "my__scan", "my scan", "../scan",
                                   "scan.cpp", "sc\xc3\xa4n", "a23456789_123456789_123456789_123"}) {
        expect_refusal(
            {"compaction", name},
            "new: NAME: found \"" + name + "\", allowed: lower_snake_case of at most 32 characters, e.g. my_scan");
    }
    for (const std::string name : {"template", "class", "co_await", "static_assert", "xor_eq", "std", "all", "errno"}) {
        expect_refusal({"compaction", name},
                       "new: NAME: found \"" + name + "\", allowed: a name that is no word of C++ or of ptbench");
    }
}

TEST_F(NewCommandTest, RefusesANameThatIsTaken) {
    const auto choice = [](const std::string& name) {
        return "new: NAME: found \"" + name + "\", allowed: a name that is not taken: " + name +
               " is a choice of compaction (see ptbench list)";
    };
    expect_refusal({"compaction", "none"}, choice("none"));
    expect_refusal({"compaction", "thrust_partition"}, choice("thrust_partition"));
    const auto file = [&](const std::string& name, const std::string& path) {
        return "new: NAME: found \"" + name + "\", allowed: a name that is not taken: there is a file " +
               home.file(path);
    };
    // Not built, or not here: a file is enough.
    write_text(home.file("variants/compaction/my_scan.cu"), "mine");
    expect_refusal({"compaction", "my_scan"}, file("my_scan", "variants/compaction/my_scan.cu"));
    // Two test programs cannot have one name.
    write_text(home.file("tests/image/other_compaction_test.cpp"), "mine");
    expect_refusal({"compaction", "other"}, file("other", "tests/image/other_compaction_test.cpp"));
    ASSERT_EQ(call({"compaction", "twice"}).exit_code, 0);
    EXPECT_EQ(call({"compaction", "twice"}).exit_code, 2);
}

TEST_F(NewCommandTest, RefusesWhatHasNoTemplates) {
    for (const std::string kind : {"sorting", "scene", "frob", ""}) {
        expect_refusal({kind, "my_own"},
                       "new: KIND: found \"" + kind + "\", allowed: compaction, integrator, shape, material");
    }
    expect_refusal({}, "KIND is required (see ptbench --help)");
    expect_refusal({"compaction"}, "NAME is required (see ptbench --help)");
}

TEST_F(NewCommandTest, APackageHasNoSources) {
    fs::remove_all(home.path() / "harness");
    expect_refusal(
        {"compaction", "my_scan"},
        "new: folder: found no harness/templates/compaction in " + home.path().string() +
            ", allowed: a checkout of the repository (a package has no sources that a choice could be added to)");
}

TEST_F(NewCommandTest, ATemplateThatIsMissingLeavesNothing) {
    fs::remove(home.path() / axis_folder / "test.cpp.in");
    expect_refusal({"compaction", "my_scan"},
                   home.file(std::string(axis_folder) + "/test.cpp.in") +
                       ": the file: found no such file, allowed: a regular file of at most 64 MiB that can be read");
}

// The last of the files is longer than the process may write: the first ones go again.
TEST_F(NewCommandTest, AFileThatCannotBeWrittenLeavesNothing) {
    const std::string large(1 << 20, 'x');
    write_text(home.file(std::string(axis_folder) + "/test.cpp.in"), large);
    const std::vector<std::string> before = home.content();
    const CommandResult result =
        run_command({"/bin/sh", "-c", "ulimit -f 512; exec \"$0\" new compaction my_scan", test::program_file()},
                    {.folder = home.path(), .environment = {{"PTBENCH_HOME", home.path()}}});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_EQ(result.err, "ptbench: " + home.file("tests/unit/my_scan_compaction_test.cpp") +
                              ": cannot be written: File too large\n");
    EXPECT_EQ(home.content(), before);
}

}  // namespace
}  // namespace pt::test
