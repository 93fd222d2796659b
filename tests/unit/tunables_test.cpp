// Numbers that choices may be tuned by: which a variant has, what they are where nothing is asked for, how they expand,
// and what a reference keeps of them.
#include <set>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "tests/support/backends.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

constexpr FeatureSet jittered = Feature::sphere | Feature::emitter | Feature::jitter;

Variant variant_with(const std::vector<std::pair<std::string, std::string>>& choices,
                     const std::map<std::string, std::uint32_t, std::less<>>& tuning = {},
                     Backend backend = Backend::cpu) {
    Variant variant = Registry::instance().baseline(backend);
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    variant.tuning = tuning;
    return variant;
}

std::vector<std::string> names_of(const std::vector<Tunable>& tunables) {
    std::vector<std::string> names;
    for (const Tunable& tunable : tunables) {
        names.emplace_back(tunable.name);
    }
    return names;
}

TEST(TunableTest, AllowsItsRangeInItsSteps) {
    constexpr Tunable block{"block", 128, 32, 1024, 32};
    for (const std::uint32_t good : {32u, 64u, 128u, 1024u}) {
        EXPECT_TRUE(block.allows(good)) << good;
    }
    for (const std::uint32_t bad : {0u, 31u, 33u, 48u, 1023u, 1056u, 0xffffffffu}) {
        EXPECT_FALSE(block.allows(bad)) << bad;
    }
    constexpr Tunable flag{"flag", 0, 0, 1};
    EXPECT_TRUE(flag.allows(0));
    EXPECT_TRUE(flag.allows(1));
    EXPECT_FALSE(flag.allows(2));
}

TEST(TunableTest, AVariantHasThoseOfItsChoices) {
    EXPECT_EQ(names_of(tunables_of(variant_with({}), Backend::cpu)), std::vector<std::string>{"room"});
    EXPECT_TRUE(tunables_of(variant_with({{"specialisation", "generic"}}), Backend::cpu).empty());
    EXPECT_EQ(names_of(tunables_of(variant_with({{"first_bounce", "cached_jitters"}}), Backend::cpu)),
              (std::vector<std::string>{"jitters", "room"}));
    EXPECT_EQ(names_of(all_tunables(Backend::cpu)),
              (std::vector<std::string>{"jitters", "mis_exponent", "adjoint_paths", "adjoint_cells", "weight_window",
                                        "most_branches", "roulette_start", "room", "near_light", "guided_percent"}));
    if (!test::cuda_is_built()) {
        return;
    }
    const Variant queue =
        variant_with({{"first_bounce", "cached_jitters"}, {"compaction", "cub_select_if"}}, {}, Backend::cuda);
    std::vector<std::string> expected;  // those of the integrator first
    for (const char* axis : {"integrator", "compaction", "first_bounce", "specialisation"}) {
        for (const Tunable& tunable : Registry::instance().at(axis, queue, Backend::cuda).descriptor.tunables) {
            expected.emplace_back(tunable.name);
        }
    }
    EXPECT_EQ(names_of(tunables_of(queue, Backend::cuda)), expected);
    EXPECT_EQ(expected.front(), "block");
    EXPECT_EQ(expected.back(), "room");
    EXPECT_EQ(expected[expected.size() - 2], "jitters");
    EXPECT_EQ(expected[expected.size() - 3], "payload");
    const std::vector<std::string> loop =
        names_of(tunables_of(variant_with({{"integrator", "persistent"}}, {}, Backend::cuda), Backend::cuda));
    EXPECT_EQ(loop,
              (std::vector<std::string>{"block", "shading_fmas", "min_blocks", "regenerate_at", "piece", "room"}));
    const std::vector<std::string> all = names_of(all_tunables(Backend::cuda));
    const std::set<std::string> once(all.begin(), all.end());
    EXPECT_EQ(once.size(), all.size());
    for (const char* name : {"block", "shading_fmas", "spp_in_flight", "read_back", "payload", "caching_allocator",
                             "par_nosync", "jitters"}) {
        EXPECT_TRUE(once.contains(name)) << name;
    }
}

// The bound that helps a queue's kernels made for a scene would have a kernel with every feature spill its registers.
TEST(TunableTest, AQueuesKernelWithEveryFeatureHasNoBoundOnItsRegisters) {
    if (!test::cuda_is_built()) {
        return;
    }
    const auto bound = [](const char* integrator, const char* specialisation) {
        return tunable(
            variant_with({{"integrator", integrator}, {"specialisation", specialisation}}, {}, Backend::cuda),
            "min_blocks", Backend::cuda);
    };
    for (const char* integrator : {"wavefront", "wavefront_fused"}) {
        EXPECT_EQ(bound(integrator, "features"), 4u);
        EXPECT_EQ(bound(integrator, "generic"), 0u);
    }
    EXPECT_EQ(bound("persistent", "generic"), bound("persistent", "features"));
    // One variant has one name: the default value is not in it, any other is.
    const std::vector<Variant> found = expand({{"integrator", {"wavefront"}}, {"specialisation", {"generic"}}},
                                              Backend::cuda, {{"min_blocks", {0, 4}}});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_TRUE(found[0].tuning.empty());
    EXPECT_EQ(found[1].tuning.at("min_blocks"), 4u);
}

