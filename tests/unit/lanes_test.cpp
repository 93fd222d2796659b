// The closest hits of a packet and its directions to lights: what closest_hit and SeenBox say of each lane alone, to
// the last bit.
#include "variants/cpu/lanes_connect.h"

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "tests/support/places.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::Random;

constexpr FeatureSet boxes_and_balls =
    Feature::sphere | Feature::axis_box | Feature::diffuse | Feature::emitter | Feature::mirror | Feature::jitter;

Vec3<float> random_vector(Random& random, double reach) {
    return {static_cast<float>(random.uniform(-reach, reach)), static_cast<float>(random.uniform(-reach, reach)),
            static_cast<float>(random.uniform(-reach, reach))};
}

// Anywhere, or from where the lane's last ray ended; every now and then along an axis or in a plane of two.
template <class Config>
void next_ray(lanes::Paths<float>& paths, std::uint32_t l, const lanes::Hits<float>& hits,
              const SceneView<float>& scene, Random& random) {
    const Hit<float> hit = hits[l];
    paths.origin_surface[l] = SurfaceId::nowhere;
    if (hit.side.exists() && random.uniform() < 0.8) {
        const SurfacePoint<float> point = surface_at<Config>(scene, paths.ray(l), hit);
        paths.origin.set(l, point.position);
        paths.origin_surface[l] = SurfaceId::of(hit.side.object(), random.uniform() < 0.3).code;
    } else {
        paths.origin.set(l, random_vector(random, 15));
    }
    Vec3<float> direction = random_vector(random, 1);
    direction.x = random.uniform() < 0.05 ? 0.0f : direction.x;
    direction.y = random.uniform() < 0.05 ? -0.0f : direction.y;
    paths.direction.set(l, normalize(direction));
    paths.time[l] = 0;
}

template <FeatureSet features>
std::uint64_t expect_the_hits_of_single_rays(const std::string& name) {
    using Kernel = Config<float, features>;
    const Scene scene = find_scene(name);
    const SceneBuffers<float> buffers(scene, default_settings(scene));
    const SceneView<float> view = buffers.view();
    Random random(1);
    lanes::Paths<float> paths;
    lanes::Hits<float> hits;
    for (std::uint32_t l = 0; l < lanes::width; ++l) {
        hits.set(l, Hit<float>{});
    }
    std::uint64_t met = 0;
    lanes::Flags asks;
    for (int round = 0; round < 2000 && !testing::Test::HasFailure(); ++round) {
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            next_ray<Kernel>(paths, l, hits, view, random);
            asks[l] = random.uniform() < 0.9 ? 1u : 0u;
        }
        lanes::closest_hit<Kernel>(hits, view, paths, asks);
        for (const std::uint32_t l : lanes::LaneList(asks)) {
            const Hit<float> alone = closest_hit<Kernel>(view, paths.ray(l));
            EXPECT_EQ(hits.side[l], alone.side.code);
            EXPECT_EQ(bits_of(hits.t[l]), bits_of(alone.t));
            EXPECT_EQ(hits.primitive[l], alone.primitive);
            met += alone.side.exists() ? 1 : 0;
        }
    }
    return met;
}

TEST(LanesTest, MeetWhatARayAloneMeets) {
    constexpr std::uint64_t many = 10000;
    constexpr FeatureSet general = all_features;
    for (const char* const name : {"cornell_open", "cornell_open_45", "cornell_closed"}) {
        SCOPED_TRACE(name);
        EXPECT_GT(expect_the_hits_of_single_rays<(boxes_and_balls | Feature::enclosure)>(name), many);
        EXPECT_GT(expect_the_hits_of_single_rays<boxes_and_balls>(name), many);
    }
    for (const char* const name : {"cornell_closed_five", "cornell_open_five", "subsurface_box_on", "motion_on"}) {
        SCOPED_TRACE(name);
        EXPECT_GT(expect_the_hits_of_single_rays<(general | Feature::enclosure)>(name), many);
        EXPECT_GT(expect_the_hits_of_single_rays<general>(name), many);
    }
    EXPECT_GT(expect_the_hits_of_single_rays<(general | Feature::matrix)>("cornell_open"), many);
    EXPECT_GT(expect_the_hits_of_single_rays<general>(test::in_source("scenes/stability/ground_view.json")), many);
}

