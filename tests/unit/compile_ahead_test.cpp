// Compiling ahead: the processes that do it end with the one that asked for it.
#include "harness/bench/compile_ahead.h"

#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "harness/bench/journal.h"
#include "tests/support/command.h"

namespace pt {
namespace {

// Run in a process of its own, by the test after it: a run with its journal whose compilers take for ever.
TEST(CompileAheadTest, DISABLED_HangsWithAJournal) {
    const std::string folder = std::getenv("PTBENCH_TEST_FOLDER");
    const Journal journal(folder + "/journal", "identity", false);
    cuda::ProgramsToCompile programs;
    for (const char* name : {"a", "b"}) {
        programs[name] = {[file = folder + "/" + name] {
            test::write_text(file, "begun");
            ::sleep(600);
        }};
    }
    compile_programs(programs);
}

TEST(CompileAheadTest, AKilledRunLeavesNoCompilerThatHoldsItsJournal) {
    if (std::thread::hardware_concurrency() < 2) {
        GTEST_SKIP() << "one processor: programs are left to whoever needs them";
    }
    const test::TemporaryFolder folder;
    test::RunningCommand run({"/proc/self/exe", "--gtest_also_run_disabled_tests",
                              "--gtest_filter=CompileAheadTest.DISABLED_HangsWithAJournal"},
                             {.environment = {{"PTBENCH_TEST_FOLDER", folder.path().string()}}});
    ASSERT_TRUE(test::wait_until(
        [&] { return std::filesystem::exists(folder.file("a")) && std::filesystem::exists(folder.file("b")); }));
    run.signal(SIGKILL);
    EXPECT_EQ(run.wait().exit_code, 128 + SIGKILL);
    const auto is_free = [&] {
        try {
            const Journal journal(folder.file("journal"), "identity", true);
            return true;
        } catch (const MachineError&) {
            return false;
        }
    };
    EXPECT_TRUE(test::wait_until(is_free, std::chrono::seconds(30)));
}

}  // namespace
}  // namespace pt
