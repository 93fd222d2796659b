// What is compared: the registry's content, what each choice says of itself, and that every variant renders the film
// that it claims to.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <omp.h>

#include "harness/bench/suite.h"
#include "harness/render/renderer.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

const Registry& registry() { return Registry::instance(); }

const Descriptor& descriptor(const std::string& axis, const std::string& choice) {
    return registry().find(axis, choice)->descriptor;
}

Variant baseline_with(const std::vector<std::pair<std::string, std::string>>& choices) {
    Variant variant = registry().baseline();
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

// ---- Scenes ----

void image(test::SceneBuilder& builder, bool jitter) {
    builder.image(24, 18, 60, jitter);
    builder.scene.camera.vertical_fov_degrees = 60;
}

// An open box with an emitter and a mirror ball, as in the seeds' scene.
test::SceneBuilder cornell_like(bool jitter) {
    test::SceneBuilder builder;
    const std::uint32_t light = builder.emitter({5, 5, 5});
    const std::uint32_t white = builder.diffuse({0.9, 0.9, 0.9});
    const std::uint32_t red = builder.diffuse({0.85, 0.35, 0.35});
    const std::uint32_t mirror = builder.mirror({0.98, 0.98, 0.98});
    builder.box(light, {0, 2, 5}, {2, 0.1, 2});
    builder.box(white, {0, -2, 5}, {4, 0.01, 4});
    builder.box(white, {0, 0, 7}, {4, 4, 0.01});
    builder.box(red, {-2, 0, 5}, {0.01, 4, 4});
    builder.box(white, {2, 0, 5}, {0.01, 4, 4});
    builder.sphere(mirror, {-0.5, -0.5, 5}, 1.5);
    image(builder, jitter);
    builder.depth(6);
    return builder;
}

Scene five_materials() {
    test::SceneBuilder builder = cornell_like(true);
    builder.sphere(builder.mix({0.2, 0.6, 0.2}, {0.9, 0.9, 0.9}, 0.4), {1, -1.4, 4.5}, 0.9);
    builder.sphere(builder.dielectric(1.5, {0.1, 0.3, 0.5}), {0.9, 0.3, 4.5}, 0.9);
    builder.sphere(builder.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}), {-1.2, -1.5, 4}, 0.8);
    builder.box(builder.diffuse({0.3, 0.3, 0.9}), {0, 1, 5}, {0.6, 0.4, 0.5}, {20, 30, 40});
    return builder.scene;
}

Scene lens_motion_environment() {
    test::SceneBuilder builder = cornell_like(true);
    builder.environment(0.4);
    builder.scene.camera.aperture_radius = 0.2;
    builder.scene.camera.focus_distance = 5;
    builder.scene.camera.shutter_close = 1;
    builder.sphere(builder.diffuse({0.4, 0.5, 0.6}, {0.2, 0.1, 0}), {0.5, -1, 4}, 0.8).velocity = {0.5, 0.3, 0};
    builder.ellipsoid(builder.diffuse({0.7, 0.7, 0.3}), {0, 0.8, 4}, {0.8, 0.3, 0.5}, {0, 0, 30});
    builder.quad(builder.emitter({1, 2, 3}), {1.5, 0.5, 4}, 0.7, 0.7, {0, 0, 60});
    return builder.scene;
}

constexpr std::uint32_t spp = 3;

RenderResult render_variant(const Scene& scene, const Variant& variant) {
    return render(scene, {.variant = variant, .settings = default_settings(scene), .samples = spp});
}

// ---- The registry ----

TEST(RegistryTest, HasEveryAxisAndChoice) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> expected{
        {"integrator", {"wavefront", "depth_first"}},
        {"compaction",
         {"none", "thrust_copy_if_index", "thrust_partition", "thrust_remove_if", "thrust_stable_partition"}},
        {"sorting", {"none", "bucket", "thrust_sort_by_key"}},
        {"first_bounce", {"off", "cached"}},
        {"direct_light", {"off", "final_bounce"}},
        {"layout", {"aos", "soa"}},
        {"specialisation", {"features", "generic"}},
    };
    ASSERT_EQ(std::size(axis_names), expected.size());
    const AxisChoices all = all_choices();
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(axis_names[i], expected[i].first);
        EXPECT_EQ(all.at(expected[i].first), expected[i].second);  // the baseline first, then by name
    }
}

