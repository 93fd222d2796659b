// The nearest hit among many objects: against the definition of the scene format in long double, ties, order, motion,
// closed rooms that must not leak.
#include "kernels/intersect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "kernels/light.h"
#include "tests/support/random_vectors.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::Random;
using test::random_in_cube;
using test::SceneBuilder;
using test::Stages;
using Wide = Vec3<long double>;

template <class Real>
class IntersectTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(IntersectTest, Reals);

template <class Real>
Ray<Real> random_ray(Random& random, double half) {
    const Vec3<Real> origin = random_in_cube<Real>(random, half);
    return {origin, normalize(random_in_cube<Real>(random, half) - origin), Real(0), SurfaceId{}};
}

// Undoes translate * Rz * Ry * Rx * scale step by step, with the elementary rotations written out.
Wide undo_rotation(Wide v, const Vec3d& degrees) {
    const long double to_radians = 3.14159265358979323846264338327950288L / 180;
    const long double z = -degrees.z * to_radians, y = -degrees.y * to_radians, x = -degrees.x * to_radians;
    v = {v.x * cosl(z) - v.y * sinl(z), v.x * sinl(z) + v.y * cosl(z), v.z};
    v = {v.x * cosl(y) + v.z * sinl(y), v.y, -v.x * sinl(y) + v.z * cosl(y)};
    return {v.x, v.y * cosl(x) - v.z * sinl(x), v.y * sinl(x) + v.z * cosl(x)};
}

// Parameters where the ray meets the surface of an object, in increasing order, and whether it only just does or does
// not.
struct Crossings {
    long double t[2];
    int count = 0;
    bool doubtful = false;
};

Crossings crossings_of(const SceneObject& object, const Wide& origin, const Wide& direction, long double doubt) {
    const Wide scale(object.scale);
    const Wide o = undo_rotation(origin - Wide(object.translate), object.rotate_degrees) / scale;
    const Wide d = undo_rotation(direction, object.rotate_degrees) / scale;
    Crossings result;
    if (object.shape == Shape::sphere) {
        const long double a = dot(d, d), b = dot(o, d), c = dot(o, o) - 0.25L;
        const long double discriminant = b * b - a * c;
        result.doubtful = std::abs(discriminant) < doubt * a;
        if (discriminant > 0) {
            result.count = 2;
            result.t[0] = (-b - sqrtl(discriminant)) / a;
            result.t[1] = (-b + sqrtl(discriminant)) / a;
        }
    } else if (object.shape == Shape::box) {
        long double near = -INFINITY, far = INFINITY;
        for (int k = 0; k < 3; ++k) {
            near = std::max(near, std::min((-0.5L - o[k]) / d[k], (0.5L - o[k]) / d[k]));
            far = std::min(far, std::max((-0.5L - o[k]) / d[k], (0.5L - o[k]) / d[k]));
        }
        result.doubtful = std::abs(near - far) < doubt;
        if (near < far) {
            result.count = 2;
            result.t[0] = near;
            result.t[1] = far;
        }
    } else {
        const long double t = -o.y / d.y;
        const long double x = std::abs(o.x + d.x * t), z = std::abs(o.z + d.z * t);
        result.doubtful = std::abs(x - 0.5L) < doubt || std::abs(z - 0.5L) < doubt || std::abs(d.y) < doubt;
        if (x < 0.5L && z < 0.5L) {
            result.count = 1;
            result.t[0] = t;
        }
    }
    return result;
}

SceneBuilder random_objects(std::uint64_t seed, int count) {
    Random random(seed);
    SceneBuilder builder;
    const std::uint32_t material = builder.diffuse(Vec3d(0.5));
    for (int i = 0; i < count; ++i) {
        const Vec3d centre = random_in_cube<double>(random, 4);
        const Vec3d scale(random.uniform(0.4, 2), random.uniform(0.4, 2), random.uniform(0.4, 2));
        const Vec3d turn(random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180));
        switch (i % 5) {
            case 0:
                builder.sphere(material, centre, scale.x);
                break;
            case 1:
                builder.ellipsoid(material, centre, scale, turn);
                break;
            case 2:
                builder.box(material, centre, scale, {90, 180, -270});
                break;
            case 3:
                builder.box(material, centre, scale, turn);
                break;
            default:
                builder.quad(material, centre, scale.x, scale.z, turn);
        }
    }
    return builder;
}

