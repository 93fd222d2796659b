// What is compared: the registry's content, what each choice says of itself, and that every variant renders the film
// that it claims to.
#include <algorithm>
#include <bit>
#include <cctype>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <omp.h>

#include "harness/bench/suite.h"
#include "harness/render/renderer.h"
#include "tests/support/backends.h"
#include "tests/support/places.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"
#include "variants/devices/here.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

const Registry& registry() { return Registry::instance(); }

Variant baseline_with(const std::vector<std::pair<std::string, std::string>>& choices, Backend backend = Backend::cpu) {
    Variant variant = registry().baseline(backend);
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

// An open box with an emitter and a mirror ball, as in the scene of cis565.
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

// Every choice of every axis but those of meshes, which multiply the others and have nothing to do with them.
AxisChoices choices_of_paths() {
    AxisChoices axes = all_choices();
    axes.erase("accelerator");
    axes.erase("builder");
    axes.erase("levels");
    axes.erase("light_sampling");  // of connections: three and two more of each
    axes.erase("light_selection");
    axes.erase("subsurface_sampling");  // of bodies
    axes["russian_roulette"] = {"off", "throughput",
                                "adjoint_splitting"};  // adjoint goes with all that throughput does
    return axes;
}

// ---- The registry ----

using AxisTable = std::vector<std::pair<std::string, std::vector<std::string>>>;

bool has_source(const std::string& axis, const std::string& name) {
    const std::filesystem::path folder = std::filesystem::path(test::in_source("variants")) / axis;
    return std::any_of(std::filesystem::directory_iterator(folder), {},
                       [&](const auto& entry) { return entry.path().stem() == name; });
}

// The baseline first, then by name. Whoever adds a choice of their own need not list it here: it has a file.
void expect_choices(const AxisTable& expected, Backend backend) {
    ASSERT_EQ(std::size(axis_names), expected.size());
    const AxisChoices all = all_choices(backend);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto& [axis, names] = expected[i];
        EXPECT_EQ(axis_names[i], axis);
        std::vector<std::string> listed;
        for (const std::string& name : all.at(axis)) {
            if (std::find(names.begin(), names.end(), name) != names.end()) {
                listed.push_back(name);
            } else {
                EXPECT_TRUE(has_source(axis, name)) << axis << "=" << name;
            }
        }
        EXPECT_EQ(listed, names);
    }
}

TEST(RegistryTest, HasEveryAxisAndChoice) {
    expect_choices(
        {
            {"integrator", {"wavefront", "audited", "depth_first", "packet"}},
            {"compaction",
             {"none", "thrust_copy_if_index", "thrust_partition", "thrust_remove_if", "thrust_stable_partition"}},
            {"sorting", {"none", "bucket", "thrust_sort_by_key"}},
            {"sort_key", {"material"}},
            {"first_bounce", {"off", "cached", "cached_jitters"}},
            {"direct_light", {"off", "final_bounce", "nee", "nee_mis", "nee_one_sample"}},
            {"russian_roulette", {"off", "adjoint", "adjoint_splitting", "throughput"}},
            {"sampler", {"pcg4d", "halton", "minstd_by_position", "philox", "pmj02", "sobol_owen", "sobol_rotated"}},
            {"layout", {"aos", "soa"}},
            {"specialisation", {"features", "generic", "matrix"}},
            {"launch", {"stream"}},
            {"arithmetic", {"exact"}},
            {"precision", {"float", "double", "double_intersection"}},
            {"robustness", {"robust", "naive"}},
            {"accelerator", {"brute_force", "bvh2", "bvh4", "bvh8", "cwbvh"}},
            {"builder", {"sah_binned", "lbvh", "ploc", "ploc_reinserted", "sah_sweep", "sbvh"}},
            {"traversal", {"while_while"}},
            {"traversal_stack", {"local"}},
            {"levels", {"each_object", "flat", "two_level"}},
            {"light_sampling", {"solid_angle", "area", "auto", "projected"}},
            {"devices", {"1"}},
            {"partition", {"samples"}},
            {"light_selection", {"uniform", "light_tree", "power"}},
            {"subsurface_sampling", {"classical", "dwivedi"}},
        },
        Backend::cpu);
}

TEST(RegistryTest, HasEveryAxisAndChoiceOnCuda) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    expect_choices(
        {
            {"integrator",
             {"wavefront", "audited", "megakernel", "megakernel_regen", "persistent", "regroup", "wavefront_fused",
              "wavefront_materials", "wavefront_refill"}},
            {"compaction",
             {"none", "atomic_append", "block_scan_append", "cub_partition", "cub_select_flagged", "cub_select_if",
              "cub_three_way", "gap_fill", "thrust_copy_if_index", "thrust_partition", "thrust_remove_if",
              "thrust_stable_partition"}},
            {"sorting", {"none", "bucket", "cub_radix", "cub_radix_full", "per_material_queue", "thrust_sort_by_key"}},
            {"sort_key", {"material", "chunk_material", "material_hit", "ray"}},
            {"first_bounce", {"off", "cached", "cached_jitters"}},
            {"direct_light", {"off", "final_bounce", "nee", "nee_mis", "nee_one_sample"}},
            {"russian_roulette", {"off", "adjoint", "adjoint_splitting", "throughput"}},
            {"sampler", {"pcg4d", "halton", "minstd_by_position", "philox", "pmj02", "sobol_owen", "sobol_rotated"}},
            {"layout", {"aos", "packed", "soa"}},
            {"specialisation", {"features", "baked", "generic", "matrix"}},
            {"launch", {"stream", "graph", "graph_while"}},
            {"arithmetic", {"precise", "exact", "fast"}},
            {"precision", {"float", "double", "double_intersection"}},
            {"robustness", {"robust", "naive"}},
            {"accelerator", {"brute_force", "bvh2", "bvh4", "bvh8", "cwbvh"}},
            {"builder", {"sah_binned", "hploc", "lbvh", "lbvh_gpu", "ploc", "ploc_reinserted", "sah_sweep", "sbvh"}},
            {"traversal", {"while_while", "if_if", "persistent", "speculative"}},
            {"traversal_stack", {"local", "shared", "short_restart"}},
            {"levels", {"each_object", "flat", "two_level"}},
            {"light_sampling", {"solid_angle", "area", "auto", "projected"}},
            {"devices", {"1", "2", "3", "4", "5", "6", "7", "8"}},
            {"partition", {"samples", "dynamic", "tiles"}},
            {"light_selection", {"uniform", "light_tree", "power"}},
            {"subsurface_sampling", {"classical", "dwivedi"}},
        },
        Backend::cuda);
}

TEST(RegistryTest, EveryAxisHasOneBaselineABackend) {
    for (const Backend backend : test::built_backends()) {
        for (const std::string_view axis : axis_names) {
            SCOPED_TRACE(std::string(axis) + " on " + std::string(to_string(backend)));
            const std::vector<const Choice*> choices = registry().choices(axis, backend);
            EXPECT_EQ(std::count_if(choices.begin(), choices.end(),
                                    [=](const Choice* c) { return contains(c->descriptor.baseline, backend); }),
                      1);
            EXPECT_TRUE(contains(choices.front()->descriptor.baseline, backend));
            EXPECT_LE(std::count_if(choices.begin(), choices.end(),
                                    [=](const Choice* c) { return contains(c->descriptor.reference, backend); }),
                      1);
        }
    }
}

bool is_plain(std::string_view name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
    });
}

TEST(RegistryTest, EveryChoiceDescribesItself) {
    for (const Backend backend : all_backends) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : registry().choices(axis, backend)) {
                const Descriptor& d = choice->descriptor;
                SCOPED_TRACE(std::string(axis) + "=" + std::string(d.name) + " on " + std::string(to_string(backend)));
                EXPECT_EQ(d.axis, axis);
                EXPECT_TRUE(is_plain(d.name));  // it becomes part of a dotted name
                EXPECT_FALSE(d.summary.empty());
                EXPECT_FALSE(d.origin.empty());
                EXPECT_EQ(d.summary.find('\n'), std::string_view::npos);
                EXPECT_TRUE(contains(d.backends, backend));
                EXPECT_EQ(d.baseline & ~d.backends, 0u);
                EXPECT_EQ(d.reference & ~d.backends, 0u);
                if (d.claim != Claim::bitwise) {
                    EXPECT_FALSE(d.claim_note.empty());
                }
                if (d.claim == Claim::statistical) {
                    ASSERT_NE(registry().find(axis, d.mean_of, backend), nullptr);
                    EXPECT_FALSE(registry().find(axis, d.mean_of, backend)->descriptor.fp_relaxed);
                }
                std::set<std::string_view> tunables;
                for (const Tunable& t : d.tunables) {
                    EXPECT_TRUE(is_plain(t.name));
                    EXPECT_TRUE(tunables.insert(t.name).second) << t.name;
                    EXPECT_FALSE(t.summary.empty()) << t.name;
                    EXPECT_TRUE(t.allows(t.default_value)) << t.name;
                    EXPECT_LT(t.lowest, t.highest) << t.name;
                }
            }
        }
    }
}