TEST(RegistryTest, EveryAxisHasOneBaseline) {
    for (const std::string_view axis : axis_names) {
        const std::vector<const Choice*> choices = registry().choices(axis);
        EXPECT_EQ(std::count_if(choices.begin(), choices.end(), [](const Choice* c) { return c->descriptor.baseline; }),
                  1)
            << axis;
        EXPECT_TRUE(choices.front()->descriptor.baseline) << axis;
    }
}

bool is_plain(std::string_view name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
    });
}

TEST(RegistryTest, EveryChoiceDescribesItself) {
    for (const std::string_view axis : axis_names) {
        for (const Choice* choice : registry().choices(axis)) {
            const Descriptor& d = choice->descriptor;
            SCOPED_TRACE(std::string(axis) + "=" + std::string(d.name));
            EXPECT_EQ(d.axis, axis);
            EXPECT_TRUE(is_plain(d.name));  // it becomes part of a dotted name
            EXPECT_FALSE(d.summary.empty());
            EXPECT_FALSE(d.origin.empty());
            EXPECT_EQ(d.summary.find('\n'), std::string_view::npos);
            EXPECT_NE(d.backends & static_cast<std::uint32_t>(Backend::cpu), 0u);
            if (d.claim != Claim::bitwise) {
                EXPECT_FALSE(d.claim_note.empty());
            }
            if (d.claim == Claim::statistical) {
                EXPECT_NE(registry().find(axis, d.mean_of), nullptr);
            }
        }
    }
}

TEST(RegistryTest, OnlyTheFinalBounceClaimsLessThanBits) {
    for (const std::string_view axis : axis_names) {
        for (const Choice* choice : registry().choices(axis)) {
            const bool is_final_bounce = choice->descriptor.name == "final_bounce";
            EXPECT_EQ(choice->descriptor.claim, is_final_bounce ? Claim::statistical : Claim::bitwise)
                << choice->descriptor.name;
        }
    }
}

TEST(RegistryTest, RefusesUnknownAxesAndSecondChoicesOfOneName) {
    Registry own;
    EXPECT_THROW(own.add({.axis = "colour", .name = "red", .summary = "", .origin = ""}, {}), std::out_of_range);
    const Descriptor none{.axis = "sorting", .name = "none", .summary = "", .origin = ""};
    own.add(none, {});
    try {
        own.add(none, {});
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "choice registered twice: sorting=none");
    }
    try {
        own.add({.axis = "sorting", .name = "vague", .summary = "", .origin = "", .claim = Claim::statistical}, {});
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "a statistical claim needs mean_of: sorting=vague");
    }
    EXPECT_EQ(own.find("sorting", "bucket"), nullptr);
    EXPECT_EQ(own.find("colour", "red"), nullptr);
    EXPECT_TRUE(own.choices("layout").empty());
}

TEST(RegistryTest, EveryIntegratorIsCompiledForTheSameFeatureSets) {
    const auto& wavefront = registry().find("integrator", "wavefront")->hook.integrator;
    const auto& depth_first = registry().find("integrator", "depth_first")->hook.integrator;
    EXPECT_TRUE(wavefront.contains(all_features));
    EXPECT_EQ(wavefront.size(), depth_first.size());
    for (const auto& [features, function] : wavefront) {
        EXPECT_TRUE(depth_first.contains(features));
    }
}

TEST(VariantTest, NameJoinsTheChoicesByDots) {
    EXPECT_EQ(registry().baseline().name(), "wavefront.none.none.off.off.aos.features");
    EXPECT_EQ(baseline_with({{"compaction", "thrust_remove_if"}, {"layout", "soa"}, {"first_bounce", "cached"}}).name(),
              "wavefront.thrust_remove_if.none.cached.off.soa.features");
    EXPECT_THROW(Variant::index("colour"), std::out_of_range);
    EXPECT_EQ(Variant::index("specialisation"), 6u);
}

