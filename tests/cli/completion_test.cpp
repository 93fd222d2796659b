// Completion as bash asks for it: the script is sourced, its function called at a cursor.
#include <gtest/gtest.h>

#include "tests/support/backends.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

// What COMPREPLY holds, joined by spaces, with the cursor at the end of the line. `breaks`: COMP_WORDBREAKS.
std::string completed(const std::string& line, const std::string& breaks = " \t\n\"'><=;|&(:") {
    const std::string script = R"(
        source <("$0" completion bash)
        complete -p ptbench >/dev/null || exit 3
        COMP_LINE=$1 COMP_POINT=${#1} COMP_WORDBREAKS=$2
        _ptbench "$0" && echo "${COMPREPLY[*]}")";
    const CommandResult result =
        run_command({"/bin/bash", "-c", script, test::program_file(), line, breaks}, in_repository());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out.substr(0, result.out.find('\n'));
}

TEST(CompletionTest, Commands) {
    EXPECT_EQ(completed("ptbench re"), "render replay");
    EXPECT_EQ(completed("ptbench --v"), "--version");
    EXPECT_NE(completed("build/ptbench ").find("list run merge "), std::string::npos);
    EXPECT_EQ(completed("ptbench frob "), "");
}

TEST(CompletionTest, Options) {
    EXPECT_EQ(completed("ptbench run --ax"), "--axis");
    EXPECT_EQ(completed("ptbench run --resume --ov"), "--overwrite");  // a flag takes no value
    EXPECT_EQ(completed("ptbench run --dep"), "--depth");
    EXPECT_EQ(completed("ptbench run --depth "), "");  // numbers
    EXPECT_NE(completed("ptbench verify ").find("--scene"), std::string::npos);
    EXPECT_EQ(completed("ptbench merge "), "");  // files
}

TEST(CompletionTest, AxesAndChoices) {
    EXPECT_EQ(completed("ptbench run --axis lay"), "layout=");
    EXPECT_EQ(completed("ptbench run --backend cpu --axis layout="), "aos soa all");
    EXPECT_EQ(completed("ptbench run --backend cpu --axis layout=so"), "soa");
    EXPECT_EQ(completed("ptbench run --backend cpu --axis layout=aos,"), "aos,soa");
    EXPECT_EQ(completed("ptbench run --backend=cpu --axis=layout=s"), "soa");
    EXPECT_EQ(completed("ptbench run --axis nope="), "");
    EXPECT_EQ(completed("ptbench render --tune jit"), "jitters=");
    EXPECT_EQ(completed("ptbench list lay"), "layout");
    if (cuda_is_built()) {
        EXPECT_EQ(completed("ptbench run --axis layout=p"), "packed");
        EXPECT_EQ(completed("ptbench run --backend cpu --axis layout=p"), "");
    }
}

// Where "=" breaks no words, as in zsh and by some users' settings, the whole word stands there.
TEST(CompletionTest, WholeWordsWhereEqualsBreaksNone) {
    EXPECT_EQ(completed("ptbench run --backend cpu --axis layout=so", " \t\n"), "layout=soa");
    EXPECT_EQ(completed("ptbench run --suite=qu", " \t\n"), "--suite=quick");
}

TEST(CompletionTest, ScenesSuitesAndBackends) {
    EXPECT_EQ(completed("ptbench render --scene cornell_open_f"), "cornell_open_five");
    EXPECT_EQ(completed("ptbench run --scene cornell_open_five,edg"),
              "cornell_open_five,edge cornell_open_five,edge_unjittered");
    EXPECT_EQ(completed("ptbench run --scene edge,edge"), "edge,edge_unjittered");  // each once
    EXPECT_EQ(completed("ptbench run --suite qu"), "quick");
    EXPECT_EQ(completed("ptbench run --suite=qu"), "quick");
    EXPECT_EQ(completed("ptbench run --backend c"), "cpu cuda");
    EXPECT_EQ(completed("ptbench render --aovs a"), "albedo all");
    EXPECT_EQ(completed("ptbench render --aovs=depth,no"), "depth,normal");
    EXPECT_EQ(completed("ptbench new sh"), "shape");
    EXPECT_EQ(completed("ptbench list --names sce"), "scenes");
}

}  // namespace
}  // namespace pt::test
