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
    Variant plainest = baseline;
    for (const std::string_view axis : axis_names) {
        const std::vector<std::string> names = choices(axis);
        const bool has_baseline = std::find(names.begin(), names.end(), baseline[axis]) != names.end();
        plainest.set(axis, has_baseline ? baseline[axis] : names.front());
    }
    const auto cover = [&](const Pair& pair) {
        Variant best;
        std::size_t best_gain = 0;
        const auto consider = [&](Variant variant) {
            variant.set(pair.first.first, pair.first.second);
            variant.set(pair.second.first, pair.second.second);
            if (!why_not_applicable(variant, features, backend).empty()) {
                return;
            }
            if (const std::size_t gain = uncovered(variant, covered); gain > best_gain) {
                best = variant;
                best_gain = gain;
            }
        };
        for (int completion = 0; completion < completions; ++completion) {
            Variant variant = plainest;
            for (const std::string_view axis : axis_names) {
                // Half of the axes stay where they are in the baseline: choices exclude each other too often.
                if (completion > 0 && random() % 2 == 0) {
                    const std::vector<std::string> names = choices(axis);
                    variant.set(axis, names[random() % names.size()]);
                }
            }
            consider(variant);
        }
        // A choice that needs several others is rarely met by chance: one more step from the baseline, or from a
        // variant that has what it needs.
        for (std::size_t i = 0; i < std::size(axis_names) && best_gain == 0; ++i) {
            for (const std::string& name : choices(axis_names[i])) {
                Variant variant = plainest;
                variant.set(axis_names[i], name);
                consider(variant);
            }
        }
        for (std::size_t i = 0; i < variants.size() && best_gain == 0; ++i) {
            consider(variants[i]);
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

// Greedily: next comes the variant with the most choices that have not been seen, and of several the first.
std::vector<Variant> each_choice_once(std::vector<Variant> left) {
    std::set<std::pair<std::string_view, std::string>> seen;
    const auto unseen = [&](const Variant& variant) {
        return std::count_if(std::begin(axis_names), std::end(axis_names), [&](std::string_view axis) {
            return !seen.contains({axis, variant[axis]});
        });
    };
    std::vector<Variant> variants;
    while (!left.empty()) {
        const auto best = std::max_element(left.begin(), left.end(),
                                           [&](const Variant& a, const Variant& b) { return unseen(a) < unseen(b); });
        if (unseen(*best) == 0) {
            break;
        }
        for (const std::string_view axis : axis_names) {
            seen.insert({axis, (*best)[axis]});
        }
        variants.push_back(*best);
        left.erase(best);
    }
    return variants;
}

}  // namespace pt
