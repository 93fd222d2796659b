// Ratios, intervals and verdicts against numbers worked out by hand.
#include "harness/bench/bootstrap.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pt {
namespace {

// 90,000 throws of nine sides: the sum of squared deviations is chi-squared with 8 degrees of freedom, which is above
// 26.1 with probability 0.001. The seed is fixed, so this holds or it does not.
TEST(BootstrapRandomTest, EveryNumberIsAsLikely) {
    BootstrapRandom random;
    std::vector<double> counts(9);
    for (int i = 0; i < 90000; ++i) {
        counts.at(random.below(9)) += 1;
    }
    double deviation = 0;
    for (const double count : counts) {
        deviation += (count - 10000) * (count - 10000) / 10000;
    }
    EXPECT_LT(deviation, 26.1);
    EXPECT_GT(deviation, 0.86);  // and not too even: below with probability 0.001
    EXPECT_EQ(random.below(1), 0u);
}

TEST(BootstrapTest, MediansByHand) {
    EXPECT_EQ(median_of({5}), 5);
    EXPECT_EQ(median_of({6, 1, 2}), 2);
    EXPECT_EQ(median_of({4, 1, 2, 9}), 3);
    EXPECT_EQ(median_of({2, 2, 2, 2}), 2);
}

TEST(BootstrapTest, ARatioOfConstantsHasAnIntervalOfNoWidth) {
    const RatioEstimate ratio = ratio_estimate(std::vector<double>(9, 3.0), std::vector<double>(12, 2.0));
    EXPECT_EQ(ratio.value, 1.5);
    EXPECT_EQ(ratio.interval->low, 1.5);
    EXPECT_EQ(ratio.interval->high, 1.5);
    EXPECT_EQ(ratio.samples, 9u);
}

TEST(BootstrapTest, OneSampleHasNoInterval) {
    const RatioEstimate ratio = ratio_estimate({3}, {2, 4, 6});
    EXPECT_EQ(ratio.value, 0.75);
    EXPECT_FALSE(ratio.interval);
    EXPECT_EQ(ratio.samples, 1u);
}

// Two samples 1 and 3: a quarter of the medians are 1, a half 2 and a quarter 3, so 2.5 % lies at the ends.
TEST(BootstrapTest, TheIntervalOfTwoValuesReachesBothOfThem) {
    const RatioEstimate ratio = ratio_estimate({1, 3}, {2, 2});
    EXPECT_EQ(ratio.value, 1);
    EXPECT_EQ(ratio.interval->low, 0.5);
    EXPECT_EQ(ratio.interval->high, 1.5);
}

// The median of nine draws from nine values is at most the k-th with the probability that five or more of the draws are
// among the first k, a binomial's tail: 0.0014 for k = 1 and 0.0304 for k = 2. The lower end cuts off 0.025, so it is
// the second value; by symmetry the upper end is the eighth.
TEST(BootstrapTest, TheIntervalOfNineValuesIsTheBinomialsOne) {
    const auto at_most = [](int k) {
        double tail = 0, choose = 1;
        for (int i = 0; i <= 9; ++i) {
            tail += i >= 5 ? choose * std::pow(k / 9.0, i) * std::pow(1 - k / 9.0, 9 - i) : 0;
            choose = choose * (9 - i) / (i + 1);
        }
        return tail;
    };
    ASSERT_LT(at_most(1), 0.025);
    ASSERT_GT(at_most(2), 0.025);
    const RatioEstimate ratio = ratio_estimate({3, 1, 9, 5, 2, 8, 7, 4, 6}, std::vector<double>(9, 1.0));
    EXPECT_EQ(ratio.value, 5);
    EXPECT_EQ(ratio.interval->low, 2);
    EXPECT_EQ(ratio.interval->high, 8);
}

TEST(VerdictTest, TheWholeIntervalLiesOnOneSideOfALimit) {
    EXPECT_EQ(word_of({0.9, 0.98}), Word::faster);
    EXPECT_EQ(word_of({0.9, 1 - 0.01}), Word::unsure);  // on the limit
    EXPECT_EQ(word_of({1.011, 1.2}), Word::slower);
    EXPECT_EQ(word_of({1 + 0.01, 1.2}), Word::unsure);
    EXPECT_EQ(word_of({0.995, 1.005}), Word::same);
    EXPECT_EQ(word_of({1 - 0.01, 1 + 0.01}), Word::same);
    EXPECT_EQ(word_of({0.98, 1.005}), Word::unsure);
    EXPECT_EQ(word_of({0.5, 2}), Word::unsure);
    EXPECT_EQ(to_text(Word::faster) + to_text(Word::slower) + to_text(Word::same) + to_text(Word::unsure),
              "FASTERSLOWERSAMEUNSURE");
}

TEST(VerdictTest, AnIntervalHasAsManyDigitsAsShowTheVerdict) {
    EXPECT_EQ(interval_text({0.95, 1.25}), "[0.950, 1.250]");
    EXPECT_EQ(interval_text({0.98996, 1.0102}), "[0.98996, 1.01020]");
    EXPECT_EQ(interval_text({11.5, 12.34}), "[11.50, 12.34]");
}

Times times(double ms, std::size_t count, double clock = 0) {
    Times made{.ms_per_spp = std::vector<double>(count, ms), .cycles = {}};
    if (clock > 0) {
        made.cycles.assign(count, ms * clock);
    }
    return made;
}

TimeVerdict verdict(const Times& of, const Times& baseline) {
    return verdict_of(ratio_estimate(of.ms_per_spp, baseline.ms_per_spp), of, baseline);
}

TEST(VerdictTest, NeedsNineSamplesOnBothSides) {
    EXPECT_EQ(verdict(times(1, 9), times(2, 9)).word, Word::faster);
    EXPECT_EQ(verdict(times(3, 9), times(2, 9)).word, Word::slower);
    EXPECT_EQ(verdict(times(2, 9), times(2, 9)).word, Word::same);
    const TimeVerdict few = verdict(times(1, 9), times(2, 8));
    EXPECT_EQ(few.word, Word::unsure);
    EXPECT_EQ(few.reason, WordReason::few_samples);
    EXPECT_EQ(in_words(few, 8), "n = 8, a verdict needs 9");
}

TEST(VerdictTest, CyclesMustNotContradictIt) {
    // A clock that was half as high on one side: the same work.
    const TimeVerdict clocks = verdict(times(2, 9, 1500), times(1, 9, 3000));
    EXPECT_EQ(clocks.word, Word::unsure);
    EXPECT_EQ(to_code(clocks.reason), "clocks_differed");
    EXPECT_EQ(in_words(clocks, 9), "SLOWER in time but SAME in cycles: the clocks differed");
    EXPECT_EQ(verdict(times(2, 9, 3000), times(1, 9, 3000)).word, Word::slower);
    EXPECT_EQ(verdict(times(2, 9, 1500), times(1, 9)).word, Word::slower);  // one side's clock is unknown
}

TEST(VerdictTest, ContendedSamplesSayNothing) {
    Times busy = times(2, 9);
    busy.is_contended = true;
    for (const TimeVerdict& found : {verdict(busy, times(1, 9)), verdict(times(1, 9), busy)}) {
        EXPECT_EQ(found.word, Word::unsure);
        EXPECT_NE(found.in_time, Word::unsure);  // what the times alone say is kept
        EXPECT_EQ(in_words(found, 9), "other processes took CPU time during more than a tenth of the samples");
    }
}

}  // namespace
}  // namespace pt