TYPED_TEST(IntersectTest, NearestHitIsThatOfTheSceneFormat) {
    using Real = TypeParam;
    const SceneBuilder builder = random_objects(1, 25);
    const Stages<Real> stages(builder.scene);
    // Coordinates of up to 8 are rounded to Real; a thousand roundings leaves room for steep and grazing rays.
    const long double doubt = 1000 * std::numeric_limits<Real>::epsilon();
    Random random(2);
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        const Ray<Real> ray = random_ray<Real>(random, 5);
        long double nearest = INFINITY;
        std::size_t nearest_object = 0;
        bool from_inside = false, doubtful = false;
        for (std::size_t k = 0; k < builder.scene.objects.size(); ++k) {
            const Crossings crossings =
                crossings_of(builder.scene.objects[k], Wide(ray.origin), Wide(ray.direction), doubt);
            doubtful |= crossings.doubtful;
            for (int j = 0; j < crossings.count; ++j) {
                const long double t = crossings.t[j];
                doubtful |= std::abs(t) < doubt || std::abs(t - nearest) < doubt;
                if (t > 0 && t < nearest) {
                    nearest = t;
                    nearest_object = k;
                    from_inside = j == 1;
                }
            }
        }
        if (doubtful) {
            continue;
        }
        ++compared;
        const Hit<Real> hit = stages.intersect(ray);
        ASSERT_EQ(hit.side.exists(), nearest < INFINITY) << i;
        if (hit.side.exists()) {
            ASSERT_EQ(stages.file_index(hit.side), nearest_object) << i;
            ASSERT_NEAR(hit.t, nearest, doubt) << i;
            if (builder.scene.objects[nearest_object].shape != Shape::quad) {
                ASSERT_EQ(hit.side.inside(), from_inside) << i;
            }
        }
    }
    EXPECT_GT(compared, 19000);
}

TYPED_TEST(IntersectTest, OrderInTheFileDoesNotChangeHits) {
    using Real = TypeParam;
    SceneBuilder builder = random_objects(3, 30);
    const Stages<Real> stages(builder.scene);
    Scene reversed = builder.scene;
    std::reverse(reversed.objects.begin(), reversed.objects.end());
    std::rotate(reversed.objects.begin(), reversed.objects.begin() + 7, reversed.objects.end());
    const Stages<Real> other(reversed);
    Random random(4);
    for (int i = 0; i < 50000; ++i) {
        const Ray<Real> ray = random_ray<Real>(random, 5);
        const Hit<Real> a = stages.intersect(ray), b = other.intersect(ray);
        ASSERT_EQ(a.t, b.t);
        ASSERT_EQ(a.side.code, b.side.code);
    }
}

TYPED_TEST(IntersectTest, TiesGoToTheLowestObjectNumber) {
    using Real = TypeParam;
    for (int shape = 0; shape < 5; ++shape) {
        SceneBuilder builder;
        // Both materials have a body in the same place.
        for (const double albedo : {0.25, 0.75}) {
            const std::uint32_t material = builder.diffuse(Vec3d(albedo));
            const Vec3d centre{0, 0, 4};
            if (shape == 0) {
                builder.sphere(material, centre, 2);
            } else if (shape == 1) {
                builder.ellipsoid(material, centre, {2, 1, 2}, {10, 20, 30});
            } else if (shape == 2) {
                builder.box(material, centre, Vec3d(2.0));
            } else if (shape == 3) {
                builder.box(material, centre, Vec3d(2.0), {10, 20, 30});
            } else {
                builder.quad(material, centre, 2, 2, {90, 0, 0});
            }
        }
        const Stages<Real> stages(builder.scene);
        Random random(5);
        for (int i = 0; i < 2000; ++i) {
            const Ray<Real> ray{
                {0, 0, 0}, normalize(Vec3<Real>(0, 0, 8) + random_in_cube<Real>(random, 0.5)), Real(0), {}};
            const Hit<Real> hit = stages.intersect(ray);
            ASSERT_TRUE(hit.side.exists());
            ASSERT_EQ(hit.side.object(), 0u);
        }
    }
}

