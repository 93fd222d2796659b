// Ratios of median times with bootstrap confidence intervals (percentile bootstrap of the median, Efron 1979), and the
// verdicts that the intervals allow. Verdicts within a run are computed here and stored in its result file; pairs of
// cells across files, and files without verdicts, are judged by analysis/ptbench/stats/estimates.py, with the same
// limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace pt {

// The random number generator of a bootstrap, with a fixed seed: the same samples always have the same interval.
class BootstrapRandom {
public:
    // Returns a random whole number from 0 to `count` - 1; the probabilities differ by a share of count / 2^64 at most.
    // Precondition: 1 <= count < 2^32.
    std::uint32_t below(std::uint32_t count);

private:
    std::mt19937_64 generator_{1986};
};

struct RatioInterval {
    double low, high;
};

struct RatioEstimate {
    double value = 1;
    std::optional<RatioInterval> interval = {};  // 95 % confidence interval of the ratio; none if a side has one sample
    std::size_t samples = 0;                     // number of timed samples on that side of the ratio that has fewer
};

// The median of some values. Precondition: there is at least one.
double median_of(std::vector<double> values);
// The ratio of the median of `values` to the median of `baseline`. Precondition: both hold at least one value.
RatioEstimate ratio_estimate(const std::vector<double>& values, const std::vector<double>& baseline);

enum class Word { faster, slower, same, unsure };
std::string to_text(Word word);

// The reason why a verdict on a ratio of times is UNSURE, or why there is no verdict.
enum class WordReason {
    none,
    few_samples,            // too few timed samples on one side of the ratio or both
    wide,                   // the confidence interval contains a limit of the verdict
    contended,              // other processes took CPU time during too many samples
    throttled,              // a CPU quota, perhaps with other processes, took CPU time
    clocks_differed,        // ratios of times and of cycles have different verdicts
    no_baseline,            // the study has no baseline cell that fits the cell
    baseline_not_measured,  // the baseline cell has no times
};
// The code of a verdict's reason in a result file, "few_samples" for instance; "" for `none`.
std::string to_code(WordReason reason);

struct TimeVerdict {
    Word word = Word::unsure;
    WordReason reason = WordReason::none;
    Word in_time = Word::unsure;         // verdict on the ratio of times alone
    std::optional<Word> in_cycles = {};  // verdict on the ratio of clock cycles alone; none if a clock is unknown
};
// The reason of an UNSURE verdict in words. `samples` is the number of samples behind the ratio.
std::string in_words(const TimeVerdict& verdict, std::size_t samples);

// The timed samples of one of the two cells whose ratio is taken.
struct Times {
    std::vector<double> ms_per_spp;
    std::vector<double> cycles;  // millions of cycles per spp; empty if a clock is unknown
    bool is_throttled = false;   // whether a CPU quota disturbed any of the samples
    bool is_contended = false;   // whether other load or quotas disturbed more than most_disturbed_share of the samples
};

// The verdict on the confidence interval of a ratio, whatever the number of samples.
Word word_of(const RatioInterval& interval);
// A confidence interval, "[0.9938, 1.0102]", with the digits that show on which side of a verdict's limit an end lies.
std::string interval_text(const RatioInterval& interval);
// The verdict on a ratio of times. It is UNSURE where the ratio in clock cycles says otherwise, or where other
// processes disturbed too many samples.
TimeVerdict verdict_of(const RatioEstimate& ratio, const Times& times, const Times& baseline);

}  // namespace pt
