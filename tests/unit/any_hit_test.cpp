// Shadow rays against the closest hit, which is the exact oracle: a light is seen if and only if it is the closest hit,
// and then at the same t and side.
#include <random>

#include <gtest/gtest.h>

#include "harness/scene/scene_buffers.h"
#include "kernels/any_hit.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

// Shapes of every kind at random places, with twins in one place: ties, which the object's number decides.
Scene random_scene(std::mt19937& random, bool moves, bool has_ground) {
    std::uniform_real_distribution<double> place(-2, 2), size(0.3, 1.5), turn(0, 90);
    const auto somewhere = [&] { return Vec3d(place(random), place(random), place(random)); };
    test::SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    for (int i = 0; i < 2; ++i) {
        for (const bool twice : {false, true}) {
            const Vec3d centre = somewhere(), extent{size(random), size(random), size(random)};
            const Vec3d angles{turn(random), turn(random), turn(random)};
            for (int copy = 0; copy < (twice ? 2 : 1); ++copy) {
                builder.sphere(white, centre, extent.x);
                builder.ellipsoid(white, centre, extent, angles);
                builder.box(white, centre, extent);
                builder.box(white, centre, extent, angles);
                builder.quad(white, centre, extent.x, extent.y, angles);
            }
        }
    }
    if (has_ground) {  // which the eye, at the origin, stands on
        builder.sphere(white, {0, -1e4, 0}, 2e4 - 1);
    }
    if (moves) {
        builder.scene.camera.shutter_close = 1;
        for (SceneObject& object : builder.scene.objects) {
            object.velocity = somewhere();
        }
    }
    return builder.scene;
}

template <class Config>
void expect_same_as_closest(bool moves = false, bool has_ground = false) {
    using Real = typename Config::Real;
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> coordinate(-3, 3), unit(0, 1);
    std::size_t seen = 0, hidden = 0, missed = 0, open = 0;
    for (int number = 0; number < 20; ++number) {
        const Scene scene = random_scene(random, moves, has_ground);
        const SceneBuffers<Real> buffers(scene, default_settings(scene));
        const SceneView<Real>& view = buffers.view();
        for (int i = 0; i < 2000; ++i) {
            const auto direction = [&] {
                return normalize(Vec3<Real>{coordinate(random), coordinate(random), coordinate(random)});
            };
            Ray<Real> ray{{coordinate(random), coordinate(random), coordinate(random)}, direction(), unit(random), {}};
            for (int bounce = 0; bounce < 2; ++bounce) {
                const Hit<Real> closest = closest_hit<Config>(view, ray);
                for (std::uint32_t object = 0; object < object_count(view); ++object) {
                    const Hit<Real> found = unoccluded_hit<Config>(view, object, ray);
                    const bool is_seen = closest.side.exists() && closest.side.object() == object;
                    ASSERT_EQ(found.side.exists(), is_seen) << number << " " << i << " " << object;
                    if (is_seen) {
                        ASSERT_EQ(found.t, closest.t);
                        ASSERT_EQ(found.side.code, closest.side.code);
                    }
                    const bool is_met = meets_shapes<Config> && hit_with<Config>(view, object, ray).side.exists();
                    (is_seen ? seen : is_met ? hidden : missed) += 1;
                }
                if constexpr (meets_shapes<Config>) {
                    const Hit<Real> nowhere{std::numeric_limits<Real>::infinity(), {}};
                    ASSERT_EQ(any_hit<Config>(view, ray, nowhere), closest.side.exists());
                    open += closest.side.exists() ? 0 : 1;
                }
                if (!closest.side.exists()) {
                    break;
                }
                const SurfacePoint<Real> point = surface_at<Config>(view, ray, closest);
                ray = {point.position, direction(), ray.time, SurfaceId::of(closest.side.object(), i % 2 == 0)};
            }
        }
    }
    EXPECT_GT(seen, 5000u);
    EXPECT_GT(missed, 5000u);
    if (meets_shapes<Config>) {
        EXPECT_GT(hidden, 5000u);
        EXPECT_GT(open, 100u);
    }
}

constexpr FeatureSet plain = shape_features;

TEST(AnyHitTest, SeesWhatTheClosestHitSees) { expect_same_as_closest<Config<float, plain>>(); }
TEST(AnyHitTest, InDouble) { expect_same_as_closest<Config<double, plain>>(); }
TEST(AnyHitTest, InMotion) { expect_same_as_closest<Config<float, plain | Feature::motion>>(true); }
TEST(AnyHitTest, NearSpheres) { expect_same_as_closest<Config<float, plain | Feature::near_sphere>>(false, true); }
TEST(AnyHitTest, ByTextbookForms) { expect_same_as_closest<Config<float, plain | Feature::naive>>(); }
TEST(AnyHitTest, ByMatrices) { expect_same_as_closest<Config<float, plain | Feature::matrix>>(); }
TEST(AnyHitTest, InDoubleWithinSingle) {
    expect_same_as_closest<Config<float, plain | Feature::double_intersection>>();
}

}  // namespace
}  // namespace pt
