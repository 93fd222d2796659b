// Shadow rays to drawn points of lights against the closest hit: what is clear or blocked is so by the closest hit too,
// the rest is the closest hit's, and a kernel that knows the enclosure says the same as one that does not.
#include "kernels/line_of_sight.h"

#include <cmath>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/next_event.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::Random;
using test::SceneBuilder;

template <class Real>
using Plain = Config<Real, all_features>;
template <class Real>
using Shortcut = Config<Real, all_features | shortcuts>;

template <class Real>
class LineOfSightTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(LineOfSightTest, Reals);

struct Tally {
    std::uint64_t clear = 0, blocked = 0, unsure = 0, without_walls = 0;
};

// A ray from somewhere, or from where one has met a surface that does not emit; `normal`: of the side that it leaves.
template <class Real>
struct Start {
    Ray<Real> ray;
    Vec3<Real> normal{Real(0)};
};
template <class Real>
Start<Real> random_start(Random& random, const SceneView<Real>& scene, Real reach) {
    const auto somewhere = [&] {
        return Vec3<Real>(static_cast<Real>(random.uniform(-1, 1)) * reach,
                          static_cast<Real>(random.uniform(-1, 1)) * reach,
                          static_cast<Real>(random.uniform(-1, 1)) * reach);
    };
    const Vec3<Real> direction =
        uniform_sphere(static_cast<Real>(random.uniform(0, 1)), static_cast<Real>(random.uniform(0, 1)));
    Start<Real> start{{somewhere(), direction, static_cast<Real>(random.uniform(0, 1)), {}}};
    const Hit<Real> hit = closest_hit<Plain<Real>>(scene, start.ray);
    if (hit.side.exists() && scene.surfaces[hit.side.object()].type != MaterialType::emitter) {
        const SurfacePoint<Real> point = surface_at<Plain<Real>>(scene, start.ray, hit);
        start.ray.origin = point.position;
        start.ray.origin_surface = SurfaceId::of(hit.side.object(), hit.side.inside());
        start.normal = hit.side.inside() ? -point.normal : point.normal;
    }
    return start;
}

template <class Real>
void expect_same_as_closest(const SceneView<Real>& scene, std::uint32_t light, const Ray<Real>& ray, Real distance,
                            Tally& tally) {
    const Hit<Real> closest = closest_hit<Plain<Real>>(scene, ray);
    const bool is_met = closest.side.exists() && closest.side.object() == light;
    const Sight sight = line_of_sight<Plain<Real>>(scene, light, ray, distance);
    if (sight == Sight::clear) {
        // A ray that was drawn to an edge may pass it by, and meet what lies beyond.
        ASSERT_TRUE(is_met || !closest.side.exists() || closest.t > distance);
    } else if (sight == Sight::blocked) {
        ASSERT_FALSE(is_met);
        ASSERT_TRUE(closest.side.exists() && closest.t < distance);
    }
    (sight == Sight::clear ? tally.clear : sight == Sight::blocked ? tally.blocked : tally.unsure) += 1;
    const bool is_within =
        walls_between(scene.enclosure, ray.origin, ray.origin + ray.direction * distance) != WallsBetween::unknown;
    tally.without_walls += is_within ? 1 : 0;
    const Hit<Real> plain = hit_of_light<Plain<Real>>(scene, light, ray, distance);
    const Hit<Real> quick = hit_of_light<Shortcut<Real>>(scene, light, ray, distance);
    ASSERT_EQ(plain.side.exists(), quick.side.exists());
    if (plain.side.exists()) {
        ASSERT_EQ(plain.t, distance);
        ASSERT_EQ(quick.t, distance);
    }
    if (sight == Sight::unsure) {
        ASSERT_EQ(plain.side.exists(), sees_point<Plain<Real>>(scene, light, ray, distance, closest));
        ASSERT_TRUE(plain.side.exists() || !is_met);
    }
}

// A ray that starts on a wall from then on starts where that meets another side of the room, in the very plane of both.
template <class Real>
void move_into_corner(Ray<Real>& ray, const SceneView<Real>& scene, int axis, bool low) {
    const auto& room = scene.enclosure;
    const std::uint32_t box = ray.origin_surface.object() - first_of<ShapeKind::axis_box>(scene);
    const bool is_on_wall = room.walls != 0 && ray.origin_surface.exists() && !ray.origin_surface.inside() &&
                            box < scene.axis_boxes.size && room.is_wall(box);
    const bool is_own_axis = ray.origin[axis] == room.low[axis] || ray.origin[axis] == room.high[axis];
    if (is_on_wall && room.contains(ray.origin) && !is_own_axis) {
        ray.origin[axis] = low ? room.low[axis] : room.high[axis];
    }
}