TYPED_TEST(IntersectTest, CameraInsideSeesTheBodyFromInside) {
    using Real = TypeParam;
    Random random(6);
    for (int shape = 0; shape < 4; ++shape) {
        SceneBuilder builder;
        const std::uint32_t material = builder.diffuse(Vec3d(0.5));
        const Vec3d turn = shape == 3 ? Vec3d(10, 20, 30) : Vec3d(0.0);
        shape < 2 ? builder.ellipsoid(material, {0.1, 0, 0}, shape == 0 ? Vec3d(2.0) : Vec3d(2, 3, 4))
                  : builder.box(material, {0.1, 0, 0}, {2, 3, 4}, turn);
        const Stages<Real> stages(builder.scene);
        for (int i = 0; i < 5000; ++i) {
            const Ray<Real> ray{{0, 0, 0}, normalize(random_in_cube<Real>(random, 1)), Real(0), {}};
            const Hit<Real> hit = stages.intersect(ray);
            ASSERT_TRUE(hit.side.exists());
            ASSERT_TRUE(hit.side.inside());
            ASSERT_GT(hit.t, Real(0.5));
        }
    }
}

TYPED_TEST(IntersectTest, BodiesBehindTheRayAreNotMet) {
    using Real = TypeParam;
    SceneBuilder builder;
    const std::uint32_t material = builder.diffuse(Vec3d(0.5));
    builder.sphere(material, {0, 0, -4}, 2);
    builder.ellipsoid(material, {0, 0, -4}, {2, 1, 1});
    builder.box(material, {0, 0, -4}, Vec3d(2.0));
    builder.box(material, {0, 0, -4}, Vec3d(2.0), {10, 20, 30});
    builder.quad(material, {0, 0, -4}, 2, 2, {90, 0, 0});
    const Stages<Real> stages(builder.scene);
    EXPECT_FALSE(stages.intersect(Ray<Real>{{0, 0, 0}, {0, 0, 1}, Real(0), {}}).side.exists());
    EXPECT_TRUE(stages.intersect(Ray<Real>{{0, 0, 0}, {0, 0, -1}, Real(0), {}}).side.exists());
}

TYPED_TEST(IntersectTest, QuarterTurnsOfABoxAreExact) {
    using Real = TypeParam;
    // A box turned by quarters is the box with its sides exchanged: the same object, bit for bit.
    SceneBuilder turned, plain;
    turned.box(turned.diffuse(Vec3d(0.5)), {1, 2, 3}, {1, 2, 3}, {90, -90, 360});
    // About x: (1,2,3) -> (1,3,2); about y: (1,3,2) -> (2,3,1).
    plain.box(plain.diffuse(Vec3d(0.5)), {1, 2, 3}, {2, 3, 1});
    const AxisBox<Real> a = Stages<Real>(turned.scene).view().axis_boxes[0];
    const AxisBox<Real> b = Stages<Real>(plain.scene).view().axis_boxes[0];
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
}

TYPED_TEST(IntersectTest, OrientedBoxTurnedIntoPlaceIsTheAxisBox) {
    using Real = TypeParam;
    SceneBuilder oriented, aligned;
    // A hair off a quarter turn takes the other formula: hits agree to that hair.
    oriented.box(oriented.diffuse(Vec3d(0.5)), {0, 0, 4}, {1, 2, 3}, {0, 90 + 1e-9, 0});
    aligned.box(aligned.diffuse(Vec3d(0.5)), {0, 0, 4}, {1, 2, 3}, {0, 90, 0});
    const Stages<Real> a(oriented.scene), b(aligned.scene);
    ASSERT_EQ(a.view().oriented_boxes.size, 1u);
    ASSERT_EQ(b.view().axis_boxes.size, 1u);
    Random random(7);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Ray<Real> ray{random_in_cube<Real>(random, 1),
                            normalize(Vec3<Real>(0, 0, 3) + random_in_cube<Real>(random, 1.5)),
                            Real(0),
                            {}};
        const Hit<Real> one = a.intersect(ray), two = b.intersect(ray);
        if (one.side.exists() && two.side.exists()) {
            // A hit point moves by the hair (2e-11 radians) or a few roundings, times the slope of the face (at most
            // some 20 in these rays; a ray along a face is either met there or not).
            const Vec3<Real> p = a.surface(ray, one).position - b.surface(ray, two).position;
            ASSERT_LE(std::sqrt(dot(p, p)), sizeof(Real) == 4 ? Real(2e-4) : Real(1e-8));
            ++hits;
        }
    }
    EXPECT_GT(hits, 5000);
}

