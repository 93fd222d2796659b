// kernels/health.h: every counter counts what it says, on paths made to be wrong, and nothing on right ones; and
// looking does not change a film.
#include <limits>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "kernels/health.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;
using Generic = Config<float, all_features>;

Scene furnace(std::uint32_t depth) {
    SceneBuilder builder;
    builder.image(8, 8, 90, true).depth(depth);
    builder.sphere(builder.diffuse(Vec3d(0.5), Vec3d(0.5)), {0, 0, 0}, 2);
    return builder.scene;
}

RenderResult audited(const Scene& scene, const std::map<std::string, std::string>& axes = {},
                     std::uint32_t samples = 4) {
    Variant variant = Registry::instance().reference(Registry::instance().baseline());
    variant.set("integrator", "audited");
    for (const auto& [axis, choice] : axes) {
        variant.set(axis, choice);
    }
    RenderRequest request{.variant = variant, .settings = default_settings(scene), .samples = samples};
    request.settings.seed = 1;
    return render(scene, request);
}

// A scene, a path in it, and what an inspection of it says.
class InspectionTest : public testing::Test {
protected:
    InspectionTest() : buffers_(furnace(9), default_settings(furnace(9))) {
        path_ = generate<Generic>(view(), 3, 5);
        hit_ = closest_hit<Generic>(view(), ray_of(path_));
    }
    const SceneView<float>& view() const { return buffers_.view(); }
    Inspection<Generic> inspection(BodySet around_eye = 1) { return {view(), around_eye, true, counters_}; }
    std::uint64_t nonfinite(HealthSite site) const { return counters_.nonfinite[static_cast<std::uint32_t>(site)]; }

    SceneBuffers<float> buffers_;
    HealthCounters counters_;
    Path<float> path_;
    Hit<float> hit_;
};

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

TEST_F(InspectionTest, FindsNothingWrongWithARightPath) {
    auto look = inspection();
    look.camera(path_);
    look.hit(path_, hit_);
    look.shaded(path_, true);
    for (const std::uint64_t count : counters_.nonfinite) {
        EXPECT_EQ(count, 0u);
    }
    EXPECT_EQ(counters_.negative + counters_.gains + counters_.self_hits + counters_.parity_errors, 0u);
    EXPECT_EQ(counters_.segments, 1u);
    EXPECT_LT(counters_.worst_normal, std::uint64_t{1} << 20);  // 2^-20
}

TEST_F(InspectionTest, CountsNumbersThatAreNoneBySiteAndKeepsTheFirst) {
    auto look = inspection();
    path_.direction.x = not_a_number;
    look.camera(path_);
    look.shaded(path_, true);
    path_.direction.x = 0;
    path_.throughput.y = infinite;
    look.shaded(path_, true);
    path_.throughput.y = 1;
    path_.radiance.z = not_a_number;
    look.shaded(path_, false);
    hit_.t = infinite;
    look.hit(path_, hit_);
    EXPECT_EQ(nonfinite(HealthSite::camera), 1u);
    EXPECT_EQ(nonfinite(HealthSite::direction), 1u);
    EXPECT_EQ(nonfinite(HealthSite::throughput), 1u);
    EXPECT_EQ(nonfinite(HealthSite::radiance), 1u);
    EXPECT_EQ(nonfinite(HealthSite::hit), 1u);
    EXPECT_EQ(counters_.first_nonfinite[static_cast<std::uint32_t>(HealthSite::camera)], HealthCounters::key(3, 5, 0));
    EXPECT_LT(HealthCounters::key(3, 5, 7), HealthCounters::key(3, 6, 0));
    EXPECT_LT(HealthCounters::key(3, 6, 7), HealthCounters::key(4, 0, 0));
}

TEST_F(InspectionTest, CountsNegativeAndGrowingThroughput) {
    auto look = inspection();
    path_.throughput = {1, 1, 1};
    look.shaded(path_, true);
    EXPECT_EQ(counters_.gains, 0u);
    path_.throughput = {1, 1, 1.0001f};
    look.shaded(path_, true);
    EXPECT_EQ(counters_.gains, 1u);
    path_.throughput = {0.5f, -0.1f, 0.5f};
    look.shaded(path_, true);
    EXPECT_EQ(counters_.negative, 1u);
}