template <class Real>
Tally look_at_lights(const Scene& scene, Real reach, int rays, std::uint64_t seed) {
    RenderSettings settings = default_settings(scene);
    settings.next_event = true;
    settings.light_sampling = LightSampling::projected;
    const SceneBuffers<Real> buffers(scene, settings);
    const SceneView<Real>& view = buffers.view();
    Random random(seed);
    Tally tally;
    for (int i = 0; i < rays && !testing::Test::HasFatalFailure(); ++i) {
        auto [ray, normal] = random_start(random, view, reach);
        if (random.uniform(0, 1) < 0.25) {
            move_into_corner(ray, view, static_cast<int>(random.uniform(0, 3)), random.uniform(0, 1) < 0.5);
        }
        const std::uint32_t light =
            view.lights[static_cast<std::uint32_t>(random.uniform(0, static_cast<double>(view.lights.size)))].object;
        const DirectionSample<Real> sample = sample_direction_to<Plain<Real>>(
            view, light, ray.origin, ray.time, static_cast<Real>(random.uniform(0, 1)),
            static_cast<Real>(random.uniform(0, 1)), static_cast<Real>(random.uniform(0, 1)));
        // A connection leaves its surface, as next_event.h sees to.
        const bool leaves = !ray.origin_surface.exists() || dot(sample.direction, normal) > Real(0);
        // In a face's own plane, but for rounding, it may be met anywhere.
        const bool is_told = sample.inverse_pdf > gamma<Real>(1000) && sample.distance > Real(0);
        if (leaves && is_told) {
            ray.direction = sample.direction;
            expect_same_as_closest(view, light, ray, sample.distance, tally);
        }
    }
    return tally;
}

TYPED_TEST(LineOfSightTest, IsThatOfTheClosestHitInRooms) {
    for (const char* name : {"cornell_open", "cornell_closed", "cornell_open_five"}) {
        const Tally tally = look_at_lights<TypeParam>(find_scene(name), TypeParam(9), 200000, 3);
        EXPECT_GT(tally.clear, 10000u) << name;
        EXPECT_GT(tally.blocked, 10000u) << name;
        EXPECT_LT(tally.unsure, 2000u) << name;
        EXPECT_GT(tally.without_walls, 10000u) << name;
    }
}

// Boxes of all sorts in and out of one room, some through its walls, some that share a plane with a wall or with each
// other: distances that only the order of objects tells apart.
Scene random_room(Random& random, bool moves) {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    const std::uint32_t lamp = builder.emitter({4, 5, 6});
    const auto size = [&] { return random.uniform(0.2, 1.2); };
    const auto place = [&] { return random.uniform(-2.6, 2.6); };
    const auto walls = [&] {
        builder.box(white, {0, -2.05, 0}, {4.4, 0.1, 4.4});
        builder.box(white, {0, 2.05, 0}, {4.4, 0.1, 4.4});
        builder.box(white, {-2.05, 0, 0}, {0.1, 4.4, 4.4});
        builder.box(white, {2.05, 0, 0}, {0.1, 4.4, 4.4});
        builder.box(white, {0, 0, 2.05}, {4.4, 4.4, 0.1});
    };
    const bool walls_first = random.uniform() < 0.5;
    if (walls_first) {
        walls();
    }
    for (int i = 0; i < 4; ++i) {
        const std::uint32_t material = i < 3 ? lamp : white;
        const Vec3d extent{size(), size(), size()};
        Vec3d centre{place(), place(), place()};
        if (random.uniform() < 0.5) {
            centre.y =
                2 + (random.uniform() < 0.5 ? -0.5 : 0.5) * extent.y;  // hangs from the ceiling, or flush with it
        }
        const Vec3d turn = random.uniform() < 0.3 ? Vec3d(random.uniform(0, 90), 20, 30) : Vec3d(0.0);
        for (int copy = 0; copy < (random.uniform() < 0.2 ? 2 : 1); ++copy) {
            builder.box(material, centre, extent, turn);
        }
        if (moves) {
            builder.scene.objects.back().velocity = {place(), 0, place()};
        }
    }
    builder.quad(lamp, {place(), random.uniform() < 0.5 ? 2.0 : place(), place()}, size(), size());
    for (const std::uint32_t material : {white, lamp}) {
        builder.sphere(material, {place(), place(), place()}, size());
        builder.ellipsoid(material, {place(), place(), place()}, {size(), size(), size()}, {10, 20, 30});
    }
    if (!walls_first) {
        walls();
    }
    builder.scene.camera.shutter_close = moves ? 1 : 0;
    return builder.scene;
}

