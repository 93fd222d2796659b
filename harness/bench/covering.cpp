// A covering set of variants by greedy search: Cohen, Dalal, Fredman and Patton 1997 ("The AETG system").
#include <algorithm>
#include <random>
#include <set>

#include "harness/bench/suite.h"

namespace pt {

namespace {

using Pair = std::pair<std::pair<std::string_view, std::string>, std::pair<std::string_view, std::string>>;

std::vector<Pair> pairs_of(const Variant& variant) {
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < std::size(axis_names); ++a) {
        for (std::size_t b = a + 1; b < std::size(axis_names); ++b) {
            pairs.push_back({{axis_names[a], variant[axis_names[a]]}, {axis_names[b], variant[axis_names[b]]}});
        }
    }
    return pairs;
}

std::size_t uncovered(const Variant& variant, const std::set<Pair>& covered) {
    const std::vector<Pair> pairs = pairs_of(variant);
    return static_cast<std::size_t>(
        std::count_if(pairs.begin(), pairs.end(), [&](const Pair& pair) { return !covered.contains(pair); }));
}

}  // namespace

std::vector<Variant> covering_variants(const AxisChoices& axes, FeatureSet features, Backend backend) {
    constexpr int completions = 60;  // tried for a pair; the baseline's is one of them
    std::mt19937 random(1);          // the set is the same every time
    const Variant baseline = expand({}, backend).front();
    std::set<Pair> covered;
    std::vector<Variant> variants;
    const auto choices = [&](std::string_view axis) {
        const auto position = axes.find(std::string(axis));
        return position != axes.end() ? position->second : std::vector<std::string>{baseline[axis]};
    };
    const auto cover = [&](const Pair& pair) {
        Variant best;
        std::size_t best_gain = 0;
        for (int completion = 0; completion < completions; ++completion) {
            Variant variant = baseline;
            for (const std::string_view axis : axis_names) {
                const std::vector<std::string> names = choices(axis);
                // Half of the axes stay where they are in the baseline: choices exclude each other too often.
                const bool at_random = completion > 0 && random() % 2 == 0;
                const bool has_baseline = std::find(names.begin(), names.end(), baseline[axis]) != names.end();
                variant.set(axis, at_random      ? names[random() % names.size()]
                                  : has_baseline ? baseline[axis]
                                                 : names.front());
            }
            variant.set(pair.first.first, pair.first.second);
            variant.set(pair.second.first, pair.second.second);
            if (!why_not_applicable(variant, features, backend).empty()) {
                continue;
            }
            if (const std::size_t gain = uncovered(variant, covered); gain > best_gain) {
                best = variant;
                best_gain = gain;
            }
        }
        if (best_gain > 0) {
            variants.push_back(best);
            for (const Pair& done : pairs_of(best)) {
                covered.insert(done);
            }
        }
    };
    for (std::size_t a = 0; a < std::size(axis_names); ++a) {
        for (std::size_t b = a + 1; b < std::size(axis_names); ++b) {
            for (const std::string& first : choices(axis_names[a])) {
                for (const std::string& second : choices(axis_names[b])) {
                    const Pair pair{{axis_names[a], first}, {axis_names[b], second}};
                    if (!covered.contains(pair)) {
                        cover(pair);
                    }
                }
            }
        }
    }
    return variants;
}

}  // namespace pt
