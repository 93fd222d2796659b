// Covering variants: every two choices that can go together do so in one of them, against brute force.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "tests/support/backends.h"

namespace pt {
namespace {

using Place = std::pair<std::size_t, std::string>;  // axis and choice
using Pair = std::pair<Place, Place>;

void add_pairs(const Variant& variant, std::set<Pair>& pairs) {
    for (std::size_t a = 0; a < std::size(axis_names); ++a) {
        for (std::size_t b = a + 1; b < std::size(axis_names); ++b) {
            pairs.insert({{a, variant[axis_names[a]]}, {b, variant[axis_names[b]]}});
        }
    }
}

std::set<Pair> pairs_in(const std::vector<Variant>& variants) {
    std::set<Pair> pairs;
    for (const Variant& variant : variants) {
        add_pairs(variant, pairs);
    }
    return pairs;
}

std::vector<Pair> pairs_of(const AxisChoices& axes) {
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < std::size(axis_names); ++a) {
        for (std::size_t b = a + 1; b < std::size(axis_names); ++b) {
            for (const std::string& first : axes.at(std::string(axis_names[a]))) {
                for (const std::string& second : axes.at(std::string(axis_names[b]))) {
                    pairs.push_back({{a, first}, {b, second}});
                }
            }
        }
    }
    return pairs;
}

constexpr FeatureSet plain = Feature::sphere | Feature::diffuse | Feature::emitter;
constexpr FeatureSet scenes[] = {plain, plain | Feature::jitter, plain & ~static_cast<FeatureSet>(Feature::emitter),
                                 all_features};

// All, but of devices no more than two: more of them go with what two go with.
AxisChoices choices_on(Backend backend) {
    AxisChoices axes = all_choices(backend);
    axes["devices"].resize(std::min<std::size_t>(2, axes["devices"].size()));
    return axes;
}

bool applies(const Variant& variant, FeatureSet scene, Backend backend) {
    return why_not_applicable(variant, scene, backend).empty();
}

// The covering of all choices, made once for all tests.
const std::vector<Variant>& covering(FeatureSet scene, Backend backend) {
    static std::map<std::pair<FeatureSet, Backend>, std::vector<Variant>> made;
    const auto [position, is_new] = made.try_emplace({scene, backend});
    if (is_new) {
        position->second = covering_variants(choices_on(backend), scene, backend);
    }
    return position->second;
}

TEST(CoveringTest, AllApplyAndNoneIsThereTwice) {
    for (const Backend backend : test::built_backends()) {
        for (const FeatureSet scene : scenes) {
            const std::vector<Variant>& variants = covering(scene, backend);
            std::set<std::string> names;
            for (const Variant& variant : variants) {
                EXPECT_EQ(why_not_applicable(variant, scene, backend), "") << variant.spelled_out();
                EXPECT_TRUE(variant.tuning.empty());
                EXPECT_TRUE(names.insert(variant.spelled_out()).second) << variant.spelled_out();
            }
            EXPECT_TRUE(names.contains(Registry::instance().baseline(backend).spelled_out()));
        }
    }
}

std::set<std::pair<std::string_view, std::string>> choices_in(const std::vector<Variant>& variants) {
    std::set<std::pair<std::string_view, std::string>> met;
    for (const Variant& variant : variants) {
        for (const std::string_view axis : axis_names) {
            met.emplace(axis, variant[axis]);
        }
    }
    return met;
}

TEST(CoveringTest, IsTheSameEveryTime) {
    for (const Backend backend : test::built_backends()) {
        EXPECT_EQ(covering_variants(choices_on(backend), plain, backend), covering(plain, backend));
    }
}

TEST(CoveringTest, AFewVariantsThatScenesShareHaveEveryChoice) {
    for (const Backend backend : test::built_backends()) {
        const std::vector<std::vector<Variant>> coverings{covering(plain, backend), covering(all_features, backend)};
        const std::vector<std::vector<Variant>> few = each_choice_once(coverings);
        ASSERT_EQ(few.size(), 2u);
        std::vector<Variant> all = coverings[0], chosen = few[0];
        all.insert(all.end(), coverings[1].begin(), coverings[1].end());
        chosen.insert(chosen.end(), few[1].begin(), few[1].end());
        EXPECT_EQ(choices_in(chosen), choices_in(all));
        EXPECT_LT(chosen.size(), coverings[0].size() / 4);
        for (std::size_t scene = 0; scene < 2; ++scene) {
            EXPECT_GE(few[scene].size(), chosen.size() / 3);
            for (const Variant& variant : few[scene]) {
                EXPECT_EQ(std::count(coverings[scene].begin(), coverings[scene].end(), variant), 1);
            }
            for (std::size_t i = 0; i < few[scene].size(); ++i) {  // each brings a choice that none before it has
                const auto end = few[scene].begin() + static_cast<std::ptrdiff_t>(i);
                EXPECT_GT(choices_in({few[scene].begin(), end + 1}).size(),
                          choices_in({few[scene].begin(), end}).size());
            }
        }
    }
}

// The CPU's product is small: all of it is looked at.
TEST(CoveringTest, OnTheCpuHasExactlyThePairsOfTheWholeProduct) {
    for (const FeatureSet scene : scenes) {
        AxisChoices axes = all_choices();
        axes.erase("accelerator");  // which multiply the product, for meshes only
        axes.erase("builder");
        axes.erase("levels");
        axes.erase("light_sampling");
        axes.erase("light_selection");
        axes.erase("subsurface_sampling");
        std::vector<Variant> all = expand(axes);
        std::erase_if(all, [&](const Variant& variant) { return !applies(variant, scene, Backend::cpu); });
        const std::vector<Variant> chosen = covering_variants(axes, scene, Backend::cpu);
        EXPECT_EQ(pairs_in(chosen), pairs_in(all));
        EXPECT_LT(chosen.size(), all.size() / 2);
    }
}

// Looks for an applicable variant with `most` of the other choices at the most, from a place in their order on.
std::string find_with(const Variant& variant, const std::vector<Place>& others, std::size_t from, int most,
                      FeatureSet scene, Backend backend) {
    if (applies(variant, scene, backend)) {
        return variant.spelled_out();
    }
    for (std::size_t i = from; most > 0 && i < others.size(); ++i) {
        Variant further = variant;
        further.set(axis_names[others[i].first], others[i].second);
        if (const std::string found = find_with(further, others, i + 1, most - 1, scene, backend); !found.empty()) {
            return found;
        }
    }
    return "";
}

// Looks for an applicable variant with the choices of these places: with up to four choices away from the baseline,
// these among them, then with all others at random. Returns its name, or nothing.
std::string find_completion(const std::set<Place>& places, const AxisChoices& axes, FeatureSet scene, Backend backend,
                            std::mt19937& random) {
    const Variant baseline = Registry::instance().baseline(backend);
    Variant start = baseline;
    std::set<std::size_t> taken;
    for (const auto& [axis, name] : places) {
        start.set(axis_names[axis], name);
        taken.insert(axis);
    }
    std::vector<Place> others;
    for (std::size_t axis = 0; axis < std::size(axis_names); ++axis) {
        for (const std::string& name : axes.at(std::string(axis_names[axis]))) {
            if (!taken.contains(axis) && name != baseline[axis_names[axis]]) {
                others.emplace_back(axis, name);
            }
        }
    }
    const int most = 4 - static_cast<int>(places.size());
    if (std::string found = find_with(start, others, 0, most, scene, backend); !found.empty()) {
        return found;
    }
    for (int trial = 0; trial < 2000; ++trial) {
        Variant variant = start;
        for (std::size_t axis = 0; axis < std::size(axis_names); ++axis) {
            const std::vector<std::string>& names = axes.at(std::string(axis_names[axis]));
            if (!taken.contains(axis)) {
                variant.set(axis_names[axis], names[random() % names.size()]);
            }
        }
        if (applies(variant, scene, backend)) {
            return variant.spelled_out();
        }
    }
    return "";
}

// Choices that no covering variant has. Each is searched for with three others, so all of its pairs with two.
std::set<Place> hopeless_choices(const std::set<Pair>& covered, const AxisChoices& axes, FeatureSet scene,
                                 std::mt19937& random) {
    std::set<Place> had, hopeless;
    for (const auto& [first, second] : covered) {
        had.insert({first, second});
    }
    for (std::size_t axis = 0; axis < std::size(axis_names); ++axis) {
        for (const std::string& name : axes.at(std::string(axis_names[axis]))) {
            const Place place{axis, name};
            if (!had.contains(place)) {
                EXPECT_EQ(find_completion({place}, axes, scene, Backend::cuda, random), "") << name;
                hopeless.insert(place);
            }
        }
    }
    return hopeless;
}

TEST(CoveringTest, OnCudaLeavesNoPairOutThatCanBeFound) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    AxisChoices axes = all_choices(Backend::cuda);
    axes["devices"] = {"1"};  // what several go with is in variants_test.cpp and tests/gpu/devices_test.cpp
    axes["partition"] = {"samples"};
    std::mt19937 random(20);
    for (const FeatureSet scene : scenes) {
        const std::vector<Variant> variants = covering_variants(axes, scene, Backend::cuda);
        const std::set<Pair> covered = pairs_in(variants);
        const std::set<Place> hopeless = hopeless_choices(covered, axes, scene, random);
        std::size_t left_out = 0;
        for (const Pair& pair : pairs_of(axes)) {
            if (!covered.contains(pair) && !hopeless.contains(pair.first) && !hopeless.contains(pair.second)) {
                ++left_out;
                EXPECT_EQ(find_completion({pair.first, pair.second}, axes, scene, Backend::cuda, random), "")
                    << axis_names[pair.first.first] << "=" << pair.first.second << " " << axis_names[pair.second.first]
                    << "=" << pair.second.second;
            }
        }
        // The search would be idle if nothing were left out, and the set worth nothing if it were large.
        EXPECT_GT(left_out, 50u);
        EXPECT_GT(covered.size(), 500u);
        EXPECT_LT(variants.size(), 700u);
    }
}