TYPED_TEST(LineOfSightTest, IsThatOfTheClosestHitWhereLightsTouch) {
    Random random(17);
    Tally sum;
    for (int i = 0; i < 60 && !testing::Test::HasFatalFailure(); ++i) {
        const Tally tally = look_at_lights<TypeParam>(random_room(random, i % 5 == 0), TypeParam(3), 6000, 100 + i);
        sum.clear += tally.clear;
        sum.blocked += tally.blocked;
        sum.unsure += tally.unsure;
        sum.without_walls += tally.without_walls;
    }
    EXPECT_GT(sum.clear, 10000u);
    EXPECT_GT(sum.blocked, 10000u);
    EXPECT_GT(sum.unsure, 300u);
    EXPECT_GT(sum.without_walls, 1000u);
}

// A box and a quad that emit, let into the ceiling of a room: all distances to their undersides are the ceiling's but
// for rounding, and the order of the objects decides which of them is seen. From near and far below, along the ceiling
// too.
TYPED_TEST(LineOfSightTest, IsThatOfTheClosestHitUnderALightLetIntoACeiling) {
    using Real = TypeParam;
    for (const bool is_lamp_first : {false, true}) {
        SceneBuilder builder;
        const std::uint32_t white = builder.diffuse(Vec3d(0.5)), lamp = builder.emitter({4, 5, 6});
        const auto lamps = [&] {
            builder.box(lamp, {0.3, 1.35, -0.2}, {2, 0.1, 2});
            builder.quad(lamp, {-2.5, 1.3, 0.1}, 1.5, 1);
        };
        if (is_lamp_first) {
            lamps();
        }
        builder.box(white, {0, 1.35, 0}, {8.4, 0.1, 8.4});
        builder.box(white, {0, -2.05, 0}, {8.4, 0.1, 8.4});
        builder.box(white, {-4.05, 0, 0}, {0.1, 8.4, 8.4});
        builder.box(white, {4.05, 0, 0}, {0.1, 8.4, 8.4});
        builder.box(white, {0, 0, 4.05}, {8.4, 8.4, 0.1});
        if (!is_lamp_first) {
            lamps();
        }
        RenderSettings settings = default_settings(builder.scene);
        settings.next_event = true;
        settings.light_sampling = LightSampling::projected;
        const SceneBuffers<Real> buffers(builder.scene, settings);
        const SceneView<Real>& view = buffers.view();
        ASSERT_NE(view.enclosure.walls, 0u);
        Random random(23);
        const auto unit = [&] { return static_cast<Real>(random.uniform(0, 1)); };
        Tally tally;
        for (const double gap : {1.0, 0.1, 0.03, 0.01, 0.003}) {
            for (int i = 0; i < 20000 && !testing::Test::HasFatalFailure(); ++i) {
                const Vec3<Real> from(Vec3d(random.uniform(-3.9, 3.9), 1.3 - gap, random.uniform(-3.9, 3.9)));
                const std::uint32_t light = view.lights[i % 2].object;
                const DirectionSample<Real> sample =
                    sample_direction_to<Plain<Real>>(view, light, from, Real(0), unit(), unit(), unit());
                if (sample.inverse_pdf > gamma<Real>(1000) && sample.distance > Real(0)) {
                    expect_same_as_closest<Real>(view, light, {from, sample.direction, Real(0), {}}, sample.distance,
                                                 tally);
                }
            }
        }
        EXPECT_GT(tally.unsure, 50000u);
    }
}

// A shadow ray enters a body where a path that meets it does, bit for bit: only what is met before can hide it.
TYPED_TEST(LineOfSightTest, BodiesTellWhereARayEntersThem) {
    using Real = TypeParam;
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        SceneBuilder builder;
        const std::uint32_t lamp = builder.emitter({1, 1, 1});
        const Vec3d centre{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const double size = std::exp2(random.uniform(-8, 2));
        if (i % 2 == 0) {
            builder.sphere(lamp, centre, size);
        } else {
            builder.ellipsoid(lamp, centre, {size, 0.3 * size, 2 * size}, {10, 20, 30});
        }
        RenderSettings settings = default_settings(builder.scene);
        settings.next_event = true;
        settings.light_sampling = LightSampling::projected;
        const SceneBuffers<Real> buffers(builder.scene, settings);
        const SceneView<Real>& view = buffers.view();
        const auto unit = [&] { return static_cast<Real>(random.uniform(0, 1)); };
        const Vec3<Real> from{unit() * 6 - 3, unit() * 6 - 3, unit() * 6 - 3};
        const DirectionSample<Real> sample =
            sample_direction_to<Plain<Real>>(view, 0, from, Real(0), unit(), unit(), unit());
        const Hit<Real> hit = closest_hit<Plain<Real>>(view, {from, sample.direction, Real(0), {}});
        if (!hit.side.exists() || hit.side.inside()) {
            EXPECT_EQ(sample.distance, Real(0)) << i;  // from within, or past the edge by rounding: as ever
        } else {
            EXPECT_EQ(sample.distance, hit.t) << i;
            EXPECT_GT(hit.t, Real(0)) << i;
        }
    }
}

