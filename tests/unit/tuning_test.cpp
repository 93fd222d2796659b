// Values of tunables that were found to be fastest: the file that keeps them, the variants that get them, and what is
// worth trying.
#include "harness/bench/tuning.h"

#include <algorithm>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"
#include "harness/failure.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

const std::string plain = "wavefront";
const std::string kept = "wavefront first_bounce=cached_jitters";

// The identity of a variant by its test name, which is plain, kept, or that of no variant.
std::string id_of(const std::string& name) {
    Variant variant = Registry::instance().baseline();
    if (name == kept) {
        variant.set("first_bounce", "cached_jitters");
    }
    return name == plain || name == kept ? variant_id(variant, Backend::cpu) : name;
}

TunedVariant tuned(const std::string& variant, const std::map<std::string, std::uint32_t>& values) {
    return {.variant = variant,
            .id = id_of(variant),
            .values = values,
            .scene = "cornell_open",
            .width = 800,
            .height = 600,
            .depth = 8,
            .spp = 16,
            .standard_ms = 0.1 + 0.2,  // has no short decimal form
            .tuned_ms = 0.25};
}

Variant variant_with(const std::string& axis, const std::string& choice,
                     const std::map<std::string, std::uint32_t, std::less<>>& tuning = {}) {
    Variant variant = Registry::instance().baseline();
    variant.set(axis, choice);
    variant.tuning = tuning;
    return variant;
}

void expect_same(const TunedVariant& a, const TunedVariant& b) {
    EXPECT_EQ(a.variant, b.variant);
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.values, b.values);
    EXPECT_EQ(a.scene, b.scene);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.spp, b.spp);
    EXPECT_EQ(a.standard_ms, b.standard_ms);
    EXPECT_EQ(a.tuned_ms, b.tuned_ms);
}

// ---- Files ----

class TuningFileTest : public testing::Test {
protected:
    const test::TemporaryFolder folder;
    const std::string file = folder.file("tuning.json");