// Random variants that apply, found without a look at pairs: none may have a pair that is not covered.
TEST(CoveringTest, NoRandomVariantHasAPairThatIsLeftOut) {
    std::mt19937 random(21);
    for (const Backend backend : test::built_backends()) {
        AxisChoices axes = all_choices(backend);
        axes["accelerator"] = {"brute_force"};  // the others are for meshes: few random variants would apply
        axes["builder"] = {"sah_binned"};
        axes["traversal"] = {"while_while"};
        axes["traversal_stack"] = {"local"};
        axes["levels"] = {"each_object"};
        axes["light_sampling"] = {"solid_angle"};  // for few of the variants: those with connections
        axes["devices"] = {"1"};
        axes["partition"] = {"samples"};
        axes["light_selection"] = {"uniform"};
        axes["subsurface_sampling"] = {"classical"};  // for scenes with walks
        for (const FeatureSet scene : scenes) {
            const std::set<Pair> covered = pairs_in(covering_variants(axes, scene, backend));
            std::size_t found = 0;
            for (int trial = 0; trial < 150000; ++trial) {
                Variant variant;
                for (const auto& [axis, names] : axes) {
                    variant.set(axis, names[random() % names.size()]);
                }
                if (!applies(variant, scene, backend)) {
                    continue;
                }
                ++found;
                std::set<Pair> pairs;
                add_pairs(variant, pairs);
                EXPECT_TRUE(std::includes(covered.begin(), covered.end(), pairs.begin(), pairs.end()))
                    << variant.spelled_out();
            }
            EXPECT_GT(found, 100u) << to_string(backend);
        }
    }
}

TEST(CoveringTest, KeepsToTheChoicesThatAreGiven) {
    const AxisChoices axes{{"compaction", {"thrust_partition", "thrust_remove_if"}},
                           {"layout", {"soa", "aos"}},
                           {"integrator", {"depth_first", "wavefront"}}};
    const std::vector<Variant> variants = covering_variants(axes, plain, Backend::cpu);
    // depth_first has no queue: nothing goes with these compactions but a wavefront. 2 x 2 pairs, each on its own.
    ASSERT_EQ(variants.size(), 4u);
    for (const Variant& variant : variants) {
        EXPECT_EQ(variant["integrator"], "wavefront");
        EXPECT_NE(variant["compaction"], "none");
        EXPECT_EQ(variant["sorting"], "none");
        EXPECT_EQ(variant["first_bounce"], "off");
        EXPECT_EQ(variant["specialisation"], "features");
    }
    EXPECT_TRUE(covering_variants({{"first_bounce", {"cached"}}}, plain | Feature::jitter, Backend::cpu).empty());
    EXPECT_EQ(covering_variants({}, plain, Backend::cpu),
              std::vector<Variant>{Registry::instance().baseline(Backend::cpu)});
}

}  // namespace
}  // namespace pt