TYPED_TEST(IntersectTest, MovingObjectIsMetWhereItIsAtTheRaysTime) {
    using Real = TypeParam;
    // Dyadic places, velocities and times: o - v t is exact, so the hit must equal that of the translated object.
    const Vec3d velocity{1, -0.5, 0.25};
    const double time = 0.75;
    SceneBuilder moving = random_objects(8, 10), still = random_objects(8, 10);
    for (std::size_t i = 0; i < moving.scene.objects.size(); ++i) {
        for (SceneBuilder* builder : {&moving, &still}) {
            Vec3d& place = builder->scene.objects[i].translate;
            for (int k = 0; k < 3; ++k) {
                place[k] = std::round(place[k] * 16) / 16;
            }
        }
        moving.scene.objects[i].velocity = velocity;
        still.scene.objects[i].translate += velocity * time;
    }
    const Stages<Real> a(moving.scene), b(still.scene);
    Random random(9);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        Ray<Real> ray = random_ray<Real>(random, 5);
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = std::round(ray.origin[k] * 1024) / 1024;
        }
        ray.time = static_cast<Real>(time);
        const Hit<Real> one = a.intersect(ray), two = b.intersect(ray);
        ASSERT_EQ(one.side.exists(), two.side.exists());
        if (!one.side.exists()) {
            continue;
        }
        ++hits;
        ASSERT_EQ(a.file_index(one.side), b.file_index(two.side));
        // Axis boxes and oriented shapes round their planes after the translation, spheres only the difference.
        ASSERT_NEAR(one.t, two.t, 64 * std::numeric_limits<Real>::epsilon() * 16);
        if (a.view().spheres.size > one.side.object()) {
            ASSERT_EQ(one.t, two.t);
        }
        const Vec3<Real> p = a.surface(ray, one).position - b.surface(ray, two).position;
        ASSERT_LE(std::sqrt(dot(p, p)), 2000 * std::numeric_limits<Real>::epsilon());
    }
    EXPECT_GT(hits, 2000);
}

// --- Closed rooms
// -----------------------------------------------------------------------------------------------------

template <class Real>
struct LeakCount {
    std::uint64_t segments = 0, leaks = 0;
};

// Diffuse walks inside a closed room. From time to time a ray is aimed straight at an edge or a corner of the room
// [centre - half, centre + half] turned by `degrees`, so that the walk also starts from there.
template <class Real>
LeakCount<Real> walk_inside(const Scene& scene, const Vec3d& centre, const Vec3d& half, const Vec3d& degrees,
                            std::uint64_t segments, std::uint64_t seed) {
    const Stages<Real> stages(scene);
    const Rotation rotation = rotation_of(degrees);
    Random random(seed);
    LeakCount<Real> count;
    Ray<Real> ray{Vec3<Real>(centre - scene.camera.eye), normalize(random_in_cube<Real>(random, 1)), Real(0), {}};
    Vec3d wall_normal(0.0);
    while (count.segments < segments) {
        if (random.uniform() < 0.1) {
            Vec3d corner;
            const int free_axis = static_cast<int>(4 * random.uniform());  // 3: a corner
            for (int k = 0; k < 3; ++k) {
                corner[k] = k == free_axis ? random.uniform(-1, 1) : (random.word() & 1u) != 0 ? 1 : -1;
            }
            const Vec3d local = corner * half;
            const Vec3d target = centre - scene.camera.eye + rotation.column[0] * local.x +
                                 rotation.column[1] * local.y + rotation.column[2] * local.z;
            // Not along the wall that the ray starts on.
            const Vec3d direction = target - Vec3d(ray.origin);
            if (dot(direction, wall_normal) > 0.01 * std::sqrt(dot(direction, direction))) {
                ray.direction = normalize(Vec3<Real>(direction));
            }
        }
        ++count.segments;
        const Hit<Real> hit = stages.intersect(ray);
        bool lost = !hit.side.exists();
        if (!lost) {
            const SurfacePoint<Real> point = stages.surface(ray, hit);
            const Vec3<Real> normal = hit.side.inside() ? -point.normal : point.normal;
            // On the outside of the walls the way is as lost as without a hit: the normal must look at the centre.
            lost = dot(Vec3<Real>(centre - scene.camera.eye) - point.position, normal) < 0;
            ray.origin = point.position;
            ray.direction = normalize(Frame<Real>(normal).to_world(
                cosine_hemisphere(unit_interval<Real>(random.word()), unit_interval<Real>(random.word()))));
            ray.origin_surface = SurfaceId::of(hit.side.object(), hit.side.inside());
            wall_normal = Vec3d(normal);
        }
        if (lost) {
            ++count.leaks;
            ray = {Vec3<Real>(centre - scene.camera.eye), normalize(random_in_cube<Real>(random, 1)), Real(0), {}};
            wall_normal = Vec3d(0.0);
        }
    }
    return count;
}