TEST(VariantTest, ReferenceIsThePlainestVariantOfTheSameExpectation) {
    for (const Variant& variant : expand(all_choices())) {
        const Variant reference = registry().reference(variant);
        EXPECT_EQ(reference.name(), "depth_first.none.none.off." + variant["direct_light"] + ".aos.generic");
        EXPECT_EQ(registry().reference(reference), reference);
        EXPECT_EQ(why_not_applicable(reference, all_features), "");
    }
}

TEST(VariantTest, ClaimIsTheWeakestOfItsChoices) {
    for (const Variant& variant : expand(all_choices())) {
        EXPECT_EQ(claim_of(variant), variant["direct_light"] == "off" ? Claim::bitwise : Claim::statistical);
    }
    EXPECT_EQ(to_string(Claim::bitwise), "bitwise");
    EXPECT_EQ(to_string(Claim::statistical), "statistical");
    EXPECT_EQ(to_string(Claim::biased), "biased");
}

TEST(VariantTest, FeatureNamesAreInTheOrderOfTheirBits) {
    EXPECT_TRUE(feature_names(no_features).empty());
    EXPECT_EQ(feature_names(Feature::jitter | Feature::sphere), (std::vector<std::string>{"sphere", "jitter"}));
    const std::vector<std::string> all = feature_names(all_features);
    EXPECT_EQ(all.size(), 19u);
    EXPECT_EQ(all.back(), "final_bounce");
    EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
}

// ---- What applies where ----

constexpr FeatureSet plain_features = Feature::sphere | Feature::emitter;

TEST(ApplicabilityTest, SaysWordForWordWhatDoesNotApply) {
    struct Case {
        std::vector<std::pair<std::string, std::string>> choices;
        FeatureSet scene;
        const char* reason;
    };
    const Case cases[] = {
        {{}, all_features, ""},
        {{{"first_bounce", "cached"}}, plain_features, ""},
        {{{"first_bounce", "cached"}},
         plain_features | Feature::jitter,
         "first_bounce=cached needs jitter off (camera.jitter is true in the scene)"},
        {{{"first_bounce", "cached"}},
         plain_features | Feature::lens,
         "first_bounce=cached needs a pinhole camera (camera.aperture_radius is not 0)"},
        {{{"first_bounce", "cached"}},
         plain_features | Feature::motion,
         "first_bounce=cached needs still objects (the scene has moving ones and an open shutter)"},
        {{{"integrator", "depth_first"}}, all_features, ""},
        {{{"integrator", "depth_first"}, {"compaction", "thrust_remove_if"}},
         plain_features,
         "integrator=depth_first has no queue to compact: needs compaction=none, not thrust_remove_if"},
        {{{"integrator", "depth_first"}, {"sorting", "bucket"}},
         plain_features,
         "integrator=depth_first has no queue to sort: needs sorting=none, not bucket"},
        {{{"integrator", "depth_first"}, {"layout", "soa"}},
         plain_features,
         "integrator=depth_first keeps one path in registers, no array of paths: needs layout=aos, not soa"},
        {{{"compaction", "thrust_copy_if_index"}, {"sorting", "bucket"}}, plain_features, ""},
        {{{"compaction", "thrust_copy_if_index"}, {"sorting", "thrust_sort_by_key"}},
         plain_features,
         "sorting=thrust_sort_by_key moves a contiguous payload, which compaction=thrust_copy_if_index does not keep"},
        {{{"direct_light", "final_bounce"}}, Feature::sphere | Feature::emission, ""},
        {{{"direct_light", "final_bounce"}}, Feature::sphere | Feature::environment, ""},
        {{{"direct_light", "final_bounce"}},
         Feature::sphere | Feature::diffuse,
         "direct_light=final_bounce needs a light in the scene"},
    };
    for (const Case& c : cases) {
        const Variant variant = baseline_with(c.choices);
        EXPECT_EQ(why_not_applicable(variant, c.scene), c.reason) << variant.name();
    }
}

// ---- What a choice left undone ----

struct WorkCase {
    const char* axis;
    const char* choice;
    WorkCounters good;
    std::vector<std::pair<WorkCounters, std::string>> bad;  // and what is said of it
};