// Choices of one axis may differ in what they make of a name; those of two axes meet in a variant, where a name has one
// value.
TEST(TunableTest, ANameIsOneTunableInAVariant) {
    for (const Backend backend : all_backends) {
        std::map<std::string_view, std::pair<std::string_view, Tunable>> seen;  // by name: the axis where it was met
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                for (const Tunable& tunable : choice->descriptor.tunables) {
                    const auto& [first_axis, first] = seen.try_emplace(tunable.name, axis, tunable).first->second;
                    EXPECT_TRUE(first_axis == axis ||
                                (first.default_value == tunable.default_value && first.lowest == tunable.lowest &&
                                 first.highest == tunable.highest && first.multiple_of == tunable.multiple_of))
                        << tunable.name << " of " << choice->descriptor.name;
                }
            }
        }
    }
}

TEST(TunableTest, IsAtItsStandardUnlessTuned) {
    EXPECT_EQ(tunable(variant_with({{"first_bounce", "cached_jitters"}}), "jitters", Backend::cpu), 16u);
    EXPECT_EQ(tunable(variant_with({{"first_bounce", "cached_jitters"}}, {{"jitters", 5}}), "jitters", Backend::cpu),
              5u);
    try {
        tunable(variant_with({}), "jitters", Backend::cpu);
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_EQ(error.what(), shown_name(variant_with({}), Backend::cpu) + " has no tunable jitters");
    }
}

TEST(TunableTest, DecidesHowManyCameraRaysAreKept) {
    const auto kept = [](const Variant& variant) {
        return Registry::instance().at("first_bounce", variant).hook.first_bounce(variant, Backend::cpu);
    };
    EXPECT_EQ(kept(variant_with({})), 0u);
    EXPECT_EQ(kept(variant_with({{"first_bounce", "cached"}})), 1u);
    EXPECT_EQ(kept(variant_with({{"first_bounce", "cached_jitters"}})), 16u);
    EXPECT_EQ(kept(variant_with({{"first_bounce", "cached_jitters"}}, {{"jitters", 4096}})), 4096u);
}

// ---- What applies ----

TEST(TunableTest, OneThatNoChoiceHasDoesNotApply) {
    EXPECT_EQ(why_not_applicable(variant_with({{"first_bounce", "cached_jitters"}}, {{"jitters", 4}}), jittered), "");
    EXPECT_EQ(why_not_applicable(variant_with({}, {{"jitters", 4}}), jittered),
              "jitters=4 tunes none of the variant's choices");
    EXPECT_EQ(why_not_applicable(variant_with({{"first_bounce", "cached_jitters"}}, {{"block", 256}}), jittered),
              "block=256 tunes none of the variant's choices");
    EXPECT_EQ(why_not_applicable(variant_with({{"first_bounce", "cached_jitters"}}, {{"jitters", 4097}}), jittered),
              "jitters=4097 is out of its range");
    // What its choices say comes first.
    EXPECT_EQ(why_not_applicable(variant_with({{"first_bounce", "cached"}}, {{"jitters", 4}}), jittered),
              "first_bounce=cached needs jitter off (camera.jitter is true in the scene)");
}

TEST(TunableTest, ItsRangeIsThatOfTheVariantsOwnChoice) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    EXPECT_EQ(why_not_applicable(variant_with({}, {{"spp_in_flight", 512}}, Backend::cuda), jittered, Backend::cuda),
              "spp_in_flight=512 is out of its range");
    EXPECT_EQ(why_not_applicable(variant_with({{"integrator", "megakernel"}}, {{"spp_in_flight", 512}}, Backend::cuda),
                                 jittered, Backend::cuda),
              "");
    EXPECT_EQ(why_not_applicable(variant_with({{"integrator", "persistent"}}, {{"spp_in_flight", 2}}, Backend::cuda),
                                 jittered, Backend::cuda),
              "spp_in_flight=2 tunes none of the variant's choices");
}

// ---- Expansion ----