TEST(RegistryTest, WhatClaimsLessThanBits) {
    std::map<std::string, Claim> expected{{"direct_light=final_bounce", Claim::statistical},
                                          {"first_bounce=cached_jitters", Claim::biased},
                                          {"direct_light=nee", Claim::statistical},
                                          {"direct_light=nee_mis", Claim::statistical},
                                          {"direct_light=nee_one_sample", Claim::statistical},
                                          {"sampler=philox", Claim::statistical},
                                          {"sampler=halton", Claim::statistical},
                                          {"sampler=pmj02", Claim::statistical},
                                          {"sampler=sobol_owen", Claim::statistical},
                                          {"sampler=sobol_rotated", Claim::statistical},
                                          {"sampler=minstd_by_position", Claim::biased},
                                          {"russian_roulette=adjoint", Claim::statistical},
                                          {"russian_roulette=adjoint_splitting", Claim::statistical},
                                          {"russian_roulette=throughput", Claim::statistical},
                                          {"light_sampling=area", Claim::statistical},
                                          {"light_sampling=auto", Claim::statistical},
                                          {"light_sampling=projected", Claim::statistical},
                                          {"light_selection=light_tree", Claim::statistical},
                                          {"light_selection=power", Claim::statistical},
                                          {"subsurface_sampling=dwivedi", Claim::statistical},
                                          {"specialisation=matrix", Claim::statistical},
                                          {"arithmetic=precise", Claim::statistical},
                                          {"arithmetic=fast", Claim::statistical},
                                          {"precision=double", Claim::statistical},
                                          {"precision=double_intersection", Claim::statistical},
                                          {"robustness=naive", Claim::biased}};
    if (registry().find("accelerator", "embree_native") != nullptr) {
        expected["accelerator=embree_native"] = Claim::statistical;
    }
    std::set<std::string> seen;
    for (const Backend backend : all_backends) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : registry().choices(axis, backend)) {
                const std::string label = std::string(axis) + "=" + std::string(choice->descriptor.name);
                const auto known = expected.find(label);
                EXPECT_EQ(choice->descriptor.claim, known != expected.end() ? known->second : Claim::bitwise) << label;
                if (known != expected.end()) {
                    seen.insert(label);
                }
            }
        }
    }
    EXPECT_EQ(seen.size(), expected.size());
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
    try {
        own.add({.axis = "sorting", .name = "rough", .summary = "", .origin = "", .fp_relaxed = true}, {});
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "what rounds freely can claim its mean only: sorting=rough");
    }
    static constexpr Tunable out_of_range[] = {{"size", 3, 1, 8, 2}};
    try {
        own.add({.axis = "sorting", .name = "odd", .summary = "", .origin = "", .tunables = out_of_range}, {});
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "the standard of size is not allowed: sorting=odd");
    }
    EXPECT_EQ(own.find("sorting", "bucket"), nullptr);
    EXPECT_EQ(own.find("colour", "red"), nullptr);
    EXPECT_TRUE(own.choices("layout").empty());
}

TEST(RegistryTest, AxesAreDescribedInOneTable) {
    for (std::size_t i = 0; i < axis_count; ++i) {
        EXPECT_EQ(axis_names[i], axis_table[i].key);
        EXPECT_EQ(Variant::index(axis_table[i].key), i);
        EXPECT_FALSE(axis_table[i].what.empty()) << axis_table[i].key;
    }
}

TEST(RegistryTest, AChoiceHasTheTraitsOfItsOwnAxis) {
    Registry own;
    own.add({.axis = "sorting", .name = "a", .summary = "", .origin = "", .traits = SortingTraits{.host_sync = true}},
            {});
    try {
        own.add({.axis = "sorting", .name = "b", .summary = "", .origin = "", .traits = LayoutTraits{}}, {});
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "traits of another axis: sorting=b");
    }
    EXPECT_TRUE(traits_in<SortingTraits>(own.find("sorting", "a")->descriptor).host_sync);
    EXPECT_TRUE(traits_in<SortingTraits>({.axis = "sorting", .name = "", .summary = "", .origin = ""}).sorts);
}

TEST(RegistryTest, GathersTheTraitsOfAVariant) {
    const VariantTraits plain = traits_of(registry().baseline(), Backend::cpu);
    EXPECT_TRUE(plain.integrator.has_queue);
    EXPECT_FALSE(plain.compaction.compacts);
    EXPECT_FALSE(plain.sorting.sorts);
    EXPECT_TRUE(plain.sort_key.is_material_alone());
    EXPECT_FALSE(plain.first_bounce.keeps_hits);
    EXPECT_FALSE(plain.direct_light.connects);
    EXPECT_FALSE(plain.russian_roulette.ends_paths);
    EXPECT_TRUE(plain.sampler.is_in_every_kernel);
    EXPECT_TRUE(plain.layout.keeps_paths_whole);
    EXPECT_FALSE(plain.launch.is_captured);
    EXPECT_TRUE(plain.precision.is_single());
    EXPECT_FALSE(plain.robustness.is_naive);
    EXPECT_EQ(plain.integrator.name, "wavefront");
    Variant mixed = baseline_with({{"precision", "double_intersection"}, {"layout", "soa"}});
    mixed.tuning["room"] = 0;
    const VariantTraits traits = traits_of(mixed, Backend::cpu);
    EXPECT_TRUE(traits.precision.is_mixed());
    EXPECT_FALSE(traits.layout.keeps_paths_whole);
    EXPECT_EQ(traits.tuning, mixed.tuning);
    EXPECT_TRUE(traits_of(baseline_with({{"precision", "double"}}), Backend::cpu).precision.is_double());
    // What is in no build has its axis's defaults.
    Variant unknown = registry().baseline();
    unknown.set("compaction", "test_unknown");
    EXPECT_TRUE(traits_of(unknown, Backend::cpu).compaction.compacts);
    EXPECT_EQ(traits_of(unknown, Backend::cpu).compaction.name, "");
}

TEST(RegistryTest, ABackendHasItsOwnChoices) {
    Registry own;
    own.add({.axis = "sorting", .name = "quick", .summary = "host", .origin = ""}, {});
    EXPECT_EQ(own.find("sorting", "quick", Backend::cuda), nullptr);
    EXPECT_TRUE(own.choices("sorting", Backend::cuda).empty());
    // Another choice of the name on the other backend, and one that is on both.
    own.add({.axis = "sorting", .name = "quick", .summary = "device", .origin = "", .backends = on_cuda}, {});
    EXPECT_EQ(own.find("sorting", "quick")->descriptor.summary, "host");
    EXPECT_EQ(own.find("sorting", "quick", Backend::cuda)->descriptor.summary, "device");
    own.add({.axis = "sorting",
             .name = "a_last",
             .summary = "",
             .origin = "",
             .baseline = on_cuda,
             .backends = on_every_backend},
            {});
    const auto names = [&](Backend backend) {
        std::vector<std::string> found;
        for (const Choice* choice : own.choices("sorting", backend)) {
            found.emplace_back(choice->descriptor.name);
        }
        return found;
    };
    own.add({.axis = "sorting",
             .name = "zero",
             .summary = "",
             .origin = "",
             .baseline = on_cpu,
             .backends = on_every_backend},
            {});
    // The baseline of a backend comes first in its list.
    EXPECT_EQ(names(Backend::cpu), (std::vector<std::string>{"zero", "a_last", "quick"}));
    EXPECT_EQ(names(Backend::cuda), (std::vector<std::string>{"a_last", "quick", "zero"}));
    EXPECT_THROW(
        own.add({.axis = "sorting", .name = "quick", .summary = "", .origin = "", .backends = on_every_backend}, {}),
        std::logic_error);
    Variant variant;
    variant.set("sorting", "bogo");
    try {
        own.at("sorting", variant, Backend::cuda);
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(), "no choice sorting=bogo on cuda");
    }
}

TEST(RegistryTest, EveryIntegratorIsCompiledForTheSameFeatureSets) {
    const auto& wavefront = registry().find("integrator", "wavefront")->hook.integrator;
    const auto& depth_first = registry().find("integrator", "depth_first")->hook.integrator;
    const auto& packet = registry().find("integrator", "packet")->hook.integrator;
    EXPECT_TRUE(wavefront.contains(all_features));
    for (const auto& [features, function] : wavefront) {
        EXPECT_TRUE(depth_first.contains(features));
        EXPECT_TRUE(packet.contains(features));
    }
    // Other formulas are compiled for a path at a time only, each alone; and only such paths split.
    for (const auto& [features, function] : depth_first) {
        EXPECT_TRUE(wavefront.contains(features) || std::popcount(features & formulas) == 1 ||
                    contains(features, Feature::splitting));
    }
    const auto& audited = registry().find("integrator", "audited")->hook.integrator;
    for (const auto& [features, function] : audited) {
        EXPECT_TRUE(is_superset(features, all_features));
        EXPECT_TRUE(depth_first.contains(features));
    }
}

// In double there are the kernels with every feature, for a path at a time.
TEST(RegistryTest, OnlyDepthFirstIsCompiledInDouble) {
    EXPECT_TRUE(registry().find("integrator", "wavefront")->hook.integrator_in_double.empty());
    const Hook& depth_first = registry().find("integrator", "depth_first")->hook;
    EXPECT_TRUE(depth_first.integrator_in_double.contains(all_features));
    for (const auto& [features, function] : depth_first.integrator_in_double) {
        EXPECT_TRUE(is_superset(features, all_features));
        EXPECT_FALSE(contains(features, Feature::matrix));
        EXPECT_TRUE(depth_first.integrator.contains(features));
    }
}