    // The message of what the file's text is refused with; empty: it is none.
    std::string refusal(const std::string& text) const {
        test::write_text(file, text);
        try {
            (void)Tuning::load(file, Backend::cpu);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
    // A file of one entry, right but for the keys that are given otherwise (null: left out).
    static std::string file_with(const nlohmann::json& otherwise) {
        nlohmann::json entry{{"variant", plain},
                             {"variant_id", id_of(plain)},
                             {"tunables", {{"room", 0}}},
                             {"scene", "cornell_open"},
                             {"resolution", {8, 6}},
                             {"depth", 8},
                             {"spp", 1},
                             {"standard_ms", 2},
                             {"tuned_ms", 1.5}};
        entry.merge_patch(otherwise);
        return nlohmann::json{{"machine", "m"}, {"entries", {entry}}}.dump();
    }
};

TEST_F(TuningFileTest, WhatIsSavedIsLoaded) {
    Tuning tuning;
    tuning.put(tuned(plain, {{"room", 0}}));
    tuning.put(tuned(kept, {{"room", 0}}));
    tuning.put(tuned("of another build", {}));
    tuning.save(file, "amd-epyc");
    const Tuning loaded = Tuning::load(file, Backend::cpu);
    ASSERT_EQ(loaded.entries().size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        expect_same(loaded.entries()[i], tuning.entries()[i]);
    }
    EXPECT_EQ(nlohmann::json::parse(test::content_of(file)).at("machine"), "amd-epyc");
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tuning.json"});
}

TEST_F(TuningFileTest, AVariantHasOneEntryTheLast) {
    Tuning tuning;
    tuning.put(tuned(plain, {{"room", 0}}));
    tuning.put(tuned(kept, {{"jitters", 64}}));
    tuning.put(tuned(plain, {{"room", 1}}));
    ASSERT_EQ(tuning.entries().size(), 2u);
    expect_same(tuning.entries()[0], tuned(plain, {{"room", 1}}));
    ASSERT_NE(tuning.find(id_of(kept)), nullptr);
    expect_same(*tuning.find(id_of(kept)), tuned(kept, {{"jitters", 64}}));
    EXPECT_EQ(tuning.find("never tuned"), nullptr);
}

// Files that are older than identities spell every choice.
TEST_F(TuningFileTest, AnOlderFilesVariantIsFoundByItsChoices) {
    test::write_text(
        file, file_with({{"variant",
                          "wavefront.none.none.material.cached_jitters.off.off.pcg4d.aos.features.stream.exact.float."
                          "robust"},
                         {"variant_id", nullptr}}));
    const Tuning loaded = Tuning::load(file, Backend::cpu);
    ASSERT_EQ(loaded.entries().size(), 1u);
    EXPECT_EQ(loaded.entries()[0].id, id_of(kept));
}

TEST_F(TuningFileTest, AnAbsentFileIsEmpty) {
    EXPECT_TRUE(Tuning::load(file, Backend::cpu).entries().empty());
    EXPECT_TRUE(Tuning::load(folder.file("no/such/folder.json"), Backend::cpu).entries().empty());
    EXPECT_EQ(folder.content(), std::vector<std::string>());
}

TEST_F(TuningFileTest, RefusesBadFilesWithTheirPlace) {
    ASSERT_EQ(refusal(file_with({{"depth", 4}})), "");
    const auto entry = [](const char* otherwise) { return file_with(nlohmann::json::parse(otherwise)); };
    const std::pair<std::string, std::string> cases[] = {
        {"{", "not valid JSON: "},
        {"[]", "$: found [], allowed: an object"},
        {R"({"machine": "m"})", "$: found no key \"entries\", allowed: it is required"},
        {R"({"entries": {}})", "$.entries: found an object, allowed: an array"},
        {R"({"entries": [], "colour": 1})", "$: found unknown key \"colour\", allowed: machine, entries"},
        {R"({"entries": [7]})", "$.entries[0]: found 7, allowed: an object"},
        {entry(R"({"variant": 7})"), "$.entries[0].variant: found 7, allowed: a string"},
        {entry(R"({"variant": "of.fewer.axes", "variant_id": null})"),
         "$.entries[0].variant: found \"of.fewer.axes\", allowed: a variant's name with a choice for each of the 14 "
         "axes"},
        {entry(R"({"colour": 7})"),
         "$.entries[0]: found unknown key \"colour\", allowed: variant, variant_id, tunables, "},
        {entry(R"({"tunables": [1]})"), "$.entries[0].tunables: found [1], allowed: an object"},
        {entry(R"({"tunables": {"colour": 4}})"), "$.entries[0].tunables.colour: found "},
        {entry(R"({"tunables": {"room": 0.5}})"), "$.entries[0].tunables.room: found 0.5, allowed: a whole number"},
        {entry(R"({"tunables": {"room": -1}})"), "$.entries[0].tunables.room: found -1, allowed: a whole number"},
        {entry(R"({"resolution": [8, 6, 1]})"), "$.entries[0].resolution: found [8,6,1], allowed: [width, height]"},
        {entry(R"({"resolution": 8})"), "$.entries[0].resolution: found 8, allowed: an array"},
        {entry(R"({"resolution": [8, "6"]})"), "$.entries[0].resolution[1]: found \"6\", allowed: a whole number"},
        {entry(R"({"depth": 4294967296})"), "$.entries[0].depth: found 4294967296, allowed: a whole number"},
        {entry(R"({"tuned_ms": -1})"), "$.entries[0].tuned_ms: found -1, allowed: milliseconds"},
    };
    for (const auto& [text, message] : cases) {
        const std::string refused = refusal(text);
        EXPECT_EQ(refused.find(file + ": " + message), 0u) << text << "\n" << refused;
        EXPECT_EQ(refused.find('\n'), std::string::npos);
    }
    for (const char* key : {"variant", "tunables", "scene", "resolution", "depth", "spp", "standard_ms", "tuned_ms"}) {
        EXPECT_EQ(refusal(file_with({{key, nullptr}})),
                  file + ": $.entries[0]: found no key \"" + key + "\", allowed: it is required");
    }
}

// `render` takes the values as they are: one that no choice allows must not get there.
// How many camera rays are kept is part of what is measured: no search may have set it.
TEST_F(TuningFileTest, RefusesATunableThatSetsTheWork) {
    Tuning tuning;
    tuning.put(tuned(kept, {{"jitters", 64}}));
    tuning.save(file, "amd-epyc");
    try {
        (void)Tuning::load(file, Backend::cpu);
        ADD_FAILURE() << "taken";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("$.entries[0].tunables.jitters: found 64"), std::string::npos)
            << error.what();
    }
}

TEST_F(TuningFileTest, RefusesAValueThatNoChoiceAllows) {
    const std::string refused = refusal(file_with({{"tunables", {{"room", 2}}}}));
    EXPECT_EQ(refused.find(file + ": $.entries[0].tunables.room: found 2, allowed: "), 0u) << refused;
}

// ---- Variants ----

TEST(TunedVariantTest, GetsTheValuesThatWereFoundForIt) {
    Tuning tuning;
    tuning.put(tuned(plain, {{"room", 0}}));
    tuning.put(tuned(kept, {{"jitters", 64}, {"room", 0}}));
    EXPECT_EQ(shown_name(tuning.applied(Registry::instance().baseline(), {}), Backend::cpu), plain + " room=0");
    EXPECT_EQ(shown_name(tuning.applied(variant_with("first_bounce", "cached_jitters"), {}), Backend::cpu),
              kept + " jitters=64 room=0");
    // Another variant stays as it is, and nothing is tuned where nothing was found.
    EXPECT_EQ(tuning.applied(variant_with("layout", "soa"), {}), variant_with("layout", "soa"));
    EXPECT_EQ(Tuning().applied(Registry::instance().baseline(), {}), Registry::instance().baseline());
}

TEST(TunedVariantTest, KeepsWhatIsAskedFor) {
    Tuning tuning;
    tuning.put(tuned(kept, {{"jitters", 64}, {"room", 0}}));
    const Variant asked = variant_with("first_bounce", "cached_jitters", {{"jitters", 4}});
    // The entry is that of the variant with every tunable at its standard.
    EXPECT_EQ(shown_name(tuning.applied(asked, {}), Backend::cpu), kept + " jitters=4 room=0");
    EXPECT_EQ(tuning.applied(asked, {"room"}), asked);
    // Named, and asked for at its standard.
    const Variant standard = variant_with("first_bounce", "cached_jitters");
    EXPECT_EQ(shown_name(tuning.applied(standard, {"jitters"}), Backend::cpu), kept + " room=0");
    EXPECT_EQ(tuning.applied(standard, {"jitters", "room"}), standard);
}

TEST(TunedVariantTest, ItsCellsSayItInTheirNames) {
    ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
    Tuning tuning;
    tuning.put(tuned(plain, {{"room", 0}}));
    Study study;
    study.name = "a";
    study.scenes = {"cornell_open"};
    study.axes = {{"layout", {"aos", "soa"}}};
    study.width = 8;
    study.height = 6;
    const auto names = [&](const Tuning& with) {
        std::vector<std::string> all;
        for (const Cell& cell :
             make_plan({.name = "s", .description = "", .studies = {study}}, Backend::cpu, with).cells) {
            EXPECT_EQ(cell.name.find(benchmark_name(cell.variant, Backend::cpu) + "/"), 0u);
            all.push_back(cell.name);
        }
        return all;
    };
    const std::string settings = "/scene:cornell_open/backend:cpu/8x6/depth:8/spp:1";
    const std::string soa = "wavefront/layout:soa";
    EXPECT_EQ(names(tuning), (std::vector<std::string>{plain + "/room:0" + settings, soa + settings}));
    EXPECT_EQ(names({}), (std::vector<std::string>{plain + settings, soa + settings}));
    // A study that names a tunable gets the values that it names, the standard among them.
    study.axes = {};
    study.tunables = {{"room", {1}}};
    EXPECT_EQ(names(tuning), std::vector<std::string>{plain + settings});
    study.tunables = {{"room", {1, 0}}};
    EXPECT_EQ(names(tuning), (std::vector<std::string>{plain + settings, plain + "/room:0" + settings}));
}

// ---- What is worth trying ----

TEST(CandidatesTest, AreAllowedInOrderAndHaveTheStandard) {
    for (const Backend backend : all_backends) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                for (const Tunable& tunable : choice->descriptor.tunables) {
                    SCOPED_TRACE(std::string(choice->descriptor.name) + " " + std::string(tunable.name));
                    const std::vector<std::uint32_t> values = candidates(tunable);
                    if (tunable.sets_work) {
                        EXPECT_TRUE(values.empty());
                        continue;
                    }
                    EXPECT_GE(values.size(), 2u);
                    EXPECT_EQ(std::count(values.begin(), values.end(), tunable.default_value), 1);
                    EXPECT_EQ(std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()), values.end());
                    for (const std::uint32_t value : values) {
                        EXPECT_TRUE(tunable.allows(value)) << value;
                    }
                }
            }
        }
    }
}