std::vector<WorkCase> work_cases() {
    const WorkCounters idle{.paths = 200, .rays = 500};
    const WorkCounters queued{.paths = 200, .rays = 500, .bounces = 9, .last_bounces = 2, .last_paths = 20};
    WorkCounters compacted = queued;
    compacted.compactions = 7;
    compacted.compacted_away = 180;
    WorkCounters ordered = queued;
    ordered.sorts = 7;
    ordered.sorted = 480;
    const WorkCounters cached{.paths = 200, .rays = 500, .cache_fills = 100, .cache_hits = 100};
    const auto with = [](WorkCounters work, std::uint64_t WorkCounters::*counter, std::uint64_t value) {
        work.*counter = value;
        return work;
    };
    std::vector<WorkCase> cases{
        {"integrator",
         "wavefront",
         queued,
         {{with(queued, &WorkCounters::bounces, 1), "ran fewer bounces over the queue than samples"}}},
        {"integrator", "depth_first", idle, {{queued, "ran a queue"}}},
        {"compaction", "none", queued, {{compacted, "a compaction ran"}}},
        {"sorting", "none", queued, {{ordered, "a sort ran"}}},
        {"direct_light", "off", idle, {{with(idle, &WorkCounters::connections, 1), "connected vertices to lights"}}},
        {"first_bounce",
         "off",
         idle,
         {{cached, "a cache was used"}, {with(idle, &WorkCounters::cache_hits, 1), "a cache was used"}}},
        {"first_bounce",
         "cached",
         cached,
         {{idle, "0 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_fills, 200), "200 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_hits, 99), "not every camera ray came from the cache"}}},
    };
    for (const char* name :
         {"thrust_copy_if_index", "thrust_partition", "thrust_remove_if", "thrust_stable_partition"}) {
        cases.push_back(
            {"compaction",
             name,
             compacted,
             {{queued, "0 compactions in 9 bounces, 2 of them last ones"},
              {with(compacted, &WorkCounters::compactions, 9), "9 compactions in 9 bounces, 2 of them last ones"},
              {with(compacted, &WorkCounters::compacted_away, 179),
               "179 paths taken out and 20 ended in the last segment, of 200"}}});
    }
    for (const char* name : {"bucket", "thrust_sort_by_key"}) {
        cases.push_back({"sorting",
                         name,
                         ordered,
                         {{queued, "did not sort in every bounce but the last"},
                          {with(ordered, &WorkCounters::sorts, 6), "did not sort in every bounce but the last"}}});
    }
    return cases;
}

TEST(WorkTest, EveryChoiceNoticesWhatItLeftUndone) {
    for (const WorkCase& c : work_cases()) {
        const Descriptor& d = descriptor(c.axis, c.choice);
        SCOPED_TRACE(std::string(c.axis) + "=" + c.choice);
        ASSERT_NE(d.work_missing, nullptr);
        EXPECT_EQ(d.work_missing(c.good, 2), "");
        for (const auto& [work, message] : c.bad) {
            EXPECT_EQ(d.work_missing(work, 2), message);
        }
    }
}

TEST(WorkTest, EveryCheckIsTriedAbove) {
    const std::vector<WorkCase> cases = work_cases();
    for (const std::string_view axis : axis_names) {
        for (const Choice* choice : registry().choices(axis)) {
            const bool tried = std::any_of(cases.begin(), cases.end(), [&](const WorkCase& c) {
                return axis == c.axis && choice->descriptor.name == c.choice;
            });
            EXPECT_EQ(tried, choice->descriptor.work_missing != nullptr) << choice->descriptor.name;
        }
    }
}

TEST(WorkTest, TheVariantNamesTheChoice) {
    const Variant variant = baseline_with({{"compaction", "thrust_partition"}});
    EXPECT_EQ(work_missing(variant, {.paths = 4, .rays = 4, .bounces = 3}, 1),
              "compaction=thrust_partition: 0 compactions in 3 bounces, 0 of them last ones");
    EXPECT_EQ(work_missing(variant, {.paths = 4, .bounces = 3, .compactions = 3, .compacted_away = 4}, 1), "");
}

// ---- Kernels ----