TEST(VariantTest, NameSaysTheIntegratorAndWhatDiffersFromTheBaseline) {
    const Variant baseline = registry().baseline();
    EXPECT_EQ(shown_name(baseline, Backend::cpu), "wavefront");
    EXPECT_EQ(benchmark_name(baseline, Backend::cpu), "wavefront");
    Variant variant =
        baseline_with({{"compaction", "thrust_remove_if"}, {"layout", "soa"}, {"first_bounce", "cached_jitters"}});
    EXPECT_EQ(shown_name(variant, Backend::cpu),
              "wavefront compaction=thrust_remove_if first_bounce=cached_jitters layout=soa");
    variant.tuning["jitters"] = 4;
    variant.tuning["block"] = 256;
    EXPECT_EQ(shown_name(variant, Backend::cpu),
              "wavefront compaction=thrust_remove_if first_bounce=cached_jitters layout=soa block=256 jitters=4");
    EXPECT_EQ(benchmark_name(variant, Backend::cpu),
              "wavefront/compaction:thrust_remove_if/first_bounce:cached_jitters/layout:soa/block:256/jitters:4");
    EXPECT_EQ(shown_name(baseline_with({{"integrator", "depth_first"}}), Backend::cpu), "depth_first");
    EXPECT_THROW(Variant::index("colour"), std::out_of_range);
    if (test::cuda_is_built()) {
        EXPECT_EQ(shown_name(registry().baseline(Backend::cuda), Backend::cuda), "wavefront");
        // The CPU's baseline is another one there.
        EXPECT_EQ(shown_name(baseline, Backend::cuda), "wavefront arithmetic=exact");
    }
}

TEST(VariantTest, SpelledOutItSaysEveryChoiceAndTheTunablesThatAreNotAtTheirDefault) {
    Variant variant = baseline_with({{"first_bounce", "cached_jitters"}});
    const std::string choices =
        "wavefront.none.none.material.cached_jitters.off.off.pcg4d.aos.features.stream.exact.float.robust.brute_force."
        "sah_binned.while_while.local.each_object.solid_angle.1.samples.uniform.classical";
    EXPECT_EQ(variant.spelled_out(), choices);
    variant.tuning["jitters"] = 4;
    variant.tuning["block"] = 256;
    EXPECT_EQ(variant.spelled_out(), choices + "+block=256+jitters=4");
}

// FNV-1a over "name=value\n", sorted by name, of what is not as it was before its axis was there: by hand here.
std::string identity_of(const std::vector<std::string>& lines) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (const std::string& line : lines) {
        for (const char c : line + "\n") {
            hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
        }
    }
    return fmt::format("{:016x}", hash);
}

TEST(VariantTest, IdentityIsOfChoicesAndTunablesAndNotOfBaselines) {
    const std::vector<std::string> plain{
        "compaction=none", "direct_light=off", "first_bounce=off", "integrator=wavefront",
        "layout=aos",      "room=1",           "sorting=none",     "specialisation=features"};
    const Variant baseline = registry().baseline();
    EXPECT_EQ(variant_id(baseline, Backend::cpu), identity_of(plain));
    // A tunable that is named at its default is at its default.
    Variant named = baseline;
    named.tuning["room"] = 1;
    EXPECT_EQ(variant_id(named, Backend::cpu), variant_id(baseline, Backend::cpu));
    named.tuning["room"] = 0;
    EXPECT_NE(variant_id(named, Backend::cpu), variant_id(baseline, Backend::cpu));
    // A later axis takes part where it is not as it was before.
    std::vector<std::string> philox = plain;
    philox.insert(philox.begin() + 6, "sampler=philox");
    EXPECT_EQ(variant_id(baseline_with({{"sampler", "philox"}}), Backend::cpu), identity_of(philox));
}

TEST(VariantTest, EveryVariantHasAnIdentityAndANameOfItsOwn) {
    std::set<std::string> names, identities;
    const std::vector<Variant> variants = expand(choices_of_paths());
    for (const Variant& variant : variants) {
        names.insert(shown_name(variant, Backend::cpu));
        identities.insert(variant_id(variant, Backend::cpu));
    }
    EXPECT_EQ(names.size(), variants.size());
    EXPECT_EQ(identities.size(), variants.size());
}

TEST(VariantTest, VariantsAreOrderedByTheirChoicesThenByTheirTunables) {
    Variant plain = registry().baseline();
    Variant tuned = plain;
    tuned.tuning["jitters"] = 4;
    Variant tuned_higher = plain;
    tuned_higher.tuning["jitters"] = 5;
    const Variant other = baseline_with({{"precision", "half"}});
    const std::vector<Variant> ascending{plain, tuned, tuned_higher, other};
    for (std::size_t a = 0; a < ascending.size(); ++a) {
        for (std::size_t b = 0; b < ascending.size(); ++b) {
            EXPECT_EQ(ascending[a] < ascending[b], a < b);
            EXPECT_EQ(ascending[a] == ascending[b], a == b);
        }
    }
}

// The part of a variant's name that says what is estimated.
std::string estimator_of(const Variant& variant) {
    return variant["direct_light"] + "." + variant["russian_roulette"] + "." + variant["sampler"];
}

TEST(VariantTest, ReferenceIsThePlainestVariantOfTheSameExpectation) {
    for (const Variant& variant : expand(choices_of_paths())) {
        const Variant reference = registry().reference(variant);
        const std::string first_bounce = variant["first_bounce"] == "cached_jitters" ? "cached_jitters" : "off";
        const std::string formula = variant["specialisation"] == "matrix" ? "matrix" : "generic";
        // The film of minstd_by_position depends on every other choice: such a variant is its own reference.
        EXPECT_EQ(reference.spelled_out(),
                  variant["sampler"] == "minstd_by_position"
                      ? variant.spelled_out()
                      : "depth_first.none.none.material." + first_bounce + "." + estimator_of(variant) + ".aos." +
                            formula + ".stream.exact." + variant["precision"] + "." + variant["robustness"] +
                            ".brute_force." + variant["builder"] +
                            ".while_while.local.each_object.solid_angle.1.samples.uniform.classical");
        EXPECT_EQ(registry().reference(reference), reference);
        // Pairs of choices that do not go together have no kernel.
        const bool has_formulas = variant["precision"] == "double_intersection" || variant["robustness"] == "naive";
        const bool excluded =
            (formula == "matrix" && (variant["precision"] == "double" || variant["sampler"] != "pcg4d")) ||
            (has_formulas && (formula == "matrix" || variant["sampler"] != "pcg4d")) ||
            (variant["precision"] == "double_intersection" && variant["robustness"] == "naive") ||
            (variant["russian_roulette"] == "adjoint_splitting" && (has_formulas || formula == "matrix"));
        if (!excluded && variant["sampler"] != "minstd_by_position") {
            EXPECT_EQ(why_not_applicable(reference, all_features), "");
        }
    }
}

TEST(VariantTest, ReferenceOnCudaIsThePlainestVariantOfTheSameExpectation) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    AxisChoices axes = all_choices(Backend::cuda);
    axes["devices"] = {"1", "2"};  // more of them go with what two go with
    const std::vector<Variant> variants = covering_variants(axes, all_features, Backend::cuda);
    ASSERT_FALSE(variants.empty());
    for (const Variant& variant : variants) {
        const Variant reference = registry().reference(variant, Backend::cuda);
        const std::string first_bounce = variant["first_bounce"] == "cached_jitters" ? "cached_jitters" : "off";
        const bool by_matrix = variant["specialisation"] == "matrix";
        // A variant that rounds freely keeps its arithmetic: it is its twin that is held to bits.
        EXPECT_EQ(reference.spelled_out(),
                  variant["sampler"] == "minstd_by_position"
                      ? variant.spelled_out()
                      : "megakernel.none.none.material." + first_bounce + "." + estimator_of(variant) + ".aos." +
                            (by_matrix ? "matrix" : "features") + ".stream." + variant["arithmetic"] + "." +
                            variant["precision"] + "." + variant["robustness"] +
                            ".brute_force.sah_binned.while_while.local.each_object." + variant["light_sampling"] +
                            ".1.samples." + variant["light_selection"] + "." + variant["subsurface_sampling"] +
                            (by_matrix ? "" : "+room=0"));
        EXPECT_EQ(registry().reference(reference, Backend::cuda), reference);
        EXPECT_EQ(why_not_applicable(reference, all_features, Backend::cuda), "") << reference.spelled_out();
    }
}

TEST(VariantTest, ClaimIsTheWeakestOfItsChoices) {
    for (const Variant& variant : expand(choices_of_paths())) {
        const bool is_biased = variant["first_bounce"] == "cached_jitters" ||
                               variant["sampler"] == "minstd_by_position" || variant["robustness"] == "naive";
        EXPECT_EQ(claim_of(variant), is_biased ? Claim::biased
                                     : estimator_of(variant) == "off.off.pcg4d" &&
                                             variant["specialisation"] != "matrix" && variant["precision"] == "float"
                                         ? Claim::bitwise
                                         : Claim::statistical);
    }
    EXPECT_EQ(to_string(Claim::bitwise), "bitwise");
    EXPECT_EQ(to_string(Claim::statistical), "statistical");
    EXPECT_EQ(to_string(Claim::biased), "biased");
}

