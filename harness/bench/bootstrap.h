// Ratios of medians with their intervals, and the verdict that they allow: the rule of analysis/ptbench/stats/
// estimates.py, number for number, so that the table at the end of a run and the pages drawn from its file never
// disagree. The interval is the percentile bootstrap of the median (Efron 1979).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pt {

inline constexpr std::size_t resamples = 10000;
inline constexpr std::size_t fewest_samples = 9;     // on both sides of a ratio, for a verdict
inline constexpr double least_difference = 0.01;     // of a ratio from 1
inline constexpr double most_disturbed_share = 0.1;  // of a cell's samples

// The random generator of the bootstrap: NumPy's default_rng(1986), PCG64 (O'Neill 2014, XSL-RR), whose 64 bits are
// handed out as two halves, the low one first.
class BootstrapRandom {
public:
    // A whole number from 0 to `count` - 1, all equally likely (Lemire 2019). Precondition: 1 <= count < 2^32.
    std::uint32_t below(std::uint32_t count);

private:
    std::uint32_t next();
    __extension__ using State = unsigned __int128;
    // The generator's state and increment as NumPy's SeedSequence derives them from the seed.
    State state_ = (State{0x25f9e8be20ac44e0u} << 64) | 0xece195b0c628c17cu;
    State increment_ = (State{0x515d7956003607f8u} << 64) | 0xc7a947b5eca38d2du;
    std::optional<std::uint32_t> high_half_;
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

struct TimeVerdict {
    Word word = Word::unsure;
    std::string reason = {};  // of an unsure one
};

// The samples of one side of a ratio.
struct Times {
    std::vector<double> ms_per_spp;
    std::vector<double> cycles;  // millions a sample per pixel; empty where a clock was not measured
    bool is_throttled = false;   // a quota of CPU time disturbed one of them
    bool is_contended = false;   // other processes disturbed more than most_disturbed_share of them
};

// The verdict on an interval of a ratio, however many samples are behind it.
Word word_of(const RatioInterval& interval);
// The interval as "[0.9938, 1.0102]", in the digits that show on which side of the verdict's limits each end lies.
std::string interval_text(const RatioInterval& interval);
// The verdict that the times allow: cycles must not contradict them, and contended samples allow none.
TimeVerdict verdict_of(const RatioEstimate& ratio, const Times& times, const Times& baseline);

}  // namespace pt
