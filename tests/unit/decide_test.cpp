// More samples for verdicts that are open by the width of their interval: of which cells, how many, and within which
// time.
#include "harness/bench/decide.h"

#include <cmath>

#include <gtest/gtest.h>

#include "harness/bench/bootstrap.h"
#include "tests/support/command.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

class DecideTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    Journal journal{folder.file("journal"), Json::object(), false};
    Suite suite{.name = "hand", .description = "", .studies = {Study()}};
    Plan plan;

    DecideTest() {
        suite.studies[0].name = "a";
        suite.studies[0].compares = "compaction";
        plan.cells.reserve(9);
    }

    // Nine samples of 100 ms on average, 100 - spread to 100 + spread; `foreign` ms of other processes in each.
    const Cell& add(const std::string& compaction, double ms, double spread, double foreign = 0) {
        Variant variant = Registry::instance().baseline(Backend::cpu);
        variant.set("compaction", compaction);
        plan.cells.push_back({.name = compaction,
                              .studies = {"a"},
                              .scene = scene(),
                              .backend = Backend::cpu,
                              .variant = variant,
                              .settings = {.width = 8, .height = 8, .depth = 4},
                              .spp = 1});
        journal.set_cell(compaction, {});
        for (int i = -4; i <= 4; ++i) {
            const double wall = ms + spread * i / 4;
            journal.add_sample(compaction,
                               {.wall_ms = wall, .cpu_ms = wall, .end_to_end_ms = wall, .foreign_cpu_ms = foreign});
        }
        return plan.cells.back();
    }

    static std::shared_ptr<const Scene> scene() {
        static const auto shared = std::make_shared<Scene>(test::SceneBuilder().scene);
        return shared;
    }

    std::map<std::string, std::size_t> wanted(std::size_t most = 36, double seconds = 1e9) const {
        std::map<std::string, std::size_t> counts;
        for (const WantedSamples& one : samples_to_decide(plan, suite, journal, most, seconds)) {
            counts[one.cell->name] = one.samples;
        }
        return counts;
    }
};

TEST_F(DecideTest, WhatIsDecidedOrDisturbedGetsNoMore) {
    add("none", 100, 1);
    add("thrust_remove_if", 200, 1);
    add("thrust_partition", 100, 0.001);
    add("thrust_copy_if_index", 101, 30, 50);
    EXPECT_TRUE(wanted().empty());
}

// Samples go with the square of the width, for both sides of the ratio.
TEST_F(DecideTest, AnOpenVerdictGetsWhatWouldMakeItsIntervalNarrow) {
    add("none", 100, 1);
    add("thrust_remove_if", 101, 1.5);
    add("thrust_partition", 300, 1);
    const auto interval = *ratio_estimate({99.5, 99.875, 100.25, 100.625, 101, 101.375, 101.75, 102.125, 102.5},
                                          {99, 99.25, 99.5, 99.75, 100, 100.25, 100.5, 100.75, 101})
                               .interval;
    const double half = (interval.high - interval.low) / 2;
    const auto samples = static_cast<std::size_t>(std::ceil(9 * std::pow(half / 0.008, 2)));
    ASSERT_GT(samples, 9u);
    ASSERT_LT(samples, 36u);
    EXPECT_EQ(wanted(), (std::map<std::string, std::size_t>{{"none", samples}, {"thrust_remove_if", samples}}));
}

TEST_F(DecideTest, NoCellGetsMoreThanTheMost) {
    add("none", 100, 30);
    add("thrust_remove_if", 101, 30);
    EXPECT_EQ(wanted(20), (std::map<std::string, std::size_t>{{"none", 20}, {"thrust_remove_if", 20}}));
}

// 2 x 27 samples of about 100 ms are 5.4 s.
TEST_F(DecideTest, InTooLittleTimeEachGetsItsShare) {
    add("none", 100, 30);
    add("thrust_remove_if", 100, 30);
    EXPECT_EQ(wanted(36, 2.8), (std::map<std::string, std::size_t>{{"none", 23}, {"thrust_remove_if", 23}}));
    EXPECT_TRUE(wanted(36, 0.1).empty());
}

TEST_F(DecideTest, ARunSaysWhichCellsHaveMore) {
    add("none", 100, 1);
    add("thrust_remove_if", 101, 1);
    EXPECT_EQ(decided_in_words(plan, journal, 9), "");
    EXPECT_EQ(decided_in_words(plan, journal, 7),
              "more samples: 2 cells have 9 to 9, for verdicts that were open by the width of their interval");
}

}  // namespace
}  // namespace pt