TEST(KernelTest, FeaturesTakesTheSmallestSuperset) {
    const ChooseFeatures& choose = registry().find("specialisation", "features")->hook.specialisation;
    const FeatureSet a = Feature::sphere | Feature::diffuse;
    const FeatureSet larger = a | Feature::jitter;
    const FeatureSet largest = larger | Feature::lens | Feature::quad;
    const std::vector<FeatureSet> compiled{all_features, largest, a, larger};
    EXPECT_EQ(choose(a, compiled), a);
    EXPECT_EQ(choose(no_features | Feature::sphere, compiled), a);
    EXPECT_EQ(choose(Feature::sphere | Feature::jitter, compiled), larger);
    EXPECT_EQ(choose(no_features | Feature::quad, compiled), largest);
    EXPECT_EQ(choose(no_features | Feature::subsurface, compiled), all_features);
    EXPECT_EQ(choose(a, {all_features}), all_features);
}

TEST(KernelTest, GenericTakesEverything) {
    const ChooseFeatures& choose = registry().find("specialisation", "generic")->hook.specialisation;
    const FeatureSet a = Feature::sphere | Feature::diffuse;
    EXPECT_EQ(choose(a, {a, all_features}), all_features);
}

TEST(KernelTest, NoteNamesWhatWasCompiledForNothing) {
    EXPECT_EQ((KernelChoice{plain_features, plain_features, nullptr}).note(), "exact");
    EXPECT_EQ((KernelChoice{plain_features, plain_features | Feature::lens | Feature::mirror, nullptr}).note(),
              "has mirror, lens for nothing");
}

TEST(KernelTest, ASceneThatNoKernelWasMadeForGetsTheNearestOne) {
    const Scene scene = lens_motion_environment();
    for (const char* integrator : {"wavefront", "depth_first"}) {
        const KernelChoice kernel = choose_kernel(scene, baseline_with({{"integrator", integrator}}));
        EXPECT_EQ(kernel.needed, features_of(scene));
        EXPECT_TRUE(is_superset(kernel.compiled, kernel.needed));
        EXPECT_NE(kernel.note(), "exact");
        EXPECT_NE(kernel.render, nullptr);
    }
    const KernelChoice lit = choose_kernel(scene, baseline_with({{"direct_light", "final_bounce"}}));
    EXPECT_EQ(lit.needed, features_of(scene) | Feature::final_bounce);
    EXPECT_EQ(choose_kernel(scene, baseline_with({{"specialisation", "generic"}})).compiled, all_features);
}

std::vector<std::filesystem::path> shipped_scene_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(PTBENCH_SOURCE_DIR "/scenes")) {
        if (entry.path().extension() == ".json") {
            files.push_back(entry.path());
        }
    }
    return files;
}

TEST(KernelTest, EveryShippedSceneHasItsExactKernelAndNoKernelIsThereForNothing) {
    std::set<FeatureSet> used;
    for (const auto& file : shipped_scene_files()) {
        const Scene scene = load_scene(file.string());
        EXPECT_EQ(choose_kernel(scene, registry().baseline()).note(), "exact") << file;
        used.insert(features_of(scene));
    }
    for (const auto& [features, function] : registry().find("integrator", "wavefront")->hook.integrator) {
        if (features != all_features) {
            EXPECT_TRUE(used.contains(features & ~static_cast<FeatureSet>(Feature::final_bounce)))
                << testing::PrintToString(feature_names(features));
        }
    }
}

// ---- Every variant's film ----

class EveryVariantTest : public testing::TestWithParam<std::pair<const char*, Scene (*)()>> {};