TEST(LanesTest, HaveTheSinesAndArcTangentsOfSingleNumbers) {
    Random random(2);
    for (int i = 0; i < 200000; ++i) {
        const float angle = i == 0 ? 6.2831855f : static_cast<float>(random.uniform(-6.2831855, 6.2831855));
        EXPECT_EQ(bits_of(lanes::sin_cos(angle).sine), bits_of(sin_cos(angle).sine)) << angle;
        EXPECT_EQ(bits_of(lanes::sin_cos(angle).cosine), bits_of(sin_cos(angle).cosine)) << angle;
        const float x =
            static_cast<float>(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.uniform(-30, 30))));
        EXPECT_EQ(bits_of(lanes::arc_tangent(x)), bits_of(arc_tangent(x))) << x;
    }
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float x : {0.0f, -0.0f, 1.0f, infinity, -infinity}) {
        EXPECT_EQ(bits_of(lanes::arc_tangent(x)), bits_of(arc_tangent(x))) << x;
    }
}

// Boxes of all proportions from near, from far, from the planes of their faces and from within.
TEST(LanesTest, SampleBoxesAsOneObserverDoes) {
    Random random(3);
    lanes::BoxObservers<float> observers{};
    lanes::LightDirections<float> drawn{};
    lanes::Vectors<float> positions;
    lanes::Flags draws;
    int near = 0, far = 0, others = 0;
    for (int round = 0; round < 4000 && !HasFailure(); ++round) {
        SceneView<float> view{};
        const std::uint32_t count = round % 4 == 0 ? 1 : 5;
        AxisBox<float> boxes[5];
        Light lights[5];
        std::uint32_t material_of[5] = {};
        const Material<float> material{};
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec3<float> centre = random_vector(random, 3);
            Vec3<float> half;
            for (int axis = 0; axis < 3; ++axis) {
                half[axis] = static_cast<float>(std::ldexp(1.0, -static_cast<int>(random.uniform(0, 12))));
            }
            boxes[i] = {centre - half, centre + half};
            lights[i] = {i};
        }
        view.axis_boxes = {boxes, count};
        view.lights = {lights, count};
        view.materials = {&material, 1};
        view.object_material = {material_of, count};
        const lanes::LightTable<float> table(view);
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            drawn.light[l] = std::min(count - 1, static_cast<std::uint32_t>(random.uniform() * count));
            drawn.u[l] = static_cast<float>(random.uniform());
            drawn.v[l] = static_cast<float>(random.uniform());
            drawn.w[l] = random.uniform() < 0.05 ? 0x1.fffffep-1f : static_cast<float>(random.uniform());
            const AxisBox<float>& box = boxes[drawn.light[l]];
            Vec3<float> position = (box.low + box.high) * 0.5f + random_vector(random, random.uniform() < 0.5 ? 2 : 12);
            position.x = random.uniform() < 0.1 ? box.high.x : position.x;
            position.y = random.uniform() < 0.1 ? box.low.y : position.y;
            positions.set(l, random.uniform() < 0.05 ? (box.low + box.high) * 0.5f : position);
            draws[l] = random.uniform() < 0.8 ? 1u : 0u;
        }
        lanes::look_at_lights(drawn, table, positions, draws);
        lanes::sample_boxes(observers, drawn, table);
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            EXPECT_EQ(drawn.is_near[l] + drawn.is_far[l] + drawn.is_other[l], draws[l]);
            near += static_cast<int>(drawn.is_near[l]);
            far += static_cast<int>(drawn.is_far[l]);
            others += static_cast<int>(drawn.is_other[l]);
            if (draws[l] - drawn.is_other[l] != 1) {
                continue;
            }
            const DirectionSample<float> alone =
                sample_direction(boxes[drawn.light[l]], positions[l], drawn.u[l], drawn.v[l], drawn.w[l]);
            ASSERT_EQ(bits_of(drawn.inverse_pdf[l]), bits_of(alone.inverse_pdf));
            if (alone.inverse_pdf > 0) {
                for (int axis = 0; axis < 3; ++axis) {
                    ASSERT_EQ(bits_of(drawn.direction[l][axis]), bits_of(alone.direction[axis]));
                }
            }
        }
    }
    EXPECT_GT(near, 10000);
    EXPECT_GT(far, 10000);
    EXPECT_GT(others, 1000);
}

TEST(LanesTest, AListNamesTheLanesThatAreSet) {
    lanes::Flags flags{};
    EXPECT_FALSE(lanes::any(flags));
    EXPECT_EQ(lanes::LaneList(flags).size(), 0u);
    flags[3] = flags[lanes::width - 1] = 1;
    EXPECT_TRUE(lanes::any(flags));
    const lanes::LaneList list(flags);
    EXPECT_EQ(std::vector<std::uint32_t>(list.begin(), list.end()), (std::vector<std::uint32_t>{3, lanes::width - 1}));
}

}  // namespace
}  // namespace pt