// Kernels that know several kinds of boxes and quads draw their points by one body of code: as each kind's own has it.
TYPED_TEST(LineOfSightTest, KindsOfBoxesAreDrawnTogetherAsTheyAreAlone) {
    using Real = TypeParam;
    Random random(6);
    for (const LightSampling sampling : {LightSampling::area, LightSampling::projected, LightSampling::automatic}) {
        SceneBuilder builder;
        const std::uint32_t lamp = builder.emitter({1, 1, 1});
        builder.box(lamp, {0, 1, 0}, {1, 0.2, 0.7});
        builder.box(lamp, {2, 0, 0}, {0.5, 1, 0.3}, {20, 30, 40});
        builder.quad(lamp, {-2, 0, 0}, 1.5, 0.5);
        RenderSettings settings = default_settings(builder.scene);
        settings.next_event = true;
        settings.light_sampling = sampling;
        const SceneBuffers<Real> buffers(builder.scene, settings);
        const SceneView<Real>& view = buffers.view();
        const auto unit = [&] { return static_cast<Real>(random.uniform(0, 1)); };
        for (int i = 0; i < 3000; ++i) {
            const Vec3<Real> from{unit() * 6 - 3, unit() * 6 - 3, unit() * 6 - 3};
            const Real u = unit(), v = unit(), w = unit();
            const std::uint32_t object = static_cast<std::uint32_t>(i) % 3;
            const DirectionSample<Real> sample = sample_direction_to<Plain<Real>>(view, object, from, Real(0), u, v, w);
            const Real near_limit = near_light_of<Real>(view);
            const Ray<Real> ray{from, sample.direction, Real(0), {}};
            Hit<Real> hit;
            hit.side = SurfaceId::of(object, false);
            hit.t = sample.distance;
            visit_shape<Plain<Real>>(view, object, [&]<class Shape>(const Shape& shape) {
                if constexpr (IsBoxLike<Shape, Real>) {
                    const DirectionSample<Real> alone = sample_box_light(shape, from, sampling, near_limit, u, v, w);
                    EXPECT_EQ(sample.direction, alone.direction);
                    EXPECT_EQ(sample.distance, alone.distance);
                    EXPECT_EQ(sample.inverse_pdf, alone.inverse_pdf);
                    EXPECT_EQ(inverse_direction_pdf_to<Plain<Real>>(view, hit, ray),
                              inverse_box_light_pdf(shape, from, ray.direction, hit.t, sampling, near_limit));
                } else {
                    ADD_FAILURE() << "no box";
                }
            });
        }
    }
}

// Rounding may put a vertex a little outside of the body that it lies on: the body's own light is left to closest_hit.
TYPED_TEST(LineOfSightTest, NoDistanceIsToldToTheBodyThatTheVertexLiesOn) {
    using Real = TypeParam;
    SceneBuilder builder;
    const std::uint32_t lamp = builder.emitter({1, 1, 1});
    builder.sphere(lamp, {0, 0, 0}, 2);
    builder.sphere(lamp, {0, 100, 0}, 2);  // an object to lie on instead
    RenderSettings settings = default_settings(builder.scene);
    settings.next_event = true;
    settings.light_sampling = LightSampling::projected;
    const SceneBuffers<Real> buffers(builder.scene, settings);
    const SceneView<Real>& view = buffers.view();
    const Vec3<Real> centre = view.spheres[0].centre;
    Random random(7);
    int told = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto word = [&] { return static_cast<std::uint32_t>(random.uniform(0, 0x1p32)); };
        VertexOf<Plain<Real>> vertex{};
        vertex.surface_normal =
            uniform_sphere(static_cast<Real>(random.uniform()), static_cast<Real>(random.uniform()));
        vertex.position = centre + vertex.surface_normal * Real(1.001);
        // Below half of all words the first light is chosen.
        const RandomWords words{word() / 2, word(), word(), word()};
        const auto distance_from = [&](std::uint32_t object) {
            vertex.object = object;
            const LightDraw<Real> draw = draw_light<Plain<Real>>(view, view, vertex, Real(0), false, words);
            EXPECT_EQ(draw.object, 0u);
            return draw.sample.distance;
        };
        EXPECT_EQ(distance_from(0), Real(0));
        told += distance_from(1) > Real(0) ? 1 : 0;
    }
    EXPECT_GT(told, 900);
}

}  // namespace
}  // namespace pt