TEST_P(EveryVariantTest, RendersTheReferencesBits) {
    const Scene scene = GetParam().second();
    const FeatureSet features = features_of(scene);
    std::map<Variant, RenderResult> references;
    std::size_t rendered = 0;
    for (const Variant& variant : expand(all_choices())) {
        if (!why_not_applicable(variant, features).empty()) {
            continue;
        }
        const Variant reference_variant = registry().reference(variant);
        if (!references.contains(reference_variant)) {
            references.emplace(reference_variant, render_variant(scene, reference_variant));
        }
        const RenderResult& reference = references.at(reference_variant);
        const RenderResult result = render_variant(scene, variant);
        ASSERT_EQ(result.film.sums(), reference.film.sums()) << variant.name();
        ASSERT_EQ(work_missing(variant, result.work, spp), "") << variant.name();
        ASSERT_EQ(result.work.paths, 24u * 18u * spp) << variant.name();
        ASSERT_EQ(result.work.rays + result.work.cache_hits, reference.work.rays + reference.work.cache_hits)
            << variant.name();
        ASSERT_EQ(result.work.unfinished_walks, reference.work.unfinished_walks) << variant.name();
        ASSERT_EQ(result.film.faults().nonfinite + result.film.faults().negative, 0u) << variant.name();
        ++rendered;
    }
    // 2 x 2 x 2 for depth_first and (5 x 3 - 1) x 2 x 2 x 2 x 2 for wavefront; half of them where the cache does not
    // apply.
    EXPECT_EQ(rendered, scene.camera.jitter ? 116u : 232u);
    // The comparison means something only if there is light, and if the two expectations differ.
    ASSERT_EQ(references.size(), 2u);
    const Vec3d plain = references.begin()->second.film.mean();
    EXPECT_GT(plain.x, 0.01);
    EXPECT_NE(references.begin()->second.film.sums(), references.rbegin()->second.film.sums());
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryVariantTest,
                         testing::Values(std::pair{"cornell_like", +[] { return cornell_like(true).scene; }},
                                         std::pair{"five_materials", +five_materials},
                                         std::pair{"jitter_off", +[] { return cornell_like(false).scene; }},
                                         std::pair{"lens_motion_environment", +lens_motion_environment}),
                         [](const auto& test) { return std::string(test.param.first); });

TEST(FilmTest, DoesNotDependOnTheNumberOfThreads) {
    const Scene scene = five_materials();
    std::vector<Variant> variants{baseline_with({{"integrator", "depth_first"}})};
    const AxisChoices all = all_choices();
    for (const std::string& compaction : all.at("compaction")) {
        variants.push_back(baseline_with({{"compaction", compaction}, {"sorting", "bucket"}, {"layout", "soa"}}));
    }
    for (const std::string& sorting : all.at("sorting")) {
        variants.push_back(baseline_with(
            {{"compaction", "thrust_partition"}, {"sorting", sorting}, {"direct_light", "final_bounce"}}));
    }
    const int threads_before = omp_get_max_threads();
    for (const Variant& variant : variants) {
        omp_set_num_threads(1);
        const RenderResult alone = render_variant(scene, variant);
        for (const int threads : {2, 3}) {
            omp_set_num_threads(threads);
            const RenderResult together = render_variant(scene, variant);
            EXPECT_EQ(together.film.sums(), alone.film.sums()) << variant.name() << " on " << threads;
            EXPECT_EQ(together.work.rays, alone.work.rays) << variant.name() << " on " << threads;
            EXPECT_EQ(together.work.compacted_away, alone.work.compacted_away) << variant.name() << " on " << threads;
        }
    }
    omp_set_num_threads(threads_before);
}

// ---- What the choices did, as counted ----

TEST(CountersTest, EveryCompactionTakesAllPathsOutAndNoneTakesNone) {
    const Scene scene = five_materials();
    const std::vector<std::string> compactions = all_choices().at("compaction");
    for (const std::string& compaction : compactions) {
        const RenderResult result = render_variant(scene, baseline_with({{"compaction", compaction}}));
        SCOPED_TRACE(compaction);
        EXPECT_GE(result.work.bounces, spp * 4u);
        EXPECT_LE(result.work.bounces, spp * 6u);
        EXPECT_EQ(result.work.last_bounces, spp);
        EXPECT_EQ(result.work.compactions, compaction == "none" ? 0 : result.work.bounces - spp);
        EXPECT_GT(result.work.last_paths, 0u);
        EXPECT_EQ(result.work.compacted_away, compaction == "none" ? 0 : result.work.paths - result.work.last_paths);
    }
}

TEST(CountersTest, EverySortPutsEveryTracedPathInOrder) {
    const Scene scene = five_materials();
    const std::vector<std::string> sortings = all_choices().at("sorting");
    for (const std::string& sorting : sortings) {
        const RenderResult result = render_variant(scene, baseline_with({{"sorting", sorting}}));
        SCOPED_TRACE(sorting);
        EXPECT_EQ(result.work.sorts, sorting == "none" ? 0 : result.work.bounces - result.work.last_bounces);
        EXPECT_EQ(result.work.sorted, sorting == "none" ? 0 : result.work.rays - result.work.last_paths);
    }
}

