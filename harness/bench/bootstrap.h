// Ratios of medians with their intervals, and the verdict that they allow. The interval is the percentile bootstrap of
// the median (Efron 1979). A run's verdicts are computed here, once: its file holds them. Pairs across files and files
// that hold none are judged by analysis/ptbench/stats/estimates.py, by the same limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace pt {

// The random numbers of a bootstrap, of one seed: one set of samples always has one interval.
class BootstrapRandom {
public:
    // A whole number from 0 to `count` - 1. Some are likelier than others by a share of count / 2^64 at most.
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
    std::optional<RatioInterval> interval = {};  // 95 %; a side of one sample has none
    std::size_t samples = 0;                     // of the side that has fewer
};

// The median of some values. Precondition: there is at least one.
double median_of(std::vector<double> values);
// Median of `values` over the median of `baseline`. Precondition: at least one of each.
RatioEstimate ratio_estimate(const std::vector<double>& values, const std::vector<double>& baseline);

enum class Word { faster, slower, same, unsure };
// The verdict's word as results show it, "FASTER" for instance.
std::string to_text(Word word);

// Why a verdict is UNSURE, or why there is none.
enum class WordReason {
    none,
    few_samples,            // on one side or both
    wide,                   // the interval reaches both sides of a limit
    contended,              // other processes took CPU time during too many samples
    throttled,              // a quota of CPU time did, or other processes
    clocks_differed,        // the ratio in cycles has another word
    no_baseline,            // no cell has the baseline's choice and all else equal
    baseline_not_measured,  // that cell has no times
};
// The reason's code in a result file, "few_samples" for instance; of none it is "".
std::string to_code(WordReason reason);

struct TimeVerdict {
    Word word = Word::unsure;
    WordReason reason = WordReason::none;
    Word in_time = Word::unsure;         // whatever the clocks and other processes did
    std::optional<Word> in_cycles = {};  // the word on the ratio in cycles, where the clocks are known
};
// The reason of an unsure verdict in words. `samples` is those of the ratio.
std::string in_words(const TimeVerdict& verdict, std::size_t samples);

// The samples of one side of a ratio.
struct Times {
    std::vector<double> ms_per_spp;
    std::vector<double> cycles;  // millions a sample per pixel; empty where a clock was not measured
    bool is_throttled = false;   // a quota of CPU time disturbed one of them
    bool is_contended = false;   // other processes disturbed more than limits::most_disturbed_share of them
};

// The verdict on an interval of a ratio, however many samples are behind it.
Word word_of(const RatioInterval& interval);
// The interval as "[0.9938, 1.0102]", in the digits that show on which side of the verdict's limits each end lies.
std::string interval_text(const RatioInterval& interval);
// The verdict that the times allow: cycles must not contradict them, and contended samples allow none.
TimeVerdict verdict_of(const RatioEstimate& ratio, const Times& times, const Times& baseline);

}  // namespace pt
