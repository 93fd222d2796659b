#include "harness/bench/bootstrap.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pt {

std::uint32_t BootstrapRandom::next() {
    if (high_half_) {
        const std::uint32_t half = *high_half_;
        high_half_.reset();
        return half;
    }
    constexpr State multiplier = (State{0x2360ed051fc65da4u} << 64) | 0x4385df649fccf645u;
    state_ = state_ * multiplier + increment_;
    const auto high = static_cast<std::uint64_t>(state_ >> 64), low = static_cast<std::uint64_t>(state_);
    const auto turn = static_cast<unsigned>(high >> 58);
    const std::uint64_t folded = high ^ low;
    const std::uint64_t bits = (folded >> turn) | (folded << ((64 - turn) & 63));
    high_half_ = static_cast<std::uint32_t>(bits >> 32);
    return static_cast<std::uint32_t>(bits);
}

std::uint32_t BootstrapRandom::below(std::uint32_t count) {
    if (count == 1) {
        return 0;  // drawn from nothing
    }
    std::uint64_t product = std::uint64_t{next()} * count;
    if (static_cast<std::uint32_t>(product) < count) {
        const std::uint32_t threshold = (0u - count) % count;
        while (static_cast<std::uint32_t>(product) < threshold) {
            product = std::uint64_t{next()} * count;
        }
    }
    return static_cast<std::uint32_t>(product >> 32);
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return values.size() % 2 != 0 ? *middle : (*std::max_element(values.begin(), middle) + *middle) / 2;
}

namespace {

std::vector<double> resampled_medians(const std::vector<double>& values, BootstrapRandom& random) {
    std::vector<double> medians(resamples), drawn(values.size());
    for (double& median : medians) {
        for (double& value : drawn) {
            value = values[random.below(static_cast<std::uint32_t>(values.size()))];
        }
        median = median_of(drawn);
    }
    return medians;
}

// A percentile of sorted values, linear between the two values that it lies between, from the nearer of them, as
// numpy.percentile has it.
double percentile(const std::vector<double>& sorted, double percent) {
    const double place = static_cast<double>(sorted.size() - 1) * (percent / 100);
    const auto below = static_cast<std::size_t>(place);
    const double part = place - std::floor(place);
    const double low = sorted[below], high = sorted[std::min(below + 1, sorted.size() - 1)];
    return part >= 0.5 ? high - (high - low) * (1 - part) : low + (high - low) * part;
}

// Whether `text` lies on the same side of a limit as the value that it shows.
bool is_on_its_side(double value, const std::string& text, double limit) {
    const double shown = std::stod(text);
    return (value < limit) == (shown < limit) && (value > limit) == (shown > limit);
}

std::string one_side_text(const TimeVerdict& time, const TimeVerdict& cycles) {
    return fmt::format("{} in time but {} in cycles: the clocks differed", to_text(time.word), to_text(cycles.word));
}

TimeVerdict verdict_of_ratio(const RatioEstimate& ratio) {
    if (ratio.samples < fewest_samples || !ratio.interval) {
        return {Word::unsure, fmt::format("n = {}, a verdict needs {}", ratio.samples, fewest_samples)};
    }
    const Word word = word_of(*ratio.interval);
    return {word, word == Word::unsure ? "the interval reaches both sides of a 1 % limit" : ""};
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
    const double tail = 50 * (1 - 0.95);
    estimate.interval = {percentile(ratios, tail), percentile(ratios, 100 - tail)};
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
    const double lower = 1 - least_difference, upper = 1 + least_difference;
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
        if (digits == 18 || (tells(1 - least_difference) && tells(1 + least_difference))) {
            return fmt::format("[{}, {}]", low, high);
        }
    }
}

TimeVerdict verdict_of(const RatioEstimate& ratio, const Times& times, const Times& baseline) {
    if (times.is_contended || baseline.is_contended) {
        const bool has_quota = times.is_throttled || baseline.is_throttled;
        return {Word::unsure,
                has_quota ? "a CPU quota or other processes took CPU time during more than a tenth of the samples"
                          : "other processes took CPU time during more than a tenth of the samples"};
    }
    const TimeVerdict in_time = verdict_of_ratio(ratio);
    if (times.cycles.empty() || baseline.cycles.empty() || in_time.word == Word::unsure) {
        return in_time;
    }
    const TimeVerdict in_cycles = verdict_of_ratio(ratio_estimate(times.cycles, baseline.cycles));
    const bool agree = in_cycles.word == Word::unsure || in_cycles.word == in_time.word;
    return agree ? in_time : TimeVerdict{Word::unsure, one_side_text(in_time, in_cycles)};
}

}  // namespace pt
