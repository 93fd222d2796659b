// References: as accurate as was asked for, in halves that are independent, and the same from the cache.
#include "harness/error/reference.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "tests/support/command.h"
#include "tests/support/scenes.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

class ReferenceTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::vector<std::string> lines;

    ReferenceMaker maker() {
        return ReferenceMaker(
            folder.path().string(),
            {.is_stopped = [] { return false; }, .says = [this](const std::string& line) { lines.push_back(line); }});
    }
    std::string file_ending(const std::string& ending) const {
        for (const std::string& name : folder.content()) {
            if (name.ends_with(ending)) {
                return folder.file(name);
            }
        }
        return "";
    }
};

// A ball under a white sky, and a lamp.
ReferenceTask ball(double variance, std::uint64_t most_spp) {
    test::SceneBuilder builder;
    builder.image(6, 5, 60, true).environment(1);
    builder.sphere(builder.diffuse({0.5, 0.5, 0.5}), {0, 0, 3}, 2);
    builder.sphere(builder.diffuse({0.9, 0.2, 0.5}), {0, -101, 3}, 200);
    builder.sphere(builder.emitter({4, 4, 4}), {1, 2, 2}, 0.8);
    builder.scene.name = "ball";
    builder.scene.hash = "0123456789abcdef";
    return {.scene = std::make_shared<const Scene>(builder.scene),
            .width = 6,
            .height = 5,
            .depth = 3,
            .variance = variance,
            .most_spp = most_spp};
}

TEST_F(ReferenceTest, SamplesAreDoubledUntilTheVarianceIsReached) {
    const Reference rough = maker().make(ball(1e300, 4096));
    EXPECT_EQ(rough.spp_per_half, 64u);
    EXPECT_GT(rough.noise.variance, 0);
    const double wanted = rough.noise.variance / 6;
    const Reference fine = maker().make(ball(wanted, 1u << 20));
    EXPECT_LE(fine.noise.variance, wanted);
    EXPECT_GE(fine.spp_per_half, 128u);
    EXPECT_LE(fine.spp_per_half, 4096u);
    EXPECT_EQ(fine.spp_per_half & (fine.spp_per_half - 1), 0u);
    EXPECT_NE(fine.first, fine.second);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].find("reference ball/6x5/depth:3/cpu: 64 spp a half, variance "), 0u) << lines[0];

    // Or until there are as many as allowed; and a smaller error of mse_dual asks for more as well.
    EXPECT_EQ(ReferenceMaker("").make(ball(0, 200)).spp_per_half, 200u);
    const Reference improved = ReferenceMaker("").make(ball(1e300, 1u << 20), rough.noise.dual_error / 6);
    EXPECT_LE(improved.noise.dual_error, rough.noise.dual_error / 6);
    EXPECT_GE(improved.spp_per_half, 128u);
}

// What was rendered in steps is what one render of all samples leaves, up to the rounding of the mean.
TEST_F(ReferenceTest, HalvesAreTheMeansOfTheirSeedsSamples) {
    const ReferenceTask task = ball(0, 256);
    const Reference reference = ReferenceMaker("").make(task);
    const Variant variant = reference_variant(task);
    EXPECT_EQ(reference.variant, shown_name(variant, Backend::cpu));
    EXPECT_EQ(reference.variant_id, variant_id(variant, Backend::cpu));
    EXPECT_EQ(variant["integrator"], "depth_first");
    EXPECT_EQ(variant["specialisation"], "generic");
    for (const int half : {0, 1}) {
        const RenderSettings settings{6, 5, 3, reference_seeds[half], false};
        const Image whole =
            image_of(render(*task.scene, {.variant = variant, .settings = settings, .samples = 256}).film);
        const Image& steps = half == 0 ? reference.first : reference.second;
        ASSERT_EQ(whole.size(), steps.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            EXPECT_NEAR(steps[i], whole[i], 1e-9) << i;
        }
    }
}

// Ten thousand objects with meshes are not tried each in turn.
TEST_F(ReferenceTest, ManyObjectsWithMeshesAreSearchedByATree) {
    const auto levels_of = [](const char* scene) {
        return reference_variant({.scene = std::make_shared<const Scene>(find_scene(scene)),
                                  .width = 6,
                                  .height = 5,
                                  .depth = 3,
                                  .backend = Backend::cpu,
                                  .variance = 1,
                                  .most_spp = 64})["levels"];
    };
    EXPECT_EQ(levels_of("meshes/lights_10k_above"), "two_level");
    EXPECT_EQ(levels_of("meshes/icosphere_room"), "each_object");
    EXPECT_EQ(levels_of("cornell_open"), "each_object");
}

TEST_F(ReferenceTest, TheCacheGivesTheSameBitsBackAndGoesOnFromThem) {
    const Reference made = maker().make(ball(1e300, 4096));
    const Reference again = maker().make(ball(1e300, 4096));
    EXPECT_EQ(lines.size(), 1u);  // the second was not rendered
    EXPECT_EQ(again.first, made.first);
    EXPECT_EQ(again.second, made.second);
    EXPECT_EQ(again.provenance(), made.provenance());
    EXPECT_EQ(folder.content().size(), 2u);

    const Reference extended = maker().make(ball(0, 128));
    EXPECT_EQ(extended.spp_per_half, 128u);
    EXPECT_EQ(extended.hash, ReferenceMaker("").make(ball(0, 128)).hash);
    EXPECT_EQ(folder.content().size(), 2u);

    ReferenceTask deeper = ball(1e300, 64);
    deeper.depth = 4;
    maker().make(deeper);
    EXPECT_EQ(folder.content().size(), 4u);
}

