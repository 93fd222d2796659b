// Covering sets of variants by greedy search (Cohen, Dalal, Fredman and Patton 1997, "The AETG system").
#include <algorithm>
#include <random>
#include <set>

#include "harness/bench/suite.h"

namespace pt {

namespace {

// A choice of an axis by numbers: the axis's index in axis_names, and the choice's index among those to cover.
struct NumberedChoice {
    std::size_t axis, choice;
};

// The choices to cover, and which pairs of choices on two axes already occur in a variant.
class Pairs {
public:
    explicit Pairs(std::vector<std::vector<std::string>> names) : names_(std::move(names)) {
        std::size_t all = 0;
        for (const std::vector<std::string>& of_axis : names_) {
            first_.push_back(all);
            all += of_axis.size();
        }
        met_.assign(all, std::vector<bool>(all));
    }

    const std::vector<std::string>& names(std::size_t axis) const { return names_[axis]; }
    bool have_met(const NumberedChoice& one, const NumberedChoice& other) const {
        return met_[place(one)][place(other)];
    }
    // The number of pairs of choices in a variant that occur in no earlier variant.
    std::size_t new_in(const Variant& variant) const {
        const std::vector<std::size_t> places = places_of(variant);
        std::size_t count = 0;
        for (std::size_t a = 0; a < places.size(); ++a) {
            for (std::size_t b = a + 1; b < places.size(); ++b) {
                count += met_[places[a]][places[b]] ? 0u : 1u;
            }
        }
        return count;
    }
    void add(const Variant& variant) {
        const std::vector<std::size_t> places = places_of(variant);
        for (std::size_t a = 0; a < places.size(); ++a) {
            for (std::size_t b = a + 1; b < places.size(); ++b) {
                met_[places[a]][places[b]] = true;
            }
        }
    }

private:
    std::size_t place(const NumberedChoice& one) const { return first_[one.axis] + one.choice; }
    std::vector<std::size_t> places_of(const Variant& variant) const {
        std::vector<std::size_t> places;
        for (std::size_t axis = 0; axis < names_.size(); ++axis) {
            const auto position = std::find(names_[axis].begin(), names_[axis].end(), variant[axis_names[axis]]);
            places.push_back(place({axis, static_cast<std::size_t>(position - names_[axis].begin())}));
        }
        return places;
    }

    std::vector<std::vector<std::string>> names_;  // names of the choices to cover, by axis
    std::vector<std::size_t> first_;               // by axis: index of the axis's first choice among all choices
    std::vector<std::vector<bool>> met_;           // whether two choices have met in a variant, by their indices
};

}  // namespace

std::vector<Variant> covering_variants(const AxisChoices& axes, FeatureSet features, Backend backend) {
    constexpr int completions = 60;  // number of variants tried for a pair of choices; all but the first are random
    std::mt19937 random(1);          // fixed seed, so that the set of variants is always the same
    const Variant baseline = expand({}, backend).front();
    std::vector<Variant> variants;
    Variant plainest = baseline;
    std::vector<std::vector<std::string>> names;
    for (const std::string_view axis : axis_names) {
        const auto position = axes.find(std::string(axis));
        names.push_back(position != axes.end() ? position->second : std::vector<std::string>{baseline[axis]});
        const bool has_baseline =
            std::find(names.back().begin(), names.back().end(), baseline[axis]) != names.back().end();
        plainest.set(axis, has_baseline ? baseline[axis] : names.back().front());
    }
    Pairs pairs(std::move(names));
    const auto cover = [&](const NumberedChoice& one, const NumberedChoice& other) {
        Variant best;
        std::size_t best_gain = 0;
        const auto consider = [&](Variant variant) {
            for (const NumberedChoice& wanted : {one, other}) {
                variant.set(axis_names[wanted.axis], pairs.names(wanted.axis)[wanted.choice]);
            }
            // Counting new pairs of choices is cheap and mostly finds none, so applicability is tested after it.
            if (const std::size_t gain = pairs.new_in(variant);
                gain > best_gain && why_not_applicable(variant, features, backend).empty()) {
                best = variant;
                best_gain = gain;
            }
        };
        for (int completion = 0; completion < completions; ++completion) {
            Variant variant = plainest;
            for (std::size_t axis = 0; axis < std::size(axis_names); ++axis) {
                // In a random candidate each axis stays at its baseline with probability 1/2, since random choices on
                // all axes would mostly exclude each other.
                if (completion > 0 && random() % 2 == 0) {
                    const std::vector<std::string>& of_axis = pairs.names(axis);
                    variant.set(axis_names[axis], of_axis[random() % of_axis.size()]);
                }
            }
            consider(variant);
        }
        // Random variants rarely contain a choice that needs several others. If none covered the pair of choices, the
        // pair is also tried with one more choice added to the baseline, and put into each variant found before.
        for (std::size_t axis = 0; axis < std::size(axis_names) && best_gain == 0; ++axis) {
            for (const std::string& name : pairs.names(axis)) {
                Variant variant = plainest;
                variant.set(axis_names[axis], name);
                consider(variant);
            }
        }
        for (std::size_t i = 0; i < variants.size() && best_gain == 0; ++i) {
            consider(variants[i]);
        }
        if (best_gain > 0) {
            variants.push_back(best);
            pairs.add(best);
        }
    };
    for (std::size_t a = 0; a < std::size(axis_names); ++a) {
        for (std::size_t b = a + 1; b < std::size(axis_names); ++b) {
            for (std::size_t first = 0; first < pairs.names(a).size(); ++first) {
                for (std::size_t second = 0; second < pairs.names(b).size(); ++second) {
                    if (!pairs.have_met({a, first}, {b, second})) {
                        cover({a, first}, {b, second});
                    }
                }
            }
        }
    }
    return variants;
}

namespace {

using SeenChoices = std::set<std::pair<std::string_view, std::string>>;

std::ptrdiff_t unseen_in(const Variant& variant, const SeenChoices& seen) {
    return std::count_if(std::begin(axis_names), std::end(axis_names), [&](std::string_view axis) {
        return !seen.contains({axis, variant[axis]});
    });
}

void add_choices(const Variant& variant, SeenChoices& seen) {
    for (const std::string_view axis : axis_names) {
        seen.insert({axis, variant[axis]});
    }
}

}  // namespace

// Selects variants greedily. The scenes take turns; a scene's next variant is its first one with the most choices that
// no selected variant has yet.
std::vector<std::vector<Variant>> each_choice_once(std::vector<std::vector<Variant>> left) {
    SeenChoices seen;
    std::vector<std::vector<Variant>> variants(left.size());
    for (std::size_t turn = 0, without = 0; without < left.size(); ++turn) {
        const std::size_t scene = turn % left.size();
        std::vector<Variant>& of_scene = left[scene];
        const auto best = std::max_element(of_scene.begin(), of_scene.end(), [&](const Variant& a, const Variant& b) {
            return unseen_in(a, seen) < unseen_in(b, seen);
        });
        if (best == of_scene.end() || unseen_in(*best, seen) == 0) {
            without += 1;
            continue;
        }
        without = 0;
        add_choices(*best, seen);
        variants[scene].push_back(*best);
        of_scene.erase(best);
    }
    return variants;
}

}  // namespace pt