TEST(VariantTest, NothingRoundsFreelyOnTheCpu) {
    for (const Variant& variant : expand(choices_of_paths())) {
        EXPECT_FALSE(fp_relaxed(variant, Backend::cpu));
        EXPECT_EQ(exact_twin(variant, Backend::cpu), variant);
    }
}

TEST(VariantTest, WhatRoundsFreelyOnCudaHasATwinInExactArithmetic) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const struct {
        const char *arithmetic, *precision;
        bool fp_relaxed;
        Claim claim;
    } cases[] = {{"exact", "float", false, Claim::bitwise},       {"precise", "float", true, Claim::statistical},
                 {"fast", "float", true, Claim::statistical},     {"exact", "double", false, Claim::statistical},
                 {"precise", "double", true, Claim::statistical}, {"fast", "double", true, Claim::statistical}};
    for (const auto& c : cases) {
        for (const char* integrator : {"wavefront", "persistent"}) {
            Variant variant = baseline_with(
                {{"integrator", integrator}, {"arithmetic", c.arithmetic}, {"precision", c.precision}}, Backend::cuda);
            variant.tuning["block"] = 256;
            SCOPED_TRACE(variant.spelled_out());
            EXPECT_EQ(fp_relaxed(variant, Backend::cuda), c.fp_relaxed);
            EXPECT_EQ(claim_of(variant, Backend::cuda), c.claim);
            // The twin differs in the arithmetic alone: its choices and tunables stay.
            Variant expected = variant;
            expected.set("arithmetic", "exact");
            const Variant twin = exact_twin(variant, Backend::cuda);
            EXPECT_EQ(twin, expected);
            EXPECT_FALSE(fp_relaxed(twin, Backend::cuda));
            EXPECT_EQ(exact_twin(twin, Backend::cuda), twin);
            EXPECT_EQ(registry().reference(twin, Backend::cuda)["arithmetic"], "exact");
        }
    }
}

TEST(VariantTest, FeatureNamesAreInTheOrderOfResults) {
    EXPECT_TRUE(feature_names(no_features).empty());
    EXPECT_EQ(feature_names(Feature::jitter | Feature::sphere), (std::vector<std::string>{"sphere", "jitter"}));
    const std::vector<std::string> all = feature_names(all_features);
    EXPECT_EQ(all.size(), 37u);
    EXPECT_EQ(all.back(), "shading_normals");
    EXPECT_EQ(feature_names(samplers),
              (std::vector<std::string>{"philox", "sobol_owen", "sobol_rotated", "pmj02", "halton", "minstd"}));
    EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
}

// ---- What applies where ----

constexpr FeatureSet plain_features = Feature::sphere | Feature::emitter;

// A refilled queue knows paths by their slots, which a sort of slot numbers leaves and a sort of paths does not.
TEST(ApplicabilityTest, ASortThatMovesPathsNeedsAQueueThatIsNotRefilled) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "this build has no CUDA backend";
    }
    Variant variant = Registry::instance().baseline(Backend::cuda);
    variant.set("sorting", "bucket");
    variant.tuning["sort_payload"] = 1;
    EXPECT_EQ(why_not_applicable(variant, plain_features, Backend::cuda), "");
    variant.set("integrator", "wavefront_refill");
    EXPECT_EQ(why_not_applicable(variant, plain_features, Backend::cuda),
              "sorting=bucket moves paths with sort_payload=1, but integrator=wavefront_refill puts new paths into the "
              "slots of those that end: needs sort_payload=0");
    variant.tuning["sort_payload"] = 0;
    EXPECT_EQ(why_not_applicable(variant, plain_features, Backend::cuda), "");
}

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
        {{{"first_bounce", "cached_jitters"}}, plain_features | Feature::jitter, ""},
        {{{"first_bounce", "cached_jitters"}}, plain_features | Feature::lens, ""},
        {{{"first_bounce", "cached_jitters"}}, plain_features | Feature::motion, ""},
        {{{"first_bounce", "cached_jitters"}},
         plain_features,
         "first_bounce=cached_jitters needs jitter, a lens or motion; without them first_bounce=cached is it"},
        {{{"russian_roulette", "adjoint"}}, plain_features, ""},
        {{{"russian_roulette", "adjoint_splitting"}},
         plain_features,
         "russian_roulette=adjoint_splitting needs an integrator that keeps the branches of a path: depth_first, "
         "megakernel, megakernel_regen or persistent, not wavefront"},
        {{{"integrator", "depth_first"}, {"russian_roulette", "adjoint_splitting"}}, plain_features, ""},
        {{{"integrator", "depth_first"}, {"russian_roulette", "adjoint_splitting"}, {"robustness", "naive"}},
         plain_features,
         "russian_roulette=adjoint_splitting is compiled for the usual formulas only: needs robustness=robust, another "
         "specialisation than matrix, and precision=float or double"},
        {{{"launch", "graph"}}, plain_features, "launch=graph is not there on the backend cpu"},
        {{{"sort_key", "ray"}}, plain_features, "sort_key=ray is not there on the backend cpu"},
        {{{"precision", "double"}},
         plain_features,
         "precision=double is compiled for a path at a time: needs integrator=depth_first, not wavefront"},
        {{{"precision", "double"}, {"integrator", "depth_first"}},
         plain_features,
         "precision=double is compiled with every feature only: needs specialisation=generic, not features"},
        {{{"direct_light", "nee"}},
         Feature::sphere | Feature::environment | Feature::diffuse,
         "direct_light=nee needs an object that emits, or an environment that is drawn (docs/scene_format.md)"},
        {{{"direct_light", "nee_mis"}},
         plain_features,
         "direct_light=nee_mis needs a diffuse or rough surface to connect"},
        {{{"direct_light", "nee"}}, Feature::sphere | Feature::environment_map | Feature::diffuse, ""},
        {{{"direct_light", "nee_mis"}}, plain_features | Feature::diffuse, ""},
        {{{"direct_light", "nee"}}, plain_features | Feature::mix, ""},
        {{{"direct_light", "nee"}}, plain_features | Feature::rough_conductor, ""},
        {{{"direct_light", "nee"}}, plain_features | Feature::rough_dielectric, ""},
        {{{"direct_light", "nee"}}, plain_features | Feature::principled, ""},
        {{{"sampler", "minstd_by_position"}}, plain_features, ""},
        {{{"sampler", "minstd_by_position"}, {"integrator", "depth_first"}},
         plain_features,
         "sampler=minstd_by_position is seeded by positions in a queue: needs integrator=wavefront"},
        {{{"sampler", "minstd_by_position"}, {"sorting", "bucket"}},
         plain_features,
         "sampler=minstd_by_position needs a sort that gives a path the same position in every run, not bucket"},
        {{{"specialisation", "matrix"}},
         plain_features,
         "specialisation=matrix needs jitter: an unjittered camera ray may meet an edge exactly"},
        {{{"specialisation", "matrix"}, {"sampler", "philox"}},
         plain_features | Feature::jitter,
         "specialisation=matrix is compiled with sampler=pcg4d only"},
        {{{"precision", "double"}, {"integrator", "depth_first"}, {"specialisation", "matrix"}},
         plain_features | Feature::jitter,
         "precision=double is compiled with every feature only: needs specialisation=generic, not matrix"},
        {{{"precision", "double"}, {"integrator", "depth_first"}, {"specialisation", "generic"}}, all_features, ""},
        {{{"arithmetic", "fast"}}, plain_features, "arithmetic=fast is not there on the backend cpu"},
        {{{"integrator", "megakernel"}}, plain_features, "integrator=megakernel is not there on the backend cpu"},
        // What is not there comes before what does not go together.
        {{{"integrator", "depth_first"}, {"sorting", "bucket"}, {"launch", "graph"}},
         plain_features,
         "launch=graph is not there on the backend cpu"},
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
        {{{"integrator", "packet"}}, all_features, ""},
        {{{"integrator", "packet"}, {"compaction", "thrust_remove_if"}},
         plain_features,
         "integrator=packet has no queue to compact: needs compaction=none, not thrust_remove_if"},
        {{{"integrator", "packet"}, {"sorting", "bucket"}},
         plain_features,
         "integrator=packet has no queue to sort: needs sorting=none, not bucket"},
        {{{"integrator", "packet"}, {"layout", "soa"}},
         plain_features,
         "integrator=packet keeps its paths in lanes, no array of paths: needs layout=aos, not soa"},
        {{{"integrator", "packet"}, {"first_bounce", "cached"}},
         plain_features,
         "integrator=packet keeps no first hits: needs first_bounce=off, not cached"},
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
        EXPECT_EQ(why_not_applicable(variant, c.scene), c.reason) << variant.spelled_out();
    }
}