TEST_F(ReferenceTest, ADamagedOrForeignFileIsRefusedInALineAndMadeAgain) {
    const Reference made = maker().make(ball(1e300, 64));
    const std::string numbers = file_ending(".f64");
    const std::string json = file_ending(".json");
    const std::string good_numbers = test::content_of(numbers);
    const std::string good_json = test::content_of(json);
    std::string flipped = good_numbers;
    flipped[100] = static_cast<char>(flipped[100] ^ 1);
    std::string foreign = good_json;
    foreign.replace(foreign.find("0123456789abcdef"), 16, "0000000000000000");
    foreign.replace(foreign.rfind("0123456789abcdef"), 16, "0000000000000000");
    const struct {
        std::string json, numbers, reason;
    } cases[] = {{good_json, flipped, "its numbers are not those that were written"},
                 {good_json, good_numbers.substr(8), "its numbers are not those that were written"},
                 {"{}", good_numbers, "it is of something else"},
                 {foreign, good_numbers, "it is of something else"},
                 {good_json.substr(0, 50), good_numbers, ""}};
    for (const auto& c : cases) {
        SCOPED_TRACE(c.reason);
        test::write_text(json, c.json);
        test::write_text(numbers, c.numbers);
        lines.clear();
        const Reference again = maker().make(ball(1e300, 64));
        EXPECT_EQ(again.hash, made.hash);
        ASSERT_EQ(lines.size(), 2u);
        EXPECT_EQ(lines[0].find(json + ": refused and made again: " + c.reason), 0u) << lines[0];
        EXPECT_EQ(lines[0].find('\n'), std::string::npos);
        EXPECT_EQ(test::content_of(json), good_json);
        EXPECT_EQ(test::content_of(numbers), good_numbers);
    }
}

TEST_F(ReferenceTest, AFolderThatCannotBeWrittenIsNoReasonToStop) {
    test::write_text(folder.file("taken"), "a file");
    const ReferenceMaker blocked(
        folder.file("taken"),
        {.is_stopped = [] { return false; }, .says = [this](const std::string& line) { lines.push_back(line); }});
    EXPECT_EQ(blocked.make(ball(1e300, 64)).spp_per_half, 64u);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].find("the reference is not kept: "), 0u) << lines[0];
}

TEST_F(ReferenceTest, AStopLeavesWhatIsThere) {
    int asked = 0;
    const ReferenceMaker stopped("", {.is_stopped = [&] { return ++asked > 2; }, .says = [](const std::string&) {}});
    EXPECT_EQ(stopped.make(ball(0, 1u << 20)).spp_per_half, 128u);
}

TEST_F(ReferenceTest, AClosedFormNeedsNoSamples) {
    ReferenceTask task = ball(0, 64);
    test::SceneBuilder builder;
    builder.sphere(builder.diffuse({0.5, 0.5, 0.5}, {1, 1, 1}), {0, 0, 0}, 2);
    task.scene = std::make_shared<const Scene>(builder.scene);
    const Reference reference = maker().make(task);
    EXPECT_TRUE(reference.is_closed_form);
    EXPECT_EQ(reference.first, reference.second);
    EXPECT_EQ(reference.first.front(), 1.75);
    EXPECT_EQ(reference.noise.variance, 0);
    EXPECT_EQ(reference.noise.mean_square, 1.75 * 1.75);
    EXPECT_EQ(reference.provenance().at("kind"), "closed_form");
    EXPECT_EQ(reference.provenance().at("formula"), "emission * (1 + a + ... + a^2), a: albedo");
    EXPECT_FALSE(reference.provenance().contains("spp_per_half"));
    EXPECT_TRUE(folder.content().empty());
}

// The route may be chosen where the plainest is too slow; the image is that of plain paths of the task's depth.
TEST_F(ReferenceTest, AnotherRouteHasTheSameMean) {
    ReferenceTask task = ball(0, 2048);
    const Reference plain = maker().make(task);
    task.axes = {{"direct_light", "final_bounce"}};
    EXPECT_EQ(task.name(), "ball/6x5/depth:3/cpu/direct_light=final_bounce");
    const Reference connected = maker().make(task);
    EXPECT_NE(connected.hash, plain.hash);
    EXPECT_EQ(folder.content().size(), 4u);
    const Image a = plain.mean();
    const Image b = connected.mean();
    double difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - b[i]) / static_cast<double>(a.size());
    }
    const double error = std::sqrt((plain.noise.variance + connected.noise.variance) / (a.size() / 3.0));
    EXPECT_LT(std::abs(difference), 4.5 * error);
    EXPECT_EQ(depth_for_mean_of(reference_variant(task), Backend::cpu, 3), 2u);
    EXPECT_EQ(depth_for_mean_of(reference_variant(task), Backend::cpu, 1), 0u);
}

TEST(ReferenceFolder, IsThatOfCaches) {
    ::setenv("XDG_CACHE_HOME", "/somewhere", 1);
    EXPECT_EQ(default_reference_folder(), "/somewhere/ptbench/references");
    ::unsetenv("XDG_CACHE_HOME");
    ::setenv("HOME", "/home/someone", 1);
    EXPECT_EQ(default_reference_folder(), "/home/someone/.cache/ptbench/references");
}

}  // namespace
}  // namespace pt
