// The statistical verification, tried with choices that this file registers (test_*): equal in the mean, or not.
#include "harness/bench/verify_statistical.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/scenes.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

// A room whose walls glow: little noise.
Scene glowing_room() {
    test::SceneBuilder builder;
    builder.room(builder.diffuse({0.6, 0.5, 0.4}, {0.2, 0.3, 0.4}), {0, 0, 0}, {2, 2, 2});
    builder.sphere(builder.diffuse({0.8, 0.8, 0.8}, {0.1, 0, 0.1}), {0.3, -0.4, 1}, 0.9);
    builder.image(16, 12, 70, true).depth(4);
    return builder.scene;
}

void render_others(RenderJob& job) {
    job.first_sample += 1000;
    Registry::instance().find("integrator", "depth_first")->hook.integrator.at(all_features)(job);
}

void render_brighter(RenderJob& job) {
    render_others(job);
    for (std::size_t i = 0; i < std::size_t{3} * job.scene.pixel_count(); ++i) {
        job.film.sums[i] += job.film.sums[i] / 50;
    }
}

void render_the_same_sample_again(RenderJob& job) {
    job.first_sample = 0;
    Registry::instance().find("integrator", "depth_first")->hook.integrator.at(all_features)(job);
}

void render_a_nan(RenderJob& job) {
    render_others(job);
    job.film.add(5, Vec3<float>(std::numeric_limits<float>::quiet_NaN()));
}

Descriptor test_choice(std::string_view axis, std::string_view name, std::string_view mean_of,
                       std::uint32_t extra_depth = 0) {
    return {.axis = axis,
            .name = name,
            .summary = "for a test",
            .origin = "this test",
            .claim = Claim::statistical,
            .claim_note = "for a test",
            .mean_of = mean_of,
            .mean_at_extra_depth = extra_depth};
}

const IntegratorRegistration integrators[] = {
    {test_choice("integrator", "test_others", "depth_first"), all_features, render_others},
    {test_choice("integrator", "test_brighter", "depth_first"), all_features, render_brighter},
    {test_choice("integrator", "test_again", "depth_first"), all_features, render_the_same_sample_again},
    {test_choice("integrator", "test_nan", "depth_first"), all_features, render_a_nan},
};
const Registration adds_nothing(test_choice("direct_light", "test_adds_nothing", "off", 1),
                                {.features = [] { return no_features; }});
// Has the mean of a choice that has the mean of a third.
const Registration adds_two(test_choice("direct_light", "test_adds_two", "test_adds_nothing", 2),
                            {.features = [] { return no_features; }});

Variant with(std::string_view axis, const std::string& choice) {
    Variant variant = Registry::instance().baseline();
    variant.set(axis, choice);
    return variant;
}

MeanVerdict check(const std::string& axis, const std::string& choice) {
    const Scene scene = glowing_room();
    RenderSettings settings = default_settings(scene);
    settings.seed = 1;
    StatisticalVerifier verifier(scene, settings, {.runs = 12, .spp = 16}, Backend::cpu);
    const Variant image = Registry::instance().reference(with(axis, choice));
    return verifier.check(claim_of_mean(image, settings.depth, Backend::cpu));
}

TEST(VerifyStatisticalTest, AClaimNamesItsBaselineAndTheDepthOfItsExpectation) {
    const MeanClaim light = claim_of_mean(with("direct_light", "final_bounce"), 8, Backend::cpu);
    EXPECT_EQ(light.tested, with("direct_light", "final_bounce"));
    EXPECT_EQ(shown_name(light.baseline, Backend::cpu), "depth_first specialisation=generic");
    EXPECT_EQ(light.depth, 8u);
    EXPECT_EQ(light.baseline_depth, 9u);
    EXPECT_FALSE(light.same_sampling);
    const MeanClaim matrix = claim_of_mean(with("specialisation", "matrix"), 8, Backend::cpu);
    EXPECT_EQ(matrix.baseline, light.baseline);
    EXPECT_EQ(matrix.baseline_depth, 8u);
    EXPECT_TRUE(matrix.same_sampling);
}

TEST(VerifyStatisticalTest, ExtraDepthsAddUpAlongAChainOfClaims) {
    const MeanClaim claim = claim_of_mean(with("direct_light", "test_adds_two"), 8, Backend::cpu);
    EXPECT_EQ(claim.baseline["direct_light"], "off");
    EXPECT_EQ(claim.depth, 8u);
    EXPECT_EQ(claim.baseline_depth, 11u);
}

TEST(VerifyStatisticalTest, AComparisonOfTwoVariantsIsAtDepthsOfOneExpectation) {
    const Variant plain = with("direct_light", "off"), light = with("direct_light", "final_bounce");
    const MeanClaim deeper = claim_against(light, plain, 8, Backend::cpu);
    EXPECT_EQ(deeper.depth, 8u);
    EXPECT_EQ(deeper.baseline_depth, 9u);
    const MeanClaim shallower = claim_against(plain, light, 8, Backend::cpu);
    EXPECT_EQ(shallower.depth, 8u);
    EXPECT_EQ(shallower.baseline_depth, 7u);
    const MeanClaim shallowest = claim_against(plain, light, 1, Backend::cpu);
    EXPECT_EQ(shallowest.depth, 2u);
    EXPECT_EQ(shallowest.baseline_depth, 1u);
    // Frozen camera rays leave pixels black more often.
    EXPECT_FALSE(claim_against(with("first_bounce", "cached_jitters"), plain, 8, Backend::cpu).same_sampling);
    EXPECT_TRUE(claim_against(with("layout", "soa"), plain, 8, Backend::cpu).same_sampling);
}

TEST(VerifyStatisticalTest, EqualMeansHold) {
    for (const auto& [axis, choice] : std::vector<std::pair<std::string, std::string>>{
             {"integrator", "test_others"}, {"direct_light", "final_bounce"}, {"specialisation", "matrix"}}) {
        const MeanVerdict verdict = check(axis, choice);
        EXPECT_TRUE(verdict.holds) << choice << ": " << verdict.message;
        EXPECT_EQ(verdict.message.find("same mean as depth_first specialisation=generic at depth "), 0u)
            << verdict.message;
    }
}

TEST(VerifyStatisticalTest, ABiasOfTwoPercentIsFound) {
    const MeanVerdict verdict = check("integrator", "test_brighter");
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message.find("not the mean of depth_first specialisation=generic at depth 4: "), 0u)
        << verdict.message;
}

TEST(VerifyStatisticalTest, LightThatIsNotAddedIsFound) {
    const MeanVerdict verdict = check("direct_light", "test_adds_nothing");
    EXPECT_FALSE(verdict.holds) << verdict.message;
}

// A variant that takes the same samples again has the right mean over seeds, but more samples make nothing better.
TEST(VerifyStatisticalTest, SamplesThatRepeatAreFound) {
    const MeanVerdict verdict = check("integrator", "test_again");
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(
        verdict.message.find("samples are not independent, tested with depth_first specialisation=generic at depth "),
        0u)
        << verdict.message;
    EXPECT_NE(verdict.message.find(": independence (excess variance of a run): p image "), std::string::npos)
        << verdict.message;
}

TEST(VerifyStatisticalTest, AFilmWithFaultsIsNoImage) {
    try {
        check("integrator", "test_nan");
        FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what())
                      .find("1 non-finite, 0 negative and 0 saturated samples of test_nan specialisation=generic"),
                  0u)
            << error.what();
    }
}

}  // namespace
}  // namespace pt