TEST(CountersTest, AnInstrumentedRenderCountsTheLivePathsAndTheStages) {
    const Scene scene = five_materials();
    const auto instrumented = [&](const Variant& variant) {
        return render(scene,
                      {.variant = variant, .settings = default_settings(scene), .samples = spp, .instrument = true});
    };
    const RenderResult queue = instrumented(baseline_with({{"compaction", "thrust_remove_if"}, {"sorting", "bucket"}}));
    const RenderResult loop = instrumented(baseline_with({{"integrator", "depth_first"}}));
    const std::vector<std::uint64_t>& live = queue.stages.live_paths;
    ASSERT_EQ(live.size(), 6u);  // one entry a segment
    EXPECT_EQ(live, loop.stages.live_paths);
    EXPECT_EQ(live.front(), queue.work.paths);
    EXPECT_TRUE(std::is_sorted(live.rbegin(), live.rend()));
    std::uint64_t total = 0;
    for (const std::uint64_t paths : live) {
        total += paths;
    }
    EXPECT_EQ(total, queue.work.rays);
    const auto names = [](const RenderResult& result) {
        std::vector<std::string> stages;
        for (const auto& [stage, ms] : result.stages.milliseconds) {
            EXPECT_GE(ms, 0);
            stages.emplace_back(stage);
        }
        return stages;
    };
    EXPECT_EQ(names(queue), (std::vector<std::string>{"generate", "intersect", "sort", "shade", "compact"}));
    EXPECT_EQ(names(loop), (std::vector<std::string>{"trace"}));
    // Instrumenting changes no bit, and a plain render is not instrumented.
    const RenderResult plain = render_variant(scene, registry().baseline());
    EXPECT_EQ(plain.film.sums(), queue.film.sums());
    EXPECT_TRUE(plain.stages.milliseconds.empty());
    EXPECT_TRUE(plain.stages.live_paths.empty());
}

// ---- The cache ----

TEST(FirstBounceCacheTest, HoldsTheHitsThatWouldBeComputed) {
    const Scene scene = cornell_like(false).scene;
    for (const std::string integrator : {"wavefront", "depth_first"}) {
        SCOPED_TRACE(integrator);
        const Variant variant = baseline_with({{"integrator", integrator}, {"first_bounce", "cached"}});
        const RenderSettings settings = default_settings(scene);
        const SceneBuffers<float> buffers(scene, settings);
        Film film(settings.width, settings.height, radiance_bound(scene, settings.depth), 2);
        PathQueue queue;
        queue.paths = registry().at("layout", variant).hook.layout();
        const auto compaction = registry().at("compaction", variant).hook.compaction();
        const auto sorting = registry().at("sorting", variant).hook.sorting();
        const auto cache = registry().at("first_bounce", variant).hook.first_bounce(settings.width * settings.height);
        ASSERT_NE(cache, nullptr);
        EXPECT_FALSE(cache->filled);
        RenderJob job;
        job.scene = buffers.view();
        job.film = film.view();
        job.samples = 2;
        job.queue = &queue;
        job.compaction = compaction.get();
        job.sorting = sorting.get();
        job.cache = cache.get();
        choose_kernel(scene, variant).render(job);

        EXPECT_TRUE(cache->filled);
        EXPECT_EQ(job.work.cache_fills, 24u * 18u);
        EXPECT_EQ(job.work.cache_hits, 24u * 18u);
        const test::Stages<float> stages(scene);
        for (std::uint32_t pixel = 0; pixel < 24 * 18; ++pixel) {
            for (const std::uint32_t sample : {0u, 1u, 77u}) {  // the camera ray is the same for all
                const Hit<float> expected = stages.intersect(stages.generate(pixel, sample));
                ASSERT_EQ(cache->hits[pixel].t, expected.t) << pixel;
                ASSERT_EQ(cache->hits[pixel].side.code, expected.side.code) << pixel;
            }
        }
    }
    EXPECT_EQ(registry().find("first_bounce", "off")->hook.first_bounce(10), nullptr);
}

}  // namespace
}  // namespace pt
