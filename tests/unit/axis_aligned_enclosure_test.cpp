// The enclosure shortcut: what makes an enclosure, and that a kernel which takes the shortcut meets, to the last bit,
// what the slab tests meet.
#include "kernels/axis_aligned_enclosure.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "harness/scene/find_enclosure.h"
#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/shade.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::Random;
using test::SceneBuilder;

template <class Real>
class AxisAlignedEnclosureTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(AxisAlignedEnclosureTest, Reals);

template <class Real>
using Plain = Config<Real, all_features>;
template <class Real>
using Shortcut = Config<Real, all_features | shortcuts>;

template <class Real>
bool same_bits(const Vec3<Real>& a, const Vec3<Real>& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

template <class Real>
Vec3<Real> random_unit(Random& random) {
    return uniform_sphere(static_cast<Real>(random.uniform(0, 1)), static_cast<Real>(random.uniform(0, 1)));
}

struct Tally {
    std::uint64_t rays = 0, shortcuts = 0, hits = 0;
};

// Both kernels' answers for one ray.
template <class Real>
Hit<Real> expect_same(const SceneView<Real>& scene, const Ray<Real>& ray, Tally& tally) {
    const Hit<Real> plain = closest_hit<Plain<Real>>(scene, ray);
    const Hit<Real> quick = closest_hit<Shortcut<Real>>(scene, ray);
    tally.rays += 1;
    tally.shortcuts += quick.side.exists() && quick.side.has_face() ? 1 : 0;
    tally.hits += plain.side.exists() ? 1 : 0;
    EXPECT_EQ(plain.side.exists(), quick.side.exists());
    if (plain.side.exists() && quick.side.exists()) {
        EXPECT_EQ(plain.side.object(), quick.side.object());
        EXPECT_EQ(plain.side.inside(), quick.side.inside());
        EXPECT_EQ(std::memcmp(&plain.t, &quick.t, sizeof plain.t), 0) << plain.t << " " << quick.t;
        const SurfacePoint<Real> a = surface_at<Plain<Real>>(scene, ray, plain);
        const SurfacePoint<Real> b = surface_at<Shortcut<Real>>(scene, ray, quick);
        EXPECT_TRUE(same_bits(a.position, b.position));
        EXPECT_TRUE(same_bits(a.normal, b.normal));
    }
    return quick;
}

// A walk of random directions from surface to surface, with every now and then a direction along a plane or an axis, or
// a start from anywhere.
template <class Real>
Tally walk(const SceneView<Real>& scene, std::uint64_t seed, int rays) {
    Random random(seed);
    Tally tally;
    Ray<Real> ray{};
    ray.origin_surface = SurfaceId{};
    bool fresh = true;
    for (int i = 0; i < rays && !testing::Test::HasFailure(); ++i) {
        if (fresh) {
            const double reach = i % 5 == 0 ? 20 : 6;
            ray.origin = {static_cast<Real>(random.uniform(-reach, reach)),
                          static_cast<Real>(random.uniform(-reach, reach)),
                          static_cast<Real>(random.uniform(-reach - 10, reach))};
            ray.origin = i % 7 == 0 ? Vec3<Real>(Real(0)) : ray.origin;
            ray.origin_surface = SurfaceId{};
        }
        ray.direction = random_unit<Real>(random);
        const int zeroed = static_cast<int>(random.uniform(0, 40));
        if (zeroed < 3) {
            ray.direction[zeroed] = zeroed % 2 == 0 ? Real(0) : -Real(0);
            ray.direction = normalize(ray.direction);
        } else if (zeroed < 6) {
            ray.direction = {Real(0), Real(0), Real(0)};
            ray.direction[zeroed - 3] = random.uniform(-1, 1) < 0 ? Real(-1) : Real(1);
        } else if (zeroed < 9) {
            ray.direction[zeroed - 6] *= Real(1e-7);
            ray.direction = normalize(ray.direction);
        }
        const Hit<Real> hit = expect_same(scene, ray, tally);
        // A path ends at a lamp: none leaves it.
        const bool at_lamp = hit.side.exists() && scene.surfaces[hit.side.object()].type == MaterialType::emitter;
        fresh = !hit.side.exists() || at_lamp || random.uniform(0, 1) < 0.05;
        if (hit.side.exists() && !at_lamp) {
            const SurfacePoint<Real> point = surface_at<Shortcut<Real>>(scene, ray, hit);
            ray.origin = point.position;
            const bool through = random.uniform(0, 1) < 0.1;  // as a refracting body lets it
            ray.origin_surface = SurfaceId::of(hit.side.object(), hit.side.inside() != through);
        }
    }
    return tally;
}

template <class Real>
void expect_same_walks(const Scene& scene, int rays, double least_shortcuts) {
    const SceneBuffers<Real> buffers(scene, default_settings(scene));
    const Tally tally = walk(buffers.view(), 7, rays);
    EXPECT_EQ(tally.rays, static_cast<std::uint64_t>(rays));
    EXPECT_GE(static_cast<double>(tally.shortcuts), least_shortcuts * static_cast<double>(tally.hits));
}

TYPED_TEST(AxisAlignedEnclosureTest, MeetsWhatTheSlabTestsMeet) {
    expect_same_walks<TypeParam>(find_scene("cornell_open"), 1000000, 0.25);
    expect_same_walks<TypeParam>(find_scene("cornell_closed"), 1000000, 0.25);
    expect_same_walks<TypeParam>(find_scene("cornell_open_five"), 400000, 0.15);
}

TYPED_TEST(AxisAlignedEnclosureTest, IsTheSpaceBetweenTheWalls) {
    const Scene scene = find_scene("cornell_open");
    const SceneBuffers<TypeParam> buffers(scene, default_settings(scene));
    const AxisAlignedEnclosure<TypeParam>& enclosure = buffers.view().enclosure;
    const auto narrow = [](double x, double y, double z) {
        return Vec3<TypeParam>(static_cast<TypeParam>(x), static_cast<TypeParam>(y), static_cast<TypeParam>(z));
    };
    // From the eye (0, 5, 10.5); walls are 0.01 thick.
    const Vec3<TypeParam> low = narrow(-5 + 0.005, 0.005 - 5, -5 + 0.005 - 10.5);
    const Vec3<TypeParam> high = narrow(5 - 0.005, 10 - 0.005 - 5, 5 - 10.5);
    for (int axis = 0; axis < 3; ++axis) {  // sums of these sizes in double, in another order
        EXPECT_NEAR(enclosure.low[axis], low[axis], 1e-14) << axis;
        EXPECT_NEAR(enclosure.high[axis], high[axis], 1e-14) << axis;
    }
    EXPECT_EQ(enclosure.open_sides, 1u << 5);
    EXPECT_EQ(__builtin_popcount(enclosure.walls), 5);
    EXPECT_FALSE(enclosure.high_side[2].exists());
    const auto material_of = [&](const SurfaceId& side) {
        return scene.materials[buffers.view().object_material[side.object()]].name;
    };
    EXPECT_EQ(material_of(enclosure.low_side[0]), "red");
    EXPECT_EQ(material_of(enclosure.high_side[0]), "green");
    EXPECT_EQ(material_of(enclosure.low_side[1]), "white");
}

TYPED_TEST(AxisAlignedEnclosureTest, IsClosedWhereTheBoxIs) {
    const Scene scene = find_scene("cornell_closed");
    const SceneBuffers<TypeParam> buffers(scene, default_settings(scene));
    EXPECT_EQ(buffers.view().enclosure.open_sides, 0u);
    EXPECT_EQ(__builtin_popcount(buffers.view().enclosure.walls), 6);
}

Scene three_walls(double reach, const Vec3d& velocity) {
    SceneBuilder builder;
    const auto grey = builder.diffuse(Vec3d(0.5));
    builder.box(grey, {0, -1, 0}, {2, 0.1, reach});
    builder.box(grey, {-1, 0, 0}, {0.1, 2.2, 2});
    builder.box(grey, {0, 0, -1}, {2, 2.2, 0.1});
    builder.scene.objects.back().velocity = velocity;
    return builder.scene;
}

TYPED_TEST(AxisAlignedEnclosureTest, NeedsThreeWallsAtRestThatReachOverItsSides) {
    const auto walls_of = [](const Scene& scene) {
        const SceneBuffers<TypeParam> buffers(scene, default_settings(scene));
        return __builtin_popcount(buffers.view().enclosure.walls);
    };
    EXPECT_EQ(walls_of(find_scene("ball_glass")) > 0, shortcuts_of(find_scene("ball_glass")) != no_features);
    EXPECT_EQ(walls_of(three_walls(2, Vec3d(0.0))), 3);
    EXPECT_EQ(walls_of(three_walls(1.5, Vec3d(0.0))), 0);      // the floor ends before the left wall does
    EXPECT_EQ(walls_of(three_walls(2, Vec3d(0, 0, 0.1))), 0);  // the back wall moves
    expect_same_walks<TypeParam>(three_walls(2, Vec3d(0.0)), 100000, 0);
}

// The frame of an axis is a change of places: the same bits as the frame's products and sums, zeros' signs included.
TYPED_TEST(AxisAlignedEnclosureTest, DirectionsFromAFaceAreThoseOfItsFrame) {
    using Real = TypeParam;
    Random random(3);
    std::uint64_t taken = 0;
    for (int i = 0; i < 200000; ++i) {
        const SurfaceId face = SurfaceId::of_face(5, static_cast<std::uint32_t>(i) % 3, random.uniform(0, 1) < 0.5);
        const Real sign = face.face_looks_up() ? Real(1) : Real(-1);
        Vec3<Real> normal(Real(0));
        normal[static_cast<int>(face.face_axis())] = sign;
        Vec3<Real> local =
            cosine_hemisphere(static_cast<Real>(random.uniform(0, 1)), static_cast<Real>(random.uniform(0, 1)));
        if (i % 10 == 0) {
            local[i / 10 % 3] = Real(0);
        }
        Vec3<Real> world;
        if (axis_to_world(face, local, world)) {
            taken += 1;
            ASSERT_TRUE(same_bits(world, Frame<Real>(normal).to_world(local))) << i;
        } else {
            ASSERT_EQ(local.x * local.y * local.z, Real(0));
        }
    }
    EXPECT_GT(taken, 170000u);
}

}  // namespace
}  // namespace pt