TEST(CandidatesTest, AreEvenOverAShortRangeAndByTwosOverALongOne) {
    const std::pair<Tunable, std::vector<std::uint32_t>> cases[] = {
        {{"switch, off", 0, 0, 1}, {0, 1}},
        {{"switch, on", 1, 0, 1}, {0, 1}},
        {{"one value", 5, 5, 5}, {5}},
        {{"short", 3, 2, 5}, {2, 3, 4, 5}},
        {{"min_blocks", 0, 0, 32}, {0, 4, 8, 12, 16, 20, 24, 28, 32}},
        {{"regenerate_at", 24, 0, 31}, {0, 3, 7, 11, 15, 19, 23, 24, 27, 31}},
        {{"block", 128, 32, 1024, 32}, {32, 64, 128, 256, 512, 1024}},
        {{"block", 96, 32, 1024, 32}, {96, 192, 384, 768}},
        {{"spp_in_flight", 1, 1, 1024}, {1, 2, 4, 8, 16}},
        {{"piece", 16, 1, 4096}, {1, 2, 4, 8, 16, 32, 64, 128, 256}},
        {{"beyond 32 bits", 0x80000000u, 1, 0xffffffffu},
         {0x08000000u, 0x10000000u, 0x20000000u, 0x40000000u, 0x80000000u}},
        {{"work", 16, 1, 4096, 1, "", true}, {}},
        {{"work, switch", 0, 0, 1, 1, "", true}, {}},
    };
    for (const auto& [tunable, values] : cases) {
        EXPECT_EQ(candidates(tunable), values) << tunable.name;
    }
}

}  // namespace
}  // namespace pt
