// Every variant of every shipped scene is held to its claim: what `ptbench verify --scene all` does, at small size.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/scene/places.h"
#include "tests/support/places.h"

namespace pt {
namespace {

std::vector<std::string> shipped_scenes() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(test::in_source("scenes"))) {
        if (entry.path().extension() == ".json") {
            names.push_back(entry.path().stem().string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

Scene shipped(const std::string& name) { return load_scene(test::in_source("scenes/" + name + ".json")); }

std::string first_with(FeatureSet features) {
    const std::vector<std::string> names = shipped_scenes();
    return *std::find_if(names.begin(), names.end(),
                         [&](const std::string& name) { return features_of(shipped(name)) == features; });
}

// 14, and more where somebody has added a compaction: one that leaves the paths in their slots cannot go with
// thrust_sort_by_key, which moves them.
std::size_t queue_variants() {
    const std::vector<const Choice*> compactions = Registry::instance().choices("compaction");
    const auto scattering = std::count_if(compactions.begin(), compactions.end(), [](const Choice* choice) {
        return !traits_in<CompactionTraits>(choice->descriptor).payload_contiguous;
    });
    return compactions.size() * Registry::instance().choices("sorting").size() - static_cast<std::size_t>(scattering);
}

class ShippedScene : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScene, HoldsTheClaimOfEveryVariant) {
    const Scene scene = shipped(GetParam());
    RenderSettings settings = default_settings(scene);
    settings.width = 32;
    settings.height = 24;
    settings.seed = 7;
    Verifier verifier(scene, settings, 3);
    const FeatureSet features = features_of(scene);
    std::size_t held = 0;
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
    // The kernels of a scene are those of the first with its features: all of them there, every pair of choices here.
    const bool is_first = first_with(features) == GetParam();
    for (const Variant& variant : is_first ? expand(axes, Backend::cpu, {{"jitters", {16, 2}}})
                                           : covering_variants(axes, features, Backend::cpu)) {
        if (!why_not_applicable(variant, features).empty()) {
            continue;
        }
        const Verdict verdict = verifier.check(variant);
        EXPECT_TRUE(verdict.holds) << variant.spelled_out() << ": " << verdict.message;
        held += 1;
    }
    if (!is_first) {
        EXPECT_GT(held, 15u);
        return;
    }
    // The queue variants (14: compaction x sorting less the pair that does not apply) in 2 layouts and depth_first,
    // each in 3 kernels, and the one of depth_first in double, with the last bounce on and off; each with the first
    // bounce off, and cached, or, where camera rays vary, with 16 and with 2 of them kept. packet and audited with the
    // first bounce off only.
    const bool varies = (features & (Feature::jitter | Feature::lens | Feature::motion)) != 0;
    // Matrices go with jitter only.
    const unsigned kernels = contains(features, Feature::jitter) ? 3u : 2u;
    const std::size_t queues = queue_variants();
    EXPECT_EQ(held, ((queues * 2u + 1u) * kernels + 1u) * 2u * (varies ? 3u : 2u) + 2u * kernels + 2u * (kernels + 1u));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShippedScene, testing::ValuesIn(shipped_scenes()),
                         [](const testing::TestParamInfo<std::string>& scene) { return scene.param; });

}  // namespace
}  // namespace pt
