// How long is left, from what was measured.
#include "harness/bench/progress.h"

#include <algorithm>
#include <cstdlib>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace pt {
namespace {

TEST(TimeLeftTest, IsUnknownUntilSomethingWasMeasured) {
    TimeLeft time;
    EXPECT_EQ(time.seconds(), std::nullopt);
    time.expect("a", 3, 5);
    EXPECT_EQ(time.seconds(), std::nullopt);
    time.took("a", 2);
    EXPECT_EQ(time.seconds(), 4);
}

TEST(TimeLeftTest, EachNameLastsAsItsOwnStepsDid) {
    TimeLeft time;
    time.expect("short", 4, 1);
    time.expect("long", 3, 1);
    time.took("short", 1);
    time.took("long", 60);
    time.took("long", 64);
    EXPECT_EQ(time.seconds(), 3 * 1 + 1 * 62);
}

TEST(TimeLeftTest, ANameWithoutMeasurementsIsJudgedByItsSize) {
    TimeLeft time;
    time.expect("a", 2, 10);
    time.expect("b", 2, 30);
    time.expect("c", 5, 4);
    time.took("a", 20);  // two a size
    EXPECT_EQ(time.seconds(), 1 * 20 + 2 * 60 + 5 * 8);
    time.took("b", 100);  // 120 seconds for a size of 40: three
    EXPECT_EQ(time.seconds(), 1 * 20 + 1 * 100 + 5 * 12);
}

TEST(TimeLeftTest, EarlierSessionsMeasureButAreNotLeft) {
    TimeLeft time;
    time.expect("a", 2, 1);
    time.took("a", 7, false);
    EXPECT_EQ(time.seconds(), 14);
    time.took("a", 9);
    EXPECT_EQ(time.seconds(), 8);
}

TEST(TimeLeftTest, WhatFailedIsNotWaitedFor) {
    TimeLeft time;
    time.expect("a", 1, 1);
    time.expect("b", 1, 1);
    time.took("a", 7);
    time.drop("b");
    EXPECT_EQ(time.seconds(), 0);
}

TEST(ProgressTest, SaysHowFarItIsAndWhatIsLeft) {
    testing::internal::CaptureStderr();
    Progress progress("time", 2);
    progress.step("first", [] { return std::optional<double>(3725); });
    progress.step("second", [] { return std::optional<double>(); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "[1/2] time: 0:00 elapsed, about 1:02:05 left  first\n"
              "[2/2] time: 0:00 elapsed, unknown time left  second\n");
}

TEST(ProgressTest, ALogHasFewLines) {
    testing::internal::CaptureStderr();
    Progress progress("time", 1000);
    for (int i = 0; i < 1000; ++i) {
        progress.step("name");
    }
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(text.find("[1/1000] "), 0u) << text;
    EXPECT_NE(text.find("[1000/1000] "), std::string::npos) << text;
    EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 100);
}

TEST(ProgressTest, HiddenItSaysNothing) {
    testing::internal::CaptureStderr();
    Progress progress("time", 1, Progress::Lines::hidden);
    progress.step("name");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressTest, WhatIsDoneSoonIsNotTold) {
    testing::internal::CaptureStderr();
    Progress patient("verify", 2, Progress::Lines::shown, 3600);
    patient.step("first");
    patient.step("second");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// What a terminal of so many columns would be sent.
template <class Write>
std::string written_to_terminal(unsigned short columns, const Write& write) {
    const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_TRUE(master >= 0 && ::grantpt(master) == 0 && ::unlockpt(master) == 0);
    const int terminal = ::open(::ptsname(master), O_RDWR | O_NOCTTY);
    const winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    ::ioctl(terminal, TIOCSWINSZ, &size);
    const int kept = ::dup(STDERR_FILENO);
    ::dup2(terminal, STDERR_FILENO);
    write();
    ::dup2(kept, STDERR_FILENO);
    ::close(kept);
    ::close(terminal);
    std::string text;
    char buffer[4096];
    for (ssize_t read = 1; (read = ::read(master, buffer, sizeof buffer)) > 0;) {
        text.append(buffer, static_cast<std::size_t>(read));
    }
    ::close(master);
    return text;
}

TEST(ProgressTest, OnATerminalItIsOneLineThatIsWrittenOver) {
    const auto nothing = [] { return std::optional<double>(); };
    const std::string text = written_to_terminal(100, [&] {
        Progress progress("time", 2);
        progress.begin("first");
        progress.step("first", nothing);  // too soon after the last to be seen
        progress.step("second", [] { return std::optional<double>(0); });
    });
    EXPECT_EQ(text,
              "\r\033[Ktime [--------------------] 0/2  0:00 elapsed, unknown time left  first"
              "\r\033[Ktime [####################] 2/2  0:00 elapsed, about 0:00 left  second\r\n");
}

TEST(ProgressTest, OnANarrowTerminalTheLineIsCut) {
    const std::string text = written_to_terminal(40, [] { Progress("time", 3).begin("a name"); });
    EXPECT_EQ(text, "\r\033[Ktime [--------------------] 0/3  0:00 e");
}

TEST(ProgressTest, WhatIsSaidMeanwhileTakesTheBarsPlace) {
    EXPECT_EQ(written_to_terminal(80, [] { say_below_progress("failed: a"); }), "\r\033[Kfailed: a\r\n");
    testing::internal::CaptureStderr();
    say_below_progress("failed: a");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "failed: a\n");
}

TEST(ProgressTest, ALogIsNotToldWhatBegins) {
    testing::internal::CaptureStderr();
    Progress progress("time", 2);
    progress.begin("first");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressTest, ShowsTimesAsAClock) {
    EXPECT_EQ(clock_text(0.4), "0:00");
    EXPECT_EQ(clock_text(59.6), "1:00");
    EXPECT_EQ(clock_text(754), "12:34");
    EXPECT_EQ(clock_text(360000), "100:00:00");
}

}  // namespace
}  // namespace pt
