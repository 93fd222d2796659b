// What a crash leaves: the line that names what was at work, the file's last line, and the exit code. Each crash is in
// a process of its own.
#include "harness/crash.h"

#include <csignal>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "harness/failure.h"
#include "tests/support/command.h"

namespace pt {
namespace {

class CrashTest : public testing::TestWithParam<CrashSignal> {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("lines");

    int open_file() const { return ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT, 0600); }
    static std::string line_of(const std::string& signal) { return "crashed: " + signal + "\n"; }
};

TEST_P(CrashTest, IsNamedAndNoted) {
    test::write_text(file, "a line\n");
    EXPECT_EXIT(
        {
            name_crashes();
            const AtWork outer("the cell");
            { const AtWork over("what is over"); }
            const AtWork inner("its sample");
            const LastLine last_line(open_file(), line_of, "go on so\n");
            std::raise(GetParam().number);
        },
        testing::ExitedWithCode(exit_machine_failed), "");
    EXPECT_EQ(test::content_of(file), "a line\ncrashed: " + std::string(GetParam().name) + "\n");
}

TEST_P(CrashTest, SaysWhatWasAtWork) {
    EXPECT_EXIT(
        {
            name_crashes();
            const AtWork outer("the cell");
            const AtWork inner("its\nsample");
            { const LastLine over(open_file(), line_of, "what is over"); }
            std::raise(GetParam().number);
        },
        testing::ExitedWithCode(exit_machine_failed),
        "^ptbench: crashed, [a-z ]*.SIG[A-Z]*., in: the cell: its.x0asample\n$");
    EXPECT_EQ(test::content_of(file), "");
}

INSTANTIATE_TEST_SUITE_P(Signals, CrashTest, testing::ValuesIn(crash_signals),
                         [](const auto& test) { return "Number" + std::to_string(test.param.number); });

// A handler that somebody else has set, as a sanitizer's, stays.
TEST(CrashHandlerTest, OfSomebodyElseStays) {
    EXPECT_EXIT(
        {
            std::signal(SIGFPE, [](int) { ::_exit(77); });
            name_crashes();
            std::raise(SIGFPE);
        },
        testing::ExitedWithCode(77), "^$");
}

// What is long is cut, and what lies too deep is left out: neither is a crash of its own.
TEST(CrashHandlerTest, HoldsMuch) {
    EXPECT_EXIT(
        {
            name_crashes();
            const AtWork one(std::string(10000, 'a'));
            const AtWork two("b");
            const AtWork three("c");
            const AtWork four("d");
            const AtWork five("e");
            std::raise(SIGSEGV);
        },
        testing::ExitedWithCode(exit_machine_failed), "aaa: b: c: d\n$");
}

}  // namespace
}  // namespace pt
