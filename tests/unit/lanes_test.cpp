// The closest hits of a packet: what closest_hit says of each ray alone, to the last bit.
#include "variants/cpu/lanes_intersect.h"

#include <gtest/gtest.h>

#include "harness/places.h"
#include "harness/scene/scene_buffers.h"
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
    for (int round = 0; round < 2000 && !testing::Test::HasFailure(); ++round) {
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            next_ray<Kernel>(paths, l, hits, view, random);
        }
        lanes::closest_hit<Kernel>(hits, view, paths);
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            const Hit<float> alone = closest_hit<Kernel>(view, paths.ray(l));
            EXPECT_EQ(hits.side[l], alone.side.code);
            EXPECT_EQ(bits_of(hits.t[l]), bits_of(alone.t));
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
    EXPECT_GT(expect_the_hits_of_single_rays<general>(PTBENCH_SOURCE_DIR "/scenes/stability/ground_view.json"), many);
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