// Programs read the code and the axis: neither changes when a sentence does.
TEST(ApplicabilityTest, ReasonsHaveACodeAndTheAxisThatDoesNotApply) {
    const struct {
        std::vector<std::pair<std::string, std::string>> choices;
        FeatureSet scene;
        std::string_view code, axis;
    } cases[] = {
        {{}, plain_features, "", ""},
        {{{"launch", "graph"}}, plain_features, "not_on_backend", "launch"},
        {{{"integrator", "depth_first"}, {"compaction", "thrust_remove_if"}},
         plain_features,
         "needs_queue",
         "integrator"},
        {{{"integrator", "packet"}, {"first_bounce", "cached"}}, plain_features, "no_first_hits", "integrator"},
        {{{"first_bounce", "cached"}}, plain_features | Feature::jitter, "needs_no_jitter", "first_bounce"},
        {{{"direct_light", "nee"}}, plain_features, "needs_diffuse", "direct_light"},
        {{{"sampler", "minstd_by_position"}, {"integrator", "depth_first"}}, plain_features, "needs_queue", "sampler"},
        {{{"precision", "double"}}, plain_features, "needs_path_at_a_time", "precision"},
        {{{"robustness", "naive"}}, plain_features, "needs_samples_in_order", "robustness"},
    };
    for (const auto& c : cases) {
        const Variant variant = baseline_with(c.choices);
        const Reason reason = reason_not_applicable(variant, c.scene);
        EXPECT_EQ(reason.code, c.code) << variant.spelled_out();
        EXPECT_EQ(reason.axis, c.axis) << variant.spelled_out();
        EXPECT_EQ(reason.text, why_not_applicable(variant, c.scene));
    }
    Variant tuned = registry().baseline();
    tuned.tuning["jitters"] = 4;
    EXPECT_EQ(reason_not_applicable(tuned, plain_features).code, "no_such_tunable");
    EXPECT_EQ(reason_not_applicable(tuned, plain_features).axis, "");
    tuned.set("first_bounce", "cached_jitters");
    tuned.tuning["jitters"] = 5000;
    EXPECT_EQ(reason_not_applicable(tuned, plain_features | Feature::jitter).code, "tunable_out_of_range");
}

TEST(ApplicabilityTest, SaysWordForWordWhichTraversalsDoNotApply) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const FeatureSet with_mesh = plain_features | Feature::mesh;
    const struct {
        std::vector<std::pair<std::string, std::string>> choices;
        FeatureSet scene;
        std::string reason;
    } cases[] = {
        {{{"accelerator", "bvh8"}, {"traversal", "if_if"}, {"traversal_stack", "shared"}}, with_mesh, ""},
        {{{"integrator", "regroup"}, {"accelerator", "bvh8"}}, with_mesh, ""},
        {{{"integrator", "regroup"}, {"accelerator", "bvh8"}, {"traversal_stack", "shared"}},
         with_mesh,
         "integrator=regroup keeps its paths in shared memory: needs traversal_stack=local, not shared"},
        {{{"accelerator", "bvh2"}, {"traversal", "speculative"}, {"traversal_stack", "short_restart"}}, with_mesh, ""},
        {{{"accelerator", "cwbvh"}, {"traversal", "persistent"}, {"precision", "double"}}, with_mesh, ""},
        {{{"traversal", "if_if"}}, plain_features, "traversal=if_if has nothing to do: the scene has no mesh"},
        {{{"traversal_stack", "shared"}},
         with_mesh,
         "traversal_stack=shared has nothing to do: accelerator=brute_force needs no tree"},
        {{{"accelerator", "cwbvh"}, {"traversal", "if_if"}, {"traversal_stack", "short_restart"}}, with_mesh, ""},
        {{{"accelerator", "bvh8"}, {"traversal_stack", "short_restart"}}, with_mesh, ""},
        {{{"accelerator", "cwbvh"}, {"traversal", "persistent"}, {"integrator", "megakernel_regen"}},
         with_mesh,
         "traversal=persistent needs an integrator with a kernel that takes rays through meshes, not "
         "integrator=megakernel_regen"},
    };
    for (const auto& c : cases) {
        const Variant variant = baseline_with(c.choices, Backend::cuda);
        EXPECT_EQ(why_not_applicable(variant, c.scene, Backend::cuda), c.reason) << variant.spelled_out();
    }
    EXPECT_EQ(why_not_applicable(baseline_with({{"accelerator", "bvh2"}, {"traversal", "if_if"}}), with_mesh),
              "traversal=if_if is not there on the backend cpu");
}

TEST(ApplicabilityTest, SaysWordForWordWhatDoesNotApplyOnCuda) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const auto needs_sort = [](const std::string& key) {
        return "sort_key=" + key + " needs a sort, not sorting=none";
    };
    const struct {
        std::vector<std::pair<std::string, std::string>> choices;
        std::string reason;
    } cases[] = {
        {{}, ""},
        {{{"integrator", "depth_first"}}, "integrator=depth_first is not there on the backend cuda"},
        {{{"integrator", "megakernel"}, {"compaction", "gap_fill"}},
         "integrator=megakernel has no queue to compact: needs compaction=none, not gap_fill"},
        {{{"integrator", "megakernel_regen"}, {"sorting", "bucket"}},
         "integrator=megakernel_regen has no queue to sort: needs sorting=none, not bucket"},
        {{{"integrator", "persistent"}, {"layout", "packed"}},
         "integrator=persistent keeps one path in registers, no array of paths: needs layout=aos, not packed"},
        {{{"integrator", "wavefront_materials"}, {"layout", "packed"}, {"launch", "graph"}}, ""},
        {{{"integrator", "wavefront_materials"}, {"compaction", "gap_fill"}},
         "integrator=wavefront_materials appends live paths itself: needs compaction=none, not gap_fill"},
        {{{"integrator", "wavefront_materials"}, {"sorting", "bucket"}},
         "integrator=wavefront_materials appends paths by material itself: needs sorting=none, not bucket"},
        {{{"integrator", "wavefront_refill"}, {"layout", "soa"}, {"sorting", "bucket"}}, ""},
        {{{"integrator", "wavefront_refill"}, {"compaction", "gap_fill"}},
         "integrator=wavefront_refill replaces paths that end: needs compaction=none, not gap_fill"},
        {{{"integrator", "wavefront_refill"}, {"launch", "graph"}},
         "integrator=wavefront_refill ends when the device says so, nothing to capture: needs launch=stream, not "
         "graph"},
        {{{"integrator", "wavefront_refill"}, {"sorting", "cub_radix"}, {"sort_key", "ray"}},
         "integrator=wavefront_refill sorts paths once they have met something: needs a key with the material, not "
         "sort_key=ray"},
        {{{"integrator", "regroup"}, {"layout", "soa"}},
         "integrator=regroup keeps one path in registers, no array of paths: needs layout=aos, not soa"},
        {{{"integrator", "megakernel"}, {"launch", "graph"}},
         "integrator=megakernel is one kernel, nothing to capture: needs launch=stream, not graph"},
        {{{"integrator", "wavefront_fused"}, {"sorting", "bucket"}},
         "integrator=wavefront_fused intersects and shades in one kernel, there is no point at which to sort: needs "
         "sorting=none, not bucket"},
        {{{"sort_key", "ray"}}, needs_sort("ray")},
        {{{"sort_key", "material_hit"}}, needs_sort("material_hit")},
        {{{"sort_key", "chunk_material"}}, needs_sort("chunk_material")},
        {{{"sort_key", "ray"}, {"sorting", "cub_radix"}}, ""},
        {{{"sort_key", "ray"}, {"sorting", "bucket"}},
         "sorting=bucket has a bucket a material, or one in each chunk: needs sort_key=material or chunk_material, not "
         "ray"},
        {{{"sort_key", "material_hit"}, {"sorting", "bucket"}},
         "sorting=bucket has a bucket a material, or one in each chunk: needs sort_key=material or chunk_material, not "
         "material_hit"},
        {{{"sort_key", "chunk_material"}, {"sorting", "bucket"}}, ""},
        {{{"sort_key", "chunk_material"}, {"sorting", "cub_radix"}}, ""},
        {{{"sort_key", "chunk_material"}, {"sorting", "cub_radix_full"}}, ""},
        {{{"sort_key", "chunk_material"}, {"sorting", "thrust_sort_by_key"}}, ""},
        {{{"sort_key", "chunk_material"}, {"sorting", "per_material_queue"}},
         "sorting=per_material_queue has a queue a material: needs sort_key=material, not chunk_material"},
        {{{"sort_key", "material_hit"}, {"sorting", "per_material_queue"}},
         "sorting=per_material_queue has a queue a material: needs sort_key=material, not material_hit"},
        {{{"launch", "graph"}}, ""},
        {{{"launch", "graph"}, {"compaction", "cub_select_if"}, {"sorting", "cub_radix"}}, ""},
        {{{"launch", "graph"}, {"compaction", "thrust_partition"}},
         "launch=graph cannot hold compaction=thrust_partition, which waits for the device"},
        {{{"launch", "graph"}, {"sorting", "thrust_sort_by_key"}},
         "launch=graph cannot hold sorting=thrust_sort_by_key, which waits for the device"},
        {{{"launch", "graph_while"}, {"compaction", "gap_fill"}}, ""},
        {{{"launch", "graph_while"}, {"integrator", "wavefront_fused"}, {"compaction", "atomic_append"}}, ""},
        {{{"launch", "graph_while"}},
         "launch=graph_while ends when the count of paths in play is 0: needs a compaction, not none"},
        {{{"launch", "graph_while"}, {"compaction", "thrust_partition"}},
         "launch=graph_while cannot hold compaction=thrust_partition, which waits for the device"},
        {{{"integrator", "persistent"}, {"launch", "graph_while"}},
         "integrator=persistent is one kernel, nothing to capture: needs launch=stream, not graph_while"},
        {{{"sorting", "thrust_sort_by_key"}, {"compaction", "gap_fill"}}, ""},
        {{{"sorting", "thrust_sort_by_key"}, {"compaction", "cub_partition"}},
         "sorting=thrust_sort_by_key moves a contiguous payload, which compaction=cub_partition does not keep"},
        {{{"precision", "double"}, {"layout", "soa"}}, ""},
        {{{"precision", "double"}, {"layout", "packed"}},
         "layout=packed packs single-precision fields: needs precision=float"},
        {{{"partition", "tiles"}}, "partition=tiles splits work between GPUs: needs devices=2 or more, not 1"},
        {{{"partition", "dynamic"}}, "partition=dynamic splits work between GPUs: needs devices=2 or more, not 1"},
        {{{"devices", "2"}}, ""},
        {{{"devices", "8"}, {"partition", "tiles"}, {"launch", "graph"}}, ""},
        {{{"devices", "2"}, {"integrator", "megakernel"}, {"robustness", "naive"}},
         "devices=2 needs robustness=robust: the textbook's film sums samples in their order"},
        {{{"devices", "2"}, {"sampler", "minstd_by_position"}},
         "devices=2 needs numbers by pixel and sample, not sampler=minstd_by_position"},
        {{{"devices", "4"}, {"first_bounce", "cached"}},
         "devices=4 keeps a pixel's first hits for all of its samples: needs partition=tiles, not samples"},
        {{{"devices", "4"}, {"first_bounce", "cached"}, {"partition", "dynamic"}},
         "devices=4 keeps a pixel's first hits for all of its samples: needs partition=tiles, not dynamic"},
        {{{"devices", "4"}, {"first_bounce", "cached"}, {"partition", "tiles"}}, ""},
    };
    const LookForDevices before = set_look_for_devices(nullptr);
    for (const auto& c : cases) {
        const Variant variant = baseline_with(c.choices, Backend::cuda);
        EXPECT_EQ(why_not_applicable(variant, plain_features, Backend::cuda), c.reason) << variant.spelled_out();
    }
    Variant reading_back = baseline_with({{"launch", "graph"}}, Backend::cuda);
    reading_back.tuning["read_back"] = 1;
    EXPECT_EQ(why_not_applicable(reading_back, plain_features, Backend::cuda),
              "launch=graph cannot hold read_back=1, which waits for the device");
    set_look_for_devices(before);
}