TEST(TunableTest, ExpandsToEveryValueAndLeavesTheStandardOut) {
    const std::vector<Variant> variants =
        expand({{"first_bounce", {"off", "cached_jitters"}}}, Backend::cpu, {{"jitters", {4, 16, 5}}});
    ASSERT_EQ(variants.size(), 6u);
    const std::string off = "wavefront";
    const std::string kept = "wavefront first_bounce=cached_jitters";
    const std::string expected[] = {off + " jitters=4",  off,  off + " jitters=5",
                                    kept + " jitters=4", kept, kept + " jitters=5"};
    for (std::size_t i = 0; i < variants.size(); ++i) {
        EXPECT_EQ(shown_name(variants[i], Backend::cpu), expected[i]);
    }
    EXPECT_EQ(variants[4], variant_with({{"first_bounce", "cached_jitters"}}));  // nothing to tell them apart
    EXPECT_TRUE(expand({}, Backend::cpu, {{"jitters", {16}}})[0].tuning.empty());
}

// A block of 128 threads may be one integrator's standard and not another's.
TEST(TunableTest, TheStandardThatIsLeftOutIsThatOfTheVariantsOwnChoice) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const std::vector<std::uint32_t> values{64, 128, 256, 512};
    const std::vector<Variant> variants =
        expand({{"integrator", all_choices(Backend::cuda).at("integrator")}}, Backend::cuda, {{"block", values}});
    ASSERT_EQ(variants.size(), 9u * values.size());
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const std::uint32_t asked = values[i % values.size()];
        EXPECT_EQ(tunable(variants[i], "block", Backend::cuda), asked) << variants[i].spelled_out();
        EXPECT_EQ(variants[i].tuning.contains("block"),
                  asked != tunable(variant_with({{"integrator", variants[i]["integrator"]}}, {}, Backend::cuda),
                                   "block", Backend::cuda))
            << variants[i].spelled_out();
    }
}

TEST(TunableTest, ExpandsToTheProductOfSeveral) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const std::uint32_t standard = tunable(variant_with({}, {}, Backend::cuda), "block", Backend::cuda);
    ASSERT_NE(standard, 64u);
    const std::vector<Variant> variants =
        expand({{"compaction", {"none", "thrust_partition"}}}, Backend::cuda,
               {{"block", {64, standard}}, {"caching_allocator", {0, 1}}, {"spp_in_flight", {4}}});
    ASSERT_EQ(variants.size(), 2u * 2u * 2u);
    std::set<std::string> names;
    std::size_t applicable = 0;
    for (const Variant& variant : variants) {
        EXPECT_TRUE(names.insert(shown_name(variant, Backend::cuda)).second) << variant.spelled_out();
        EXPECT_EQ(variant.tuning.at("spp_in_flight"), 4u);
        EXPECT_FALSE(variant.tuning.contains("block") && variant.tuning.at("block") == standard);
        const std::string reason = why_not_applicable(variant, jittered, Backend::cuda);
        const bool caches = variant.tuning.contains("caching_allocator");
        EXPECT_EQ(reason, caches && variant["compaction"] == "none"
                              ? "caching_allocator=1 tunes none of the variant's choices"
                              : "");
        applicable += reason.empty() ? 1u : 0u;
    }
    EXPECT_EQ(applicable, 6u);
    EXPECT_TRUE(names.contains("wavefront compaction=thrust_partition block=64 caching_allocator=1 spp_in_flight=4"));
}

// ---- References ----

TEST(TunableTest, AReferenceKeepsThoseOfChoicesThatDoNotClaimBits) {
    const Registry& registry = Registry::instance();
    const Variant kept = registry.reference(variant_with({{"first_bounce", "cached_jitters"}}, {{"jitters", 4}}));
    EXPECT_EQ(shown_name(kept, Backend::cpu),
              "depth_first first_bounce=cached_jitters specialisation=generic jitters=4");
    EXPECT_EQ(registry.reference(kept), kept);
    // The reference loses tunables of no choice, or of one that claims bits.
    EXPECT_TRUE(registry.reference(variant_with({}, {{"jitters", 4}})).tuning.empty());
    if (test::cuda_is_built()) {
        const Variant variant =
            variant_with({{"first_bounce", "cached_jitters"}, {"compaction", "thrust_partition"}},
                         {{"jitters", 4}, {"block", 256}, {"par_nosync", 1}, {"spp_in_flight", 8}}, Backend::cuda);
        const Variant reference = registry.reference(variant, Backend::cuda);
        EXPECT_EQ(shown_name(reference, Backend::cuda), "megakernel first_bounce=cached_jitters jitters=4 room=0");
        EXPECT_EQ(registry.reference(reference, Backend::cuda), reference);
        EXPECT_EQ(exact_twin(variant, Backend::cuda).tuning, variant.tuning);
    }
}

}  // namespace
}  // namespace pt
