// Standard streams that are closed or full. What is to be said on stderr is lost, and nothing else is: exit codes and
// files are as ever. What goes to stdout is a result, so there it is an error.
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;

// Runs ptbench as a shell calls it with `redirection`.
CommandResult ptbench_with(const std::string& redirection, const Arguments& arguments, const TemporaryFolder& folder) {
    Arguments call{"/bin/sh", "-c", "exec \"$0\" \"$@\" " + redirection, program_file()};
    call.insert(call.end(), arguments.begin(), arguments.end());
    return run_command(call, in_repository({.folder = folder.path()}));
}

const Arguments tiny_run{
    "run",   "--scene", "cornell_open",  "--backend", "cpu",   "--axis",     "layout=aos,soa", "--resolution", "4x3",
    "--spp", "1",       "--repetitions", "2",         "--out", "result.json"};

class StderrTest : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Kinds, StderrTest, testing::Values("2>&-", "2>/dev/full"),
                         [](const auto& kind) { return kind.param == "2>&-" ? "Closed" : "Full"; });

TEST_P(StderrTest, AnErrorHasItsExitCode) {
    const TemporaryFolder folder;
    for (const Arguments& wrong :
         {Arguments{"render", "--scene", "nosuch", "--out", "a.png"}, Arguments{"list", "--frob"}, Arguments{}}) {
        EXPECT_EQ(ptbench_with(GetParam(), wrong, folder).exit_code, 2);
    }
    EXPECT_EQ(folder.content(), Arguments());
}

TEST_P(StderrTest, AWarningEndsNoImport) {
    const TemporaryFolder folder;
    write_text(folder.file("box.txt"), with_material("RGB 0.5 0.5 0.5\nSPECEX 25\nREFL 1\n"));
    const CommandResult with_words = ptbench_with("", {"import", "box.txt", "--out", "as_ever.json"}, folder);
    ASSERT_EQ(with_words.exit_code, 0) << with_words.err;
    ASSERT_NE(with_words.err, "");
    const CommandResult result = ptbench_with(GetParam(), {"import", "box.txt", "--out", "scene.json"}, folder);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(content_of(folder.file("scene.json")), content_of(folder.file("as_ever.json")));
}

TEST_P(StderrTest, ARunGoesOnWithoutItsProgress) {
    const TemporaryFolder folder;
    const CommandResult result = ptbench_with(GetParam(), tiny_run, folder);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(folder.content(), Arguments({"result.json"}));
    // No line of progress stands in a file that was opened in stderr's place.
    const auto json = nlohmann::json::parse(content_of(folder.file("result.json")));
    EXPECT_EQ(json.at("context").at("ptbench.status"), "completed");
    EXPECT_NE(result.out.find("result.json"), std::string::npos) << result.out;
}

// What else prints there ends the program where nobody takes it (fmt::print throws).
TEST(StderrLinesTest, AllGoThroughSay) {
    const std::regex other_way("std::cerr|std::clog|perror\\(|(print|printf|puts|putc|flush)\\([^;]*\\bstderr\\b");
    for (const char* const folder : {"harness", "stability", "variants", "kernels"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(source_folder() + "/" + folder)) {
            if (entry.is_regular_file()) {
                EXPECT_FALSE(std::regex_search(content_of(entry.path()), other_way)) << entry.path();
            }
        }
    }
}

class StdoutTest : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Kinds, StdoutTest, testing::Values(">&-", ">/dev/full"),
                         [](const auto& kind) { return kind.param == ">&-" ? "Closed" : "Full"; });

TEST_P(StdoutTest, IsTheMachinesFault) {
    const TemporaryFolder folder;
    for (const Arguments& call : {Arguments{"list", "layout"}, Arguments{"machine"}}) {
        const CommandResult result = ptbench_with(GetParam(), call, folder);
        EXPECT_EQ(result.exit_code, 3);
        EXPECT_EQ(result.err.find("ptbench: standard output: cannot be written"), 0u) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    EXPECT_EQ(folder.content(), Arguments());
}

TEST_P(StdoutTest, LeavesNoTableInTheResult) {
    const TemporaryFolder folder;
    EXPECT_EQ(ptbench_with(GetParam(), tiny_run, folder).exit_code, 3);
    EXPECT_EQ(nlohmann::json::parse(content_of(folder.file("result.json"))).at("context").at("ptbench.status"),
              "completed");
}

}  // namespace
}  // namespace pt::test