TEST(ApplicabilityTest, SeveralDevicesNeedWhatTheMachineMayLack) {
    EXPECT_TRUE(why_not_on({.count = 1}, 1).empty());
    EXPECT_TRUE(why_not_on({.count = 0}, 8).empty());  // not known: a plan may be listed anywhere
    EXPECT_TRUE(why_not_on({.count = 2}, 2).empty());
    EXPECT_EQ(why_not_on({.count = 2}, 4).code, "needs_devices");
    EXPECT_EQ(why_not_on({.count = 2}, 4).text, "needs 4 GPUs that are alike; found here: 2");
    EXPECT_EQ(why_not_on({.count = 2, .missing = "no library"}, 2).text, "needs NCCL: no library");
    EXPECT_TRUE(why_not_on({.count = 2, .missing = "no library"}, 1).empty());
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    const LookForDevices before = set_look_for_devices([]() -> DevicesHere { return {.count = 2}; });
    EXPECT_EQ(why_not_applicable(baseline_with({{"devices", "2"}}, Backend::cuda), plain_features, Backend::cuda), "");
    EXPECT_EQ(why_not_applicable(baseline_with({{"devices", "3"}}, Backend::cuda), plain_features, Backend::cuda),
              "devices=3 needs 3 GPUs that are alike; found here: 2");
    set_look_for_devices(before);
}

// ---- What a choice left undone ----

struct WorkCase {
    std::string_view axis;
    std::string_view choice;
    WorkCounters good;                                      // in 2 samples
    std::vector<std::pair<WorkCounters, std::string>> bad;  // and what is said of it
    BackendSet backends = on_cpu;
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
    // On CUDA the host counts what it launched; an integrator without a queue has no bounces.
    const WorkCounters launched = with(queued, &WorkCounters::launches, 30);
    const WorkCounters one_kernel = with(idle, &WorkCounters::launches, 1);
    const WorkCounters replayed = with(one_kernel, &WorkCounters::graph_nodes, 25);
    const WorkCounters unrolled = with(queued, &WorkCounters::graph_nodes, 25);
    const WorkCounters looped = with(unrolled, &WorkCounters::loop_rounds, 3);
    const WorkCounters too_short_to_loop = with(unrolled, &WorkCounters::bounces, 6);
    std::vector<WorkCase> cases{
        {"integrator",
         "wavefront",
         queued,
         {{with(queued, &WorkCounters::bounces, 1), "ran fewer bounces over the queue than samples"}}},
        {"integrator", "depth_first", idle, {{queued, "ran a queue"}}},
        {"integrator", "audited", idle, {{queued, "ran a queue"}}, on_cpu},
        {"integrator", "packet", idle, {{queued, "ran a queue"}}},
        {"compaction", "none", queued, {{compacted, "a compaction ran"}}, on_every_backend},
        {"sorting", "none", queued, {{ordered, "a sort ran"}}, on_every_backend},
        {"direct_light",
         "off",
         idle,
         {{with(idle, &WorkCounters::connections, 1), "connected vertices to lights"}},
         on_every_backend},
        {"first_bounce",
         "off",
         idle,
         {{cached, "a cache was used"}, {with(idle, &WorkCounters::cache_hits, 1), "a cache was used"}},
         on_every_backend},
        {"first_bounce",
         "cached",
         cached,
         {{idle, "0 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_fills, 200), "200 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_hits, 99), "not every camera ray came from the cache"}},
         on_every_backend},
        {"first_bounce",
         "cached_jitters",
         cached,
         {{idle, "0 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_fills, 99), "99 cache fills for 200 paths"},
          {with(cached, &WorkCounters::cache_hits, 99), "not every camera ray came from the cache"},
          {with(cached, &WorkCounters::cache_fills, 200), "not every camera ray came from the cache"}},
         on_every_backend},
        {"launch", "stream", one_kernel, {{replayed, "launched a graph"}}, on_every_backend},
        {"launch", "graph", replayed, {{one_kernel, "launched no graph"}}, on_cuda},
        {"launch",
         "graph_while",
         looped,
         {{one_kernel, "launched no graph"}, {unrolled, "no round of a loop ran"}},
         on_cuda},
        {"launch", "graph_while", too_short_to_loop, {{one_kernel, "launched no graph"}}, on_cuda},
    };
    for (const char* name : {"wavefront", "wavefront_fused", "wavefront_materials", "wavefront_refill"}) {
        cases.push_back(
            {"integrator", name, launched, {{one_kernel, "ran no queue"}, {queued, "launched no kernel"}}, on_cuda});
    }
    for (const char* name : {"audited", "megakernel", "megakernel_regen", "persistent", "regroup"}) {
        cases.push_back(
            {"integrator", name, one_kernel, {{launched, "ran a queue"}, {idle, "launched no kernel"}}, on_cuda});
    }
    for (const Backend backend : all_backends) {
        for (const Choice* choice : registry().choices("compaction", backend)) {
            if (choice->descriptor.name != "none") {
                cases.push_back({"compaction",
                                 choice->descriptor.name,
                                 compacted,
                                 {{queued, "0 compactions in 9 bounces, 2 of them last ones"},
                                  {with(compacted, &WorkCounters::compactions, 9),
                                   "9 compactions in 9 bounces, 2 of them last ones"},
                                  {with(compacted, &WorkCounters::compacted_away, 179),
                                   "179 paths taken out and 20 ended in the last segment, of 200"}},
                                 static_cast<BackendSet>(backend)});
            }
        }
        for (const Choice* choice : registry().choices("sorting", backend)) {
            if (choice->descriptor.name != "none") {
                cases.push_back(
                    {"sorting",
                     choice->descriptor.name,
                     ordered,
                     {{queued, "did not sort in every bounce but the last"},
                      {with(ordered, &WorkCounters::sorts, 6), "did not sort in every bounce but the last"}},
                     static_cast<BackendSet>(backend)});
            }
        }
    }
    return cases;
}

