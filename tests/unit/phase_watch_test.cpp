// A phase that takes long is told, with what is left of it where that is known.
#include "harness/bench/phase_watch.h"

#include <gtest/gtest.h>

namespace pt {
namespace {

TEST(PhaseLinesTest, NothingIsSaidOfAPhaseThatIsSoonOver) {
    PhaseLines lines("render", false);
    EXPECT_EQ(lines.due(1000), "");
    lines.begin("reading the scene", {}, 10);
    EXPECT_EQ(lines.due(11.9), "");
    lines.begin("rendering", {}, 11.9);
    EXPECT_EQ(lines.due(13.8), "");
    lines.end();
    EXPECT_EQ(lines.due(1000), "");
}

TEST(PhaseLinesTest, ALogHasALineAfterTwoSecondsAndFewAfterThat) {
    PhaseLines lines("render", false);
    lines.begin("reading the scene", {}, 100);
    EXPECT_EQ(lines.due(102), "render: reading the scene: 0:02 so far");
    EXPECT_EQ(lines.due(111.9), "");
    EXPECT_EQ(lines.due(112), "render: reading the scene: 0:12 so far");
    EXPECT_EQ(lines.due(3700), "render: reading the scene: 1:00:00 so far");
    EXPECT_EQ(lines.due(3771), "");
    EXPECT_EQ(lines.due(3772), "render: reading the scene: 1:01:12 so far");
}

TEST(PhaseLinesTest, WhatIsLeftFollowsFromWhatWasExpectedAndThenFromWhatIsDone) {
    PhaseLines lines("render", true);
    lines.begin("rendering", 60, 0);
    EXPECT_EQ(lines.due(2), "render: rendering: 0:02 elapsed, about 0:58 left");
    EXPECT_EQ(lines.due(2.1), "");
    EXPECT_EQ(lines.due(2.25), "render: rendering: 0:02 elapsed, about 0:58 left");
    lines.reached(0, 5);
    EXPECT_EQ(lines.due(5), "render: rendering: 0:05 elapsed, about 0:55 left");
    lines.reached(0.25, 10);
    EXPECT_EQ(lines.due(10), "render: rendering: 0:10 elapsed, about 0:30 left");
    EXPECT_EQ(lines.due(45), "render: rendering: 0:45 elapsed, where 0:40 were expected");
}

}  // namespace
}  // namespace pt