TEST_F(InspectionTest, CountsBodiesMetFromTheWrongSideAndAgain) {
    auto knows_nothing = inspection(0);  // as if the eye were outside the sphere that it is in
    knows_nothing.hit(path_, hit_);
    EXPECT_EQ(counters_.parity_errors, 1u);
    EXPECT_EQ(counters_.first_parity_error, HealthCounters::key(3, 5, 0));
    auto look = inspection(0);
    path_.origin_surface = SurfaceId::of(0, false);
    hit_.side = SurfaceId::of(0, false);
    hit_.t = 1e-4f;
    look.hit(path_, hit_);
    EXPECT_EQ(counters_.self_hits, 1u);
    hit_.t = 1e-2f;  // too far for a rounding
    look.hit(path_, hit_);
    EXPECT_EQ(counters_.self_hits, 1u);
}

TEST_F(InspectionTest, CountersGoTogetherBySumLeastAndMost) {
    HealthCounters other;
    counters_.paths = 2;
    other.paths = 3;
    counters_.worst_normal = 7;
    other.worst_normal = 5;
    other.first_self_hit = 9;
    counters_.add(other);
    EXPECT_EQ(counters_.paths, 5u);
    EXPECT_EQ(counters_.worst_normal, 7u);
    EXPECT_EQ(counters_.first_self_hit, 9u);
}

TEST(AuditedTest, FilmAndWorkAreThoseOfThePlainIntegrator) {
    SceneBuilder builder;
    builder.image(16, 12, 70, true).depth(6).environment(0.25);
    builder.camera({0, 1, -4}, {0, 0.5, 0});
    builder.box(builder.diffuse(Vec3d(0.75)), {0, -0.5, 0}, {10, 1, 10});
    builder.sphere(builder.dielectric(1.5), {-0.8, 0.6, 0}, 1.2);
    builder.sphere(builder.subsurface(Vec3d(8.0)), {0.8, 0.5, 0}, 1);
    builder.quad(builder.emitter(Vec3d(4.0)), {0, 3, 0}, 1, 1);
    const Variant plain = Registry::instance().reference(Registry::instance().baseline());
    for (const char* robustness : {"robust", "naive"}) {
        Variant variant = plain;
        variant.set("robustness", robustness);
        RenderRequest request{.variant = variant, .settings = default_settings(builder.scene), .samples = 4};
        request.settings.seed = 1;
        const RenderResult expected = render(builder.scene, request);
        const RenderResult result = audited(builder.scene, {{"robustness", robustness}});
        EXPECT_EQ(result.film.hash(), expected.film.hash()) << robustness;
        EXPECT_EQ(result.work.rays, expected.work.rays);
        EXPECT_EQ(result.health.paths, expected.work.paths);
        EXPECT_EQ(result.health.segments, expected.work.rays);
        EXPECT_EQ(expected.health.paths, 0u);  // nobody looked
    }
}

TEST(AuditedTest, EnergyThatCappedPathsCarriedIsExact) {
    const RenderResult result = audited(furnace(4));
    EXPECT_EQ(result.health.capped, result.health.paths);
    EXPECT_EQ(result.health.capped_energy, result.health.paths * (std::uint64_t{1} << 29));  // 0.5^3
    EXPECT_EQ(result.health.escaped, 0u);
    EXPECT_EQ(result.health.segments, 4 * result.health.paths);
}

TEST(AuditedTest, AnEpsilonIsSeenToFailWhereRobustFormsDoNot) {
    // A sphere no larger than the epsilon: its far side is never met, or at the wrong place.
    Scene scene = test::scaled(furnace(9), 0x1p-14);
    scene.camera.eye = Vec3d(0.0);
    EXPECT_EQ(audited(scene).health.escaped, 0u);
    EXPECT_GT(audited(scene, {{"robustness", "naive"}}).health.escaped, 0u);
}

}  // namespace
}  // namespace pt