TEST(WorkTest, EveryChoiceNoticesWhatItLeftUndone) {
    for (const WorkCase& c : work_cases()) {
        for (const Backend backend : test::built_backends()) {
            if (!contains(c.backends, backend)) {
                continue;
            }
            SCOPED_TRACE(std::string(c.axis) + "=" + std::string(c.choice) + " on " + std::string(to_string(backend)));
            const Choice* choice = registry().find(c.axis, c.choice, backend);
            ASSERT_NE(choice, nullptr);
            const Descriptor& d = choice->descriptor;
            ASSERT_NE(d.check_counters, nullptr);
            EXPECT_EQ(d.check_counters(c.good, 2), "");
            for (const auto& [work, message] : c.bad) {
                EXPECT_EQ(d.check_counters(work, 2), message);
            }
        }
    }
}

TEST(WorkTest, EveryCheckIsTriedAbove) {
    const std::vector<WorkCase> cases = work_cases();
    for (const Backend backend : test::built_backends()) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : registry().choices(axis, backend)) {
                const bool tried = std::any_of(cases.begin(), cases.end(), [&](const WorkCase& c) {
                    return axis == c.axis && choice->descriptor.name == c.choice && contains(c.backends, backend);
                });
                EXPECT_EQ(tried, choice->descriptor.check_counters != nullptr)
                    << choice->descriptor.name << " on " << to_string(backend);
            }
        }
    }
}

// The cache's work is right with as many camera rays kept as there are samples, or fewer.
TEST(WorkTest, ACacheOfSeveralRaysMayBeFilledByEverySample) {
    const Descriptor& d = registry().find("first_bounce", "cached_jitters")->descriptor;
    EXPECT_EQ(d.check_counters({.paths = 200, .rays = 500, .cache_fills = 200, .cache_hits = 0}, 2), "");
    EXPECT_EQ(d.check_counters({.paths = 700, .rays = 900, .cache_fills = 300, .cache_hits = 400}, 7), "");
    EXPECT_EQ(d.check_counters({.paths = 700, .rays = 900, .cache_fills = 350, .cache_hits = 350}, 7),
              "350 cache fills for 700 paths");
}

TEST(WorkTest, TheVariantNamesTheChoice) {
    const Variant variant = baseline_with({{"compaction", "thrust_partition"}});
    EXPECT_EQ(check_counters(variant, {.paths = 4, .rays = 4, .bounces = 3}, 1),
              "compaction=thrust_partition: 0 compactions in 3 bounces, 0 of them last ones");
    EXPECT_EQ(check_counters(variant, {.paths = 4, .bounces = 3, .compactions = 3, .compacted_away = 4}, 1), "");
    if (test::cuda_is_built()) {
        EXPECT_EQ(check_counters(baseline_with({{"launch", "graph"}}, Backend::cuda),
                                 {.paths = 4, .bounces = 3, .launches = 9}, 1, Backend::cuda),
                  "launch=graph: launched no graph");
    }
}

// ---- Kernels ----

FeatureSet chosen_by_features(FeatureSet needed, const std::vector<FeatureSet>& compiled) {
    const Variant variant = baseline_with({{"specialisation", "features"}});
    return registry()
        .find("specialisation", "features")
        ->hook.specialisation({needed, no_features, compiled}, variant, Backend::cpu);
}

TEST(KernelTest, FeaturesTakesTheSmallestSuperset) {
    const FeatureSet a = Feature::sphere | Feature::diffuse;
    const FeatureSet larger = a | Feature::jitter;
    const FeatureSet largest = larger | Feature::lens | Feature::quad;
    const std::vector<FeatureSet> compiled{all_features, largest, a, larger};
    EXPECT_EQ(chosen_by_features(a, compiled), a);
    EXPECT_EQ(chosen_by_features(no_features | Feature::sphere, compiled), a);
    EXPECT_EQ(chosen_by_features(Feature::sphere | Feature::jitter, compiled), larger);
    EXPECT_EQ(chosen_by_features(no_features | Feature::quad, compiled), largest);
    EXPECT_EQ(chosen_by_features(no_features | Feature::subsurface, compiled), all_features);
    EXPECT_EQ(chosen_by_features(a, {all_features}), all_features);
    EXPECT_EQ(chosen_by_features(a, {all_features | Feature::matrix, all_features}), all_features);
}

// A kernel with one way to draw lights draws them in that way, whatever it is asked for.
TEST(KernelTest, FeaturesTakesNoKernelThatDrawsLightsInAnotherWay) {
    const FeatureSet connects = Feature::sphere | Feature::diffuse | Feature::next_event;
    for (const Feature way : {Feature::projected_sampling, Feature::area_sampling, Feature::power_selection}) {
        const FeatureSet fixed = connects | way;
        EXPECT_EQ(chosen_by_features(connects, {all_features, fixed}), all_features);
        EXPECT_EQ(chosen_by_features(fixed, {all_features, connects, fixed}), fixed);
    }
    const FeatureSet at_run_time = connects | Feature::projected_sampling | Feature::area_sampling;
    EXPECT_EQ(chosen_by_features(connects, {all_features, at_run_time}), at_run_time);
}

// A shortcut is taken where the scene allows it, a kernel has it, and nobody asked to leave it out.
TEST(KernelTest, FeaturesTakesTheShortcutsOfTheScene) {
    Variant variant = baseline_with({{"specialisation", "features"}});
    const auto choose = [&](FeatureSet allowed, const std::vector<FeatureSet>& compiled) {
        return registry()
            .find("specialisation", "features")
            ->hook.specialisation({Feature::axis_box | Feature::diffuse, allowed, compiled}, variant, Backend::cpu);
    };
    const FeatureSet plain = Feature::axis_box | Feature::diffuse;
    const FeatureSet quick = plain | Feature::enclosure;
    const FeatureSet larger = quick | Feature::jitter;
    EXPECT_EQ(choose(shortcuts, {all_features, plain, quick}), quick);
    EXPECT_EQ(choose(shortcuts, {all_features, quick, plain}), quick);
    EXPECT_EQ(choose(no_features, {all_features, quick, plain}), plain);
    EXPECT_EQ(choose(no_features, {all_features, quick}), all_features);
    // What a kernel has for nothing weighs more than a shortcut.
    EXPECT_EQ(choose(shortcuts, {all_features, larger, plain}), plain);
    variant.tuning["room"] = 0;
    EXPECT_EQ(choose(shortcuts, {all_features, plain, quick}), plain);
}

TEST(KernelTest, GenericTakesEverythingAndMatrixAnotherFormula) {
    const FeatureSet a = Feature::sphere | Feature::diffuse;
    const auto choose = [&](const char* name) {
        return registry()
            .find("specialisation", name)
            ->hook.specialisation(
                {a, shortcuts, {a, a | Feature::enclosure, all_features, all_features | Feature::matrix}},
                baseline_with({{"specialisation", name}}), Backend::cpu);
    };
    EXPECT_EQ(choose("generic"), all_features);
    EXPECT_EQ(choose("matrix"), all_features | Feature::matrix);
}

// With another sampler than pcg4d, the kernel that has it; of two that do, the one with fewer.
TEST(KernelTest, ASamplerIsInTheKernel) {
    const FeatureSet needed = (Feature::sphere | Feature::diffuse) | Feature::philox;
    const auto choose = [&](const char* name, const std::vector<FeatureSet>& compiled) {
        return registry()
            .find("specialisation", name)
            ->hook.specialisation({needed, no_features, compiled}, baseline_with({{"specialisation", name}}),
                                  Backend::cpu);
    };
    for (const char* name : {"generic", "features"}) {
        EXPECT_EQ(choose(name, {all_features, all_features | samplers}), all_features | samplers);
        EXPECT_EQ(choose(name, {all_features | samplers, all_features | Feature::philox, all_features}),
                  all_features | Feature::philox);
    }
    EXPECT_EQ(choose("features", {all_features | samplers, needed, all_features}), needed);
}

TEST(KernelTest, NoteNamesWhatWasCompiledForNothing) {
    EXPECT_EQ((KernelChoice{plain_features, plain_features, nullptr}).note(), "exact");
    EXPECT_EQ((KernelChoice{plain_features, plain_features | Feature::lens | Feature::mirror, nullptr}).note(),
              "has mirror, lens for nothing");
}

TEST(KernelTest, ASceneThatNoKernelWasMadeForGetsTheNearestOne) {
    const Scene scene = lens_motion_environment();
    for (const char* integrator : {"wavefront", "depth_first", "packet"}) {
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

TEST(KernelTest, DoublePrecisionHasAKernelOfItsOwn) {
    const Scene scene = cornell_like(true).scene;
    Variant variant = baseline_with({{"integrator", "depth_first"}, {"specialisation", "generic"}});
    const KernelChoice single = choose_kernel(scene, variant);
    EXPECT_NE(single.render, nullptr);
    EXPECT_EQ(single.render_in_double, nullptr);
    variant.set("precision", "double");
    const KernelChoice fp64 = choose_kernel(scene, variant);
    EXPECT_EQ(fp64.render, nullptr);
    EXPECT_NE(fp64.render_in_double, nullptr);
    EXPECT_EQ(fp64.compiled, all_features);
}

std::vector<std::filesystem::path> shipped_scene_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(test::in_source("scenes"))) {
        if (entry.path().extension() == ".json") {
            files.push_back(entry.path());
        }
    }
    files.emplace_back(test::in_source("scenes/meshes/icosphere_room.json"));  // the smallest of its kind
    return files;
}

