#include "harness/bench/bootstrap.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

std::uint32_t BootstrapRandom::below(std::uint32_t count) {
    __extension__ using Product = unsigned __int128;
    return static_cast<std::uint32_t>((Product{generator_()} * count) >> 64);
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return values.size() % 2 != 0 ? *middle : (*std::max_element(values.begin(), middle) + *middle) / 2;
}

namespace {

std::vector<double> resampled_medians(const std::vector<double>& values, BootstrapRandom& random) {
    std::vector<double> medians(limits::resamples), drawn(values.size());
    for (double& median : medians) {
        for (double& value : drawn) {
            value = values[random.below(static_cast<std::uint32_t>(values.size()))];
        }
        median = median_of(drawn);
    }
    return medians;
}

// The quantile of sorted values, with the share `share` (from 0 to 1) of the values below it.
double quantile(const std::vector<double>& sorted, double share) {
    return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
}

// Whether `value`, an end of an interval, lies on the same side of a verdict's limit as its rounded text.
bool is_on_its_side(double value, const std::string& text, double limit) {
    const double shown = std::stod(text);
    return (value < limit) == (shown < limit) && (value > limit) == (shown > limit);
}

TimeVerdict verdict_of_ratio(const RatioEstimate& ratio) {
    if (ratio.samples < limits::fewest_samples || !ratio.interval) {
        return {Word::unsure, WordReason::few_samples};
    }
    const Word word = word_of(*ratio.interval);
    return {word, word == Word::unsure ? WordReason::wide : WordReason::none};
}

}  // namespace

RatioEstimate ratio_estimate(const std::vector<double>& values, const std::vector<double>& baseline) {
    RatioEstimate estimate{.value = median_of(values) / median_of(baseline),
                           .samples = std::min(values.size(), baseline.size())};
    if (estimate.samples == 1) {
        return estimate;
    }
    BootstrapRandom random;
    std::vector<double> ratios = resampled_medians(values, random);
    const std::vector<double> below = resampled_medians(baseline, random);
    for (std::size_t i = 0; i < ratios.size(); ++i) {
        ratios[i] /= below[i];
    }
    std::sort(ratios.begin(), ratios.end());
    const double tail = 0.5 * (1 - limits::confidence);
    estimate.interval = {quantile(ratios, tail), quantile(ratios, 1 - tail)};
    return estimate;
}

std::string to_text(Word word) {
    switch (word) {
        case Word::faster:
            return "FASTER";
        case Word::slower:
            return "SLOWER";
        case Word::same:
            return "SAME";
        case Word::unsure:
            break;
    }
    return "UNSURE";
}

Word word_of(const RatioInterval& interval) {
    const double lower = 1 - limits::least_difference, upper = 1 + limits::least_difference;
    if (interval.high < lower) {
        return Word::faster;
    }
    if (interval.low > upper) {
        return Word::slower;
    }
    return interval.low >= lower && interval.high <= upper ? Word::same : Word::unsure;
}

std::string interval_text(const RatioInterval& interval) {
    for (int digits = 3;; ++digits) {
        const auto shown = [&](double value) {
            return fmt::format("{:.{}f}", value, value < 10 ? digits : digits - 1);
        };
        const std::string low = shown(interval.low), high = shown(interval.high);
        const auto tells = [&](double limit) {
            return is_on_its_side(interval.low, low, limit) && is_on_its_side(interval.high, high, limit);
        };
        if (digits == 18 || (tells(1 - limits::least_difference) && tells(1 + limits::least_difference))) {
            return fmt::format("[{}, {}]", low, high);
        }
    }
}

std::string to_code(WordReason reason) {
    switch (reason) {
        case WordReason::few_samples:
            return "few_samples";
        case WordReason::wide:
            return "wide";
        case WordReason::contended:
            return "contended";
        case WordReason::throttled:
            return "throttled";
        case WordReason::clocks_differed:
            return "clocks_differed";
        case WordReason::no_baseline:
            return "no_baseline";
        case WordReason::baseline_not_measured:
            return "baseline_not_measured";
        case WordReason::none:
            break;
    }
    return "";
}

std::string in_words(const TimeVerdict& verdict, std::size_t samples) {
    switch (verdict.reason) {
        case WordReason::few_samples:
            return fmt::format("n = {}, a verdict needs {}", samples, limits::fewest_samples);
        case WordReason::wide:
            return fmt::format("the interval reaches both sides of a {} % limit", 100 * limits::least_difference);
        case WordReason::contended:
            return fmt::format("other processes took CPU time during more than {} of the samples",
                               limits::most_disturbed_share_said);
        case WordReason::throttled:
            return fmt::format("a CPU quota or other processes took CPU time during more than {} of the samples",
                               limits::most_disturbed_share_said);
        case WordReason::clocks_differed:
            return fmt::format("{} in time but {} in cycles: the clocks differed", to_text(verdict.in_time),
                               to_text(verdict.in_cycles.value()));
        case WordReason::no_baseline:
            return "no cell with the baseline and all else equal";
        case WordReason::baseline_not_measured:
            return "the baseline has no times";
        case WordReason::none:
            break;
    }
    return "";
}

TimeVerdict verdict_of(const RatioEstimate& ratio, const Times& times, const Times& baseline) {
    TimeVerdict verdict = verdict_of_ratio(ratio);
    verdict.in_time = verdict.word;
    if (!times.cycles.empty() && !baseline.cycles.empty()) {
        verdict.in_cycles = verdict_of_ratio(ratio_estimate(times.cycles, baseline.cycles)).word;
    }
    if (times.is_contended || baseline.is_contended) {
        verdict.word = Word::unsure;
        verdict.reason = times.is_throttled || baseline.is_throttled ? WordReason::throttled : WordReason::contended;
    } else if (verdict.word != Word::unsure && verdict.in_cycles.value_or(Word::unsure) != Word::unsure &&
               verdict.in_cycles != verdict.word) {
        verdict.word = Word::unsure;
        verdict.reason = WordReason::clocks_differed;
    }
    return verdict;
}

}  // namespace pt
