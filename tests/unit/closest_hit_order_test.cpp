// The closest hit is the least (t, object), in whatever order objects are visited: what acceleration structures rest
// on.
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "harness/scene/scene_buffers.h"
#include "kernels/intersect.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using Everything = Config<float, all_features>;

// Twins in one place, faces that lie in each other, and shapes of every kind.
test::SceneBuilder with_ties() {
    test::SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    for (const double x : {-2.0, 0.0, 2.0}) {
        builder.sphere(white, {x, 0, 5}, 1.0);
        builder.sphere(white, {x, 0, 5}, 1.0);
        builder.box(white, {x, 2, 5}, Vec3d(1.0));
        builder.box(white, {x, 2, 5}, Vec3d(1.0));
        builder.box(white, {x + 1, 2, 5}, Vec3d(1.0));
        builder.box(white, {x, -2, 5}, Vec3d(1.0), {0, 30, 0});
        builder.box(white, {x, -2, 5}, Vec3d(1.0), {0, 30, 0});
        builder.quad(white, {x, -3, 5}, 4, 4);
        builder.quad(white, {x + 0.5, -3, 5}, 4, 4);
    }
    return builder;
}

TEST(ClosestHitOrderTest, AnyOrderLeavesTheSameBits) {
    const Scene scene = with_ties().scene;
    const SceneBuffers<float> buffers(scene, default_settings(scene));
    const SceneView<float>& view = buffers.view();
    std::vector<std::uint32_t> objects(object_count(view));
    std::iota(objects.begin(), objects.end(), 0u);
    std::mt19937 random(17);
    std::uniform_real_distribution<float> coordinate(-3, 3);
    int ties = 0;
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        // From random points, from surfaces that were met, and along the axes, where faces that lie in each other tie.
        Vec3<float> direction{coordinate(random), coordinate(random), coordinate(random)};
        if (i % 3 == 0) {
            direction = {0, i % 2 == 0 ? 1.0f : -1.0f, 0};
        }
        Ray<float> ray{{coordinate(random), coordinate(random), 5 + coordinate(random)}, normalize(direction), 0, {}};
        for (int bounce = 0; bounce < 2; ++bounce) {
            const Hit<float> expected = closest_hit<Everything>(view, ray);
            std::shuffle(objects.begin(), objects.end(), random);
            Hit<float> found;
            found.t = std::numeric_limits<float>::infinity();
            for (const std::uint32_t object : objects) {
                meet_object<Everything, VisitOrder::any>(found, view, object, ray);
            }
            ASSERT_EQ(found.t, expected.t) << i;
            ASSERT_EQ(found.side.exists(), expected.side.exists()) << i;
            if (!expected.side.exists()) {
                break;
            }
            ASSERT_EQ(found.side.object(), expected.side.object()) << i;
            ASSERT_EQ(found.side.inside(), expected.side.inside()) << i;
            hits += 1;
            Hit<float> other;
            other.t = std::numeric_limits<float>::infinity();
            for (const std::uint32_t object : objects) {
                if (object != expected.side.object()) {
                    meet_object<Everything, VisitOrder::any>(other, view, object, ray);
                }
            }
            ties += other.t == expected.t ? 1 : 0;
            const SurfacePoint<float> point = surface_at<Everything>(view, ray, expected);
            ray = {point.position, normalize(direction), 0, SurfaceId::of(expected.side.object(), i % 2 == 0)};
        }
    }
    EXPECT_GT(hits, 5000);
    EXPECT_GT(ties, 1000);  // or the test would say nothing of them
}

}  // namespace
}  // namespace pt