TEST(KernelTest, EveryShippedSceneHasItsExactKernelAndNoKernelIsThereForNothing) {
    std::set<FeatureSet> used;
    for (const auto& file : shipped_scene_files()) {
        const Scene scene = load_scene(file.string());
        EXPECT_EQ(choose_kernel(scene, registry().baseline()).note(), "exact") << file;
        used.insert(features_of(scene));
        used.insert(features_of(scene) | shortcuts_of(scene));
    }
    constexpr FeatureSet estimators = Feature::final_bounce | Feature::next_event | Feature::multiple_importance |
                                      Feature::projected_sampling | Feature::automatic_sampling |
                                      Feature::power_selection | Feature::tree_selection;
    for (const auto& [features, function] : registry().find("integrator", "wavefront")->hook.integrator) {
        if ((features & all_features) != all_features) {
            EXPECT_TRUE(used.contains(features & ~estimators)) << testing::PrintToString(feature_names(features));
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
    // A cache of camera rays also with fewer rays than samples, so that it is used.
    AxisChoices axes = all_choices();
    axes["direct_light"] = {"off", "final_bounce"};
    axes["russian_roulette"] = {"off"};
    axes["sampler"] = {"pcg4d"};
    axes["precision"] = {"float", "double"};
    axes["robustness"] = {"robust"};
    axes["accelerator"] = {"brute_force"};
    axes["builder"] = {"sah_binned"};
    axes["levels"] = {"each_object"};
    axes["light_sampling"] = {"solid_angle"};
    axes["light_selection"] = {"uniform"};
    axes["subsurface_sampling"] = {"classical"};
    for (const Variant& variant : expand(axes, Backend::cpu, {{"jitters", {16, 2}}})) {
        if (!why_not_applicable(variant, features).empty()) {
            continue;
        }
        const Variant reference_variant = registry().reference(variant);
        if (!references.contains(reference_variant)) {
            references.emplace(reference_variant, render_variant(scene, reference_variant));
        }
        const RenderResult& reference = references.at(reference_variant);
        const RenderResult result = render_variant(scene, variant);
        ASSERT_EQ(result.film.sums(), reference.film.sums()) << variant.spelled_out();
        ASSERT_EQ(check_counters(variant, result.work, spp), "") << variant.spelled_out();
        ASSERT_EQ(result.work.paths, 24u * 18u * spp) << variant.spelled_out();
        ASSERT_EQ(result.work.rays + result.work.cache_hits, reference.work.rays + reference.work.cache_hits)
            << variant.spelled_out();
        ASSERT_EQ(result.work.unfinished_walks, reference.work.unfinished_walks) << variant.spelled_out();
        ASSERT_EQ(result.film.faults().nonfinite + result.film.faults().negative, 0u) << variant.spelled_out();
        ++rendered;
    }
    // And the other estimators, by pairs.
    std::map<Variant, RenderResult> of_pairs;
    for (const Variant& variant : covering_variants(all_choices(), features, Backend::cpu)) {
        const Variant reference_variant = registry().reference(variant);
        if (!of_pairs.contains(reference_variant)) {
            of_pairs.emplace(reference_variant, render_variant(scene, reference_variant));
        }
        const RenderResult& reference = of_pairs.at(reference_variant);
        const RenderResult result = render_variant(scene, variant);
        ASSERT_EQ(result.film.sums(), reference.film.sums()) << variant.spelled_out();
        ASSERT_EQ(check_counters(variant, result.work, spp), "") << variant.spelled_out();
        ASSERT_EQ(result.work.rays + result.work.cache_hits, reference.work.rays + reference.work.cache_hits)
            << variant.spelled_out();
        ASSERT_EQ(result.work.connections, reference.work.connections) << variant.spelled_out();
    }
    // 2 x 4 for depth_first and (5 x 3 - 1) x 2 x 2 x 3 for wavefront; each with the first bounce off, and cached, or,
    // with jitter, with 16 and with 2 camera rays kept. 2 x 3 for packet and 2 x 4 for audited, with the first bounce
    // off. Matrices go with jitter only.
    EXPECT_EQ(rendered, scene.camera.jitter ? 3u * 176u + 14u : 2u * 118u + 10u);
    // The comparison means something only if there is light, and if the expectations differ.
    ASSERT_EQ(references.size(), scene.camera.jitter ? 3u * 6u : 4u);
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
    std::vector<Variant> variants{baseline_with({{"integrator", "depth_first"}}),
                                  baseline_with({{"integrator", "packet"}})};
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
            EXPECT_EQ(together.film.sums(), alone.film.sums()) << variant.spelled_out() << " on " << threads;
            EXPECT_EQ(together.work.rays, alone.work.rays) << variant.spelled_out() << " on " << threads;
            EXPECT_EQ(together.work.compacted_away, alone.work.compacted_away)
                << variant.spelled_out() << " on " << threads;
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
    EXPECT_EQ(live, instrumented(baseline_with({{"integrator", "packet"}})).stages.live_paths);
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

// Renders `samples` samples from `first_sample` on with a cache that the caller keeps.
WorkCounters render_with_cache(const Scene& scene, const Variant& variant, FirstBounceCache<float>& cache,
                               std::uint32_t first_sample, std::uint32_t samples) {
    const RenderSettings settings = default_settings(scene);
    const SceneBuffers<float> buffers(scene, settings);
    Film film(settings.width, settings.height, radiance_bound(scene, settings), samples);
    PathQueue queue;
    queue.paths = registry().at("layout", variant).hook.layout();
    const auto compaction = registry().at("compaction", variant).hook.compaction();
    const auto sorting = registry().at("sorting", variant).hook.sorting();
    RenderJob job;
    job.scene = buffers.view();
    job.film = film.view();
    job.first_sample = first_sample;
    job.samples = samples;
    job.queue = &queue;
    job.compaction = compaction.get();
    job.sorting = sorting.get();
    job.cache = &cache;
    choose_kernel(scene, variant).render(job);
    return job.work;
}

TEST(FirstBounceCacheTest, HoldsTheHitsThatWouldBeComputed) {
    constexpr std::uint32_t pixels = 24 * 18;
    for (const std::uint32_t rays : {1u, 3u}) {
        const Scene scene = cornell_like(rays > 1).scene;
        for (const std::string integrator : {"wavefront", "depth_first"}) {
            SCOPED_TRACE(integrator);
            Variant variant =
                baseline_with({{"integrator", integrator}, {"first_bounce", rays > 1 ? "cached_jitters" : "cached"}});
            if (rays > 1) {
                variant.tuning["jitters"] = rays;
            }
            ASSERT_EQ(registry().at("first_bounce", variant).hook.first_bounce(variant, Backend::cpu), rays);
            FirstBounceCache<float> cache;
            cache.rays = rays;
            cache.hits.resize(std::size_t{pixels} * rays);
            EXPECT_FALSE(cache.has(0));
            const WorkCounters filling = render_with_cache(scene, variant, cache, 0, rays);
            EXPECT_EQ(filling.cache_fills, pixels * rays);
            EXPECT_EQ(filling.cache_hits, 0u);
            EXPECT_EQ(cache.samples_seen, rays);
            EXPECT_TRUE(cache.has(cache.samples_seen));

            const test::Stages<float> stages(scene, {.seed = default_settings(scene).seed});
            for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
                for (std::uint32_t sample = 0; sample < rays; ++sample) {
                    const Hit<float> expected = stages.intersect(stages.generate(pixel, sample));
                    ASSERT_EQ(cache.hits[cache.index(pixel, sample)].t, expected.t) << pixel;
                    // What was kept may name the face too.
                    const SurfaceId kept = cache.hits[cache.index(pixel, sample)].side;
                    ASSERT_EQ(kept.exists(), expected.side.exists()) << pixel;
                    if (kept.exists()) {
                        ASSERT_EQ(kept.object(), expected.side.object()) << pixel;
                        ASSERT_EQ(kept.inside(), expected.side.inside()) << pixel;
                    }
                    ASSERT_EQ(cache.index(pixel, sample + 5 * rays), cache.index(pixel, sample));
                }
                for (const std::uint32_t sample : {1u, 77u}) {  // without jitter the camera ray is the same for all
                    const Hit<float> later = stages.intersect(stages.generate(pixel, sample));
                    ASSERT_TRUE(rays > 1 || later.t == cache.hits[pixel].t) << pixel;
                    ASSERT_TRUE(rays > 1 || !later.side.exists() ||
                                later.side.object() == cache.hits[pixel].side.object())
                        << pixel;
                }
            }
            // Later samples change nothing in it and trace no camera ray.
            const std::vector<Hit<float>> before = cache.hits;
            const WorkCounters using_it = render_with_cache(scene, variant, cache, rays, 4);
            EXPECT_EQ(using_it.cache_fills, 0u);
            EXPECT_EQ(using_it.cache_hits, pixels * 4u);
            for (std::size_t i = 0; i < before.size(); ++i) {
                ASSERT_EQ(cache.hits[i].t, before[i].t);
                ASSERT_EQ(cache.hits[i].side.code, before[i].side.code);
            }
        }
    }
    const Variant off = registry().baseline();
    EXPECT_EQ(registry().at("first_bounce", off).hook.first_bounce(off, Backend::cpu), 0u);
}

}  // namespace
}  // namespace pt