template <class Real>
void expect_no_leaks(const std::function<void(SceneBuilder&, std::uint32_t)>& add, const Vec3d& centre,
                     const Vec3d& half, const Vec3d& degrees, std::uint64_t segments) {
    SceneBuilder builder;
    add(builder, builder.diffuse(Vec3d(0.5)));
    builder.camera(centre + Vec3d(0.3, 0.2, 0.1) * half, centre + Vec3d(1, 0, 0));
    const LeakCount<Real> count = walk_inside<Real>(builder.scene, centre, half, degrees, segments, 11);
    EXPECT_EQ(count.leaks, 0u) << "in " << count.segments << " segments; half " << half.x << " " << half.y << " "
                               << half.z;
}

// Six quads, placed as SceneBuilder::room does and then turned together about the centre.
void turned_room(SceneBuilder& builder, std::uint32_t material, const Vec3d& centre, const Vec3d& half,
                 double degrees_z) {
    SceneBuilder upright;
    upright.room(0, Vec3d(0.0), half);
    const Rotation rotation = rotation_of({0, 0, degrees_z});
    for (SceneObject object : upright.scene.objects) {
        object.material = material;
        object.translate = centre + rotation.column[0] * object.translate.x + rotation.column[1] * object.translate.y +
                           rotation.column[2] * object.translate.z;
        object.rotate_degrees.z += degrees_z;  // z is the last rotation
        builder.scene.objects.push_back(object);
    }
}

constexpr std::uint64_t room_segments = 1000000;

TYPED_TEST(IntersectTest, RoomOfSixQuadsDoesNotLeak) {
    using Real = TypeParam;
    for (const Vec3d half : {Vec3d(1.0), Vec3d(5.0), Vec3d(0.7, 1.3, 2.9)}) {
        expect_no_leaks<Real>(
            [&](auto& b, auto m) {
                b.room(m, {0, 0, 0}, half);
            },
            {0, 0, 0}, half, Vec3d(0.0), room_segments);
    }
}

TYPED_TEST(IntersectTest, RoomOfSixQuadsElsewhereDoesNotLeak) {
    using Real = TypeParam;
    const Vec3d half(1, 2, 1.5), centre(10.3, -7.1, 3.7);
    expect_no_leaks<Real>([&](auto& b, auto m) { b.room(m, centre, half); }, centre, half, Vec3d(0.0), room_segments);
}

TYPED_TEST(IntersectTest, TurnedRoomOfSixQuadsDoesNotLeak) {
    using Real = TypeParam;
    const Vec3d half(1, 2, 1.5);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            turned_room(b, m, {0, 0, 0}, half, 33);
        },
        {0, 0, 0}, half, {0, 0, 33}, room_segments);
}

TYPED_TEST(IntersectTest, LongRoomOfSixQuadsDoesNotLeak) {
    using Real = TypeParam;
    const Vec3d half(0.5, 0.5, 25);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            b.room(m, {0, 0, 0}, half);
        },
        {0, 0, 0}, half, Vec3d(0.0), room_segments);
}

TYPED_TEST(IntersectTest, BoxesDoNotLeak) {
    using Real = TypeParam;
    const Vec3d half(0.7, 1.3, 2.9);
    const Vec3d turn(20, 30, 40);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            b.box(m, {1, 2, 3}, half * 2.0);
        },
        {1, 2, 3}, half, Vec3d(0.0), room_segments);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            b.box(m, {1, 2, 3}, half * 2.0, turn);
        },
        {1, 2, 3}, half, turn, room_segments);
}

TYPED_TEST(IntersectTest, SpheresDoNotLeak) {
    using Real = TypeParam;
    const Vec3d half(0.7, 1.3, 2.9);
    const Vec3d turn(20, 30, 40);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            b.sphere(m, {1, 2, 3}, 2);
        },
        {1, 2, 3}, Vec3d(1.0), Vec3d(0.0), room_segments);
    expect_no_leaks<Real>(
        [&](auto& b, auto m) {
            b.ellipsoid(m, {1, 2, 3}, half * 2.0, turn);
        },
        {1, 2, 3}, half, turn, room_segments);
}

}  // namespace
}  // namespace pt
