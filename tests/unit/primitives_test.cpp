// One primitive and one ray: against long double, from the surface, and where rounding decides.
#include <array>
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
using Wide = Vec3<long double>;

template <class Real>
class PrimitivesTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(PrimitivesTest, Reals);

template <class Real>
constexpr Real epsilon = std::numeric_limits<Real>::epsilon();

template <class Real>
Vec3<Real> random_direction(Random& random) {
    const Real u = static_cast<Real>(random.uniform()), v = static_cast<Real>(random.uniform());
    const long double z = 1 - 2 * static_cast<long double>(u), r = sqrtl(1 - z * z), phi = 6.283185307179586L * v;
    return normalize(
        Vec3<Real>{static_cast<Real>(r * cosl(phi)), static_cast<Real>(r * sinl(phi)), static_cast<Real>(z)});
}

Wide unit_quadratic_terms(const Wide& f, const Wide& g) { return {dot(g, g), -dot(f, g), dot(f, f) - 1}; }

// Compares an interval with the exact roots of |f + t g| = 1, given in units where the body is the unit sphere.
template <class Real>
void expect_unit_roots(const Interval<Real>& got, const Wide& f, const Wide& g, long double unit, long double factor) {
    const Wide abc = unit_quadratic_terms(f, g);
    const Wide closest = f + g * (abc.y / abc.x);
    const long double discriminant = 1 - dot(closest, closest);
    const long double size = 1 + sqrtl(dot(f, f));
    // The closest point is formed with errors of epsilon |f|, and the discriminant with twice that.
    const long double uncertain = factor * epsilon<Real> * size;
    if (std::abs(discriminant) < 4 * uncertain) {
        return;
    }
    ASSERT_EQ(got.hits, discriminant > 0);
    if (discriminant > 0) {
        const long double root = sqrtl(discriminant / abc.x), middle = abc.y / abc.x;
        // d sqrt(D) = dD / 2 sqrt(D)
        const long double tolerance = unit * uncertain * (1 + 1 / sqrtl(discriminant)) / sqrtl(abc.x);
        ASSERT_NEAR(static_cast<double>(got.near), static_cast<double>((middle - root) * unit),
                    static_cast<double>(tolerance));
        ASSERT_NEAR(static_cast<double>(got.far), static_cast<double>((middle + root) * unit),
                    static_cast<double>(tolerance));
    }
}

TYPED_TEST(PrimitivesTest, SphereRootsMatchLongDouble) {
    using Real = TypeParam;
    Random random(1);
    for (int i = 0; i < 200000; ++i) {
        const Real radius = static_cast<Real>(std::exp2(random.uniform(-20, 20)));
        const Sphere<Real> sphere{random_in_cube<Real>(random, 3) * radius, radius, Real(1) / radius};
        // Outside up to 20 radii away, or inside.
        const Real distance = static_cast<Real>(random.uniform() < 0.3 ? random.uniform(0, 1) : random.uniform(1, 20));
        const Vec3<Real> origin = sphere.centre + random_direction<Real>(random) * (distance * radius);
        const Vec3<Real> target = sphere.centre + random_in_cube<Real>(random, 1.2) * radius;
        const Vec3<Real> direction = normalize(target - origin);
        expect_unit_roots(interval(sphere, origin, direction),
                          (Wide(origin) - Wide(sphere.centre)) / (long double)radius, Wide(direction), radius, 8);
    }
}

template <class Real>
Ellipsoid<Real> ellipsoid_of(const Vec3d& scale, const Vec3d& degrees, const Vec3d& centre) {
    test::SceneBuilder builder;
    builder.ellipsoid(builder.diffuse(Vec3d(0.5)), centre, scale, degrees);
    return test::Stages<Real>(builder.scene).view().ellipsoids[0];
}

TYPED_TEST(PrimitivesTest, EllipsoidRootsMatchLongDouble) {
    using Real = TypeParam;
    Random random(2);
    for (int i = 0; i < 100000; ++i) {
        const double size = std::exp2(random.uniform(-20, 20));
        const Vec3d scale = Vec3d(random.uniform(0.3, 2), random.uniform(0.3, 2), random.uniform(0.3, 2)) * size;
        const Vec3d degrees(random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180));
        const Vec3d centre = random_in_cube<double>(random, 3) * size;
        const Ellipsoid<Real> e = ellipsoid_of<Real>(scale, degrees, centre);
        const Vec3<Real> origin =
            e.centre + random_direction<Real>(random) * static_cast<Real>(random.uniform(0, 10) * size);
        const Vec3<Real> direction =
            normalize(e.centre + random_in_cube<Real>(random, 0.9) * static_cast<Real>(size) - origin);
        // To the unit sphere by the definition: undo the translation, the rotation (exact to double) and the scale.
        const Rotation rotation = rotation_of(degrees);
        const auto to_unit = [&](const Wide& v) {
            Wide local;
            for (int k = 0; k < 3; ++k) {
                local[k] = dot(Wide(rotation.column[k]), v) / (0.5L * scale[k]);
            }
            return local;
        };
        // The axes are rounded to Real and mix coordinates whose sizes differ by the scales' ratio of up to 7.
        expect_unit_roots(interval(e, origin, direction), to_unit(Wide(origin) - Wide(e.centre)),
                          to_unit(Wide(direction)), 1, 64);
    }
}

TYPED_TEST(PrimitivesTest, AxisBoxSlabsMatchLongDouble) {
    using Real = TypeParam;
    Random random(3);
    for (int i = 0; i < 200000; ++i) {
        const Vec3<Real> low = random_in_cube<Real>(random, 3);
        const Vec3<Real> high = low + Vec3<Real>(Real(0.01)) + (random_in_cube<Real>(random, 1) + Vec3<Real>(Real(1)));
        const Vec3<Real> origin = random_in_cube<Real>(random, 8);
        const Vec3<Real> direction = normalize((low + high) * Real(0.5) + random_in_cube<Real>(random, 1.5) - origin);
        long double near = -INFINITY, far = INFINITY;
        for (int k = 0; k < 3; ++k) {
            const long double a = ((long double)low[k] - origin[k]) / direction[k];
            const long double b = ((long double)high[k] - origin[k]) / direction[k];
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
        }
        const Interval<Real> got = slab_interval(low, high, origin, reciprocal(direction));
        // One difference, one reciprocal, one product: three roundings, relative to the parameter itself.
        const long double bound = 3.01L * unit_round_off<Real>;
        ASSERT_LE(std::abs(got.near - near), bound * std::abs(near));
        ASSERT_LE(std::abs(got.far - far), bound * std::abs(far));
        if (near <= far) {
            ASSERT_TRUE(got.hits || far < 0);  // S21: no false miss
        } else if (near - far > 16 * epsilon<Real> * std::abs(far)) {
            ASSERT_FALSE(got.hits);
        }
    }
}

// numerics.md S21: rays at the edges and corners of a box. Whatever truly hits must be reported.
TYPED_TEST(PrimitivesTest, RaysThroughBoxEdgesAreNotMissed) {
    using Real = TypeParam;
    Random random(4);
    std::uint64_t exact_hits = 0, edge_hits = 0;
    for (int i = 0; i < 300000; ++i) {
        const Vec3<Real> low = random_in_cube<Real>(random, 3);
        const Vec3<Real> high = low + random_in_cube<Real>(random, 0.9) + Vec3<Real>(Real(1));
        Vec3<Real> target;
        const int free_axis = static_cast<int>(3 * random.uniform());
        for (int k = 0; k < 3; ++k) {
            const Real share =
                k == free_axis ? static_cast<Real>(random.uniform()) : static_cast<Real>(random.word() & 1u);
            target[k] = share == 0 ? low[k] : share == 1 ? high[k] : low[k] + (high[k] - low[k]) * share;
        }
        const Vec3<Real> origin = random_in_cube<Real>(random, 10);
        const Vec3<Real> direction = normalize(target - origin);
        long double near = -INFINITY, far = INFINITY;
        for (int k = 0; k < 3; ++k) {
            const long double a = ((long double)low[k] - origin[k]) / direction[k];
            const long double b = ((long double)high[k] - origin[k]) / direction[k];
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
        }
        if (near <= far && far > 0) {
            ++exact_hits;
            edge_hits += slab_interval(low, high, origin, reciprocal(direction)).hits ? 1u : 0u;
        }
    }
    EXPECT_GT(exact_hits, 100000u);
    EXPECT_EQ(edge_hits, exact_hits);
}

TYPED_TEST(PrimitivesTest, BoxRaysInAFacesPlaneAreDecided) {
    using Real = TypeParam;
    const Vec3<Real> low{-1, -1, -1}, high{1, 1, 1};
    // A direction component of exactly +-0 and an origin on that component's plane: 0 * infinity. The face belongs to
    // the box.
    for (const Real zero : {Real(0), Real(-0.0)}) {
        for (const Real side : {Real(-1), Real(1)}) {
            for (int axis = 0; axis < 3; ++axis) {
                Vec3<Real> origin(0), direction(0);
                direction[axis] = zero;
                origin[axis] = side;
                origin[(axis + 1) % 3] = -3;
                direction[(axis + 1) % 3] = 1;
                direction[(axis + 2) % 3] = zero;
                const Interval<Real> on_plane = slab_interval(low, high, origin, reciprocal(direction));
                EXPECT_TRUE(on_plane.hits);
                EXPECT_EQ(on_plane.near, Real(2));
                EXPECT_EQ(on_plane.far, Real(4));
                origin[axis] = side * (1 + epsilon<Real>);
                EXPECT_FALSE(slab_interval(low, high, origin, reciprocal(direction)).hits);
                origin[axis] = side * (1 - epsilon<Real>);
                EXPECT_TRUE(slab_interval(low, high, origin, reciprocal(direction)).hits);
            }
        }
    }
    // A box without thickness is met, head on and within its plane.
    const Vec3<Real> flat_low{-1, 0, -1}, flat_high{1, 0, 1};
    EXPECT_TRUE(slab_interval(flat_low, flat_high, {0, 3, 0}, reciprocal(Vec3<Real>{0, -1, 0})).hits);
    EXPECT_TRUE(slab_interval(flat_low, flat_high, {-3, 0, 0}, reciprocal(Vec3<Real>{1, 0, 0})).hits);
    EXPECT_FALSE(slab_interval(flat_low, flat_high, {-3, Real(0.1), 0}, reciprocal(Vec3<Real>{1, 0, 0})).hits);
}

TYPED_TEST(PrimitivesTest, OrientedBoxMatchesItsFrameInLongDouble) {
    using Real = TypeParam;
    Random random(5);
    for (int i = 0; i < 100000; ++i) {
        const Vec3d degrees(random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180));
        const Rotation rotation = rotation_of(degrees);
        OrientedBox<Real> box;
        box.centre = random_in_cube<Real>(random, 3);
        for (int k = 0; k < 3; ++k) {
            box.axis[k] = Vec3<Real>(rotation.column[k]);
            box.half[k] = static_cast<Real>(random.uniform(0.1, 2));
        }
        const Vec3<Real> origin = random_in_cube<Real>(random, 8);
        const Vec3<Real> direction = normalize(box.centre + random_in_cube<Real>(random, 1.5) - origin);
        long double near = -INFINITY, far = INFINITY, steepness = 0;
        for (int k = 0; k < 3; ++k) {
            const long double d = dot(Wide(rotation.column[k]), Wide(direction));
            const long double o = dot(Wide(rotation.column[k]), Wide(origin) - Wide(box.centre));
            const long double a = (-box.half[k] - o) / d, b = (box.half[k] - o) / d;
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
            steepness = std::max(steepness, 1 / std::abs(d));
        }
        const Interval<Real> got = interval(box, origin, direction);
        // Local coordinates are off by a few epsilon of 16; divided by the direction's component, twice for its own
        // error.
        const long double tolerance = 64 * epsilon<Real> * steepness * (1 + steepness);
        if (std::abs(near - far) < 4 * tolerance) {
            continue;
        }
        ASSERT_EQ(got.hits, near < far);
        if (near < far) {
            ASSERT_NEAR(got.near, near, tolerance);
            ASSERT_NEAR(got.far, far, tolerance);
        }
    }
}

TYPED_TEST(PrimitivesTest, QuadMatchesItsPlaneInLongDouble) {
    using Real = TypeParam;
    Random random(6);
    for (int i = 0; i < 200000; ++i) {
        const Rotation rotation =
            rotation_of({random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180)});
        const Quad<Real> quad{random_in_cube<Real>(random, 3),
                              Vec3<Real>(rotation.column[1]),
                              Vec3<Real>(rotation.column[0]),
                              Vec3<Real>(rotation.column[2]),
                              static_cast<Real>(random.uniform(0.2, 2)),
                              static_cast<Real>(random.uniform(0.2, 2))};
        const Vec3<Real> origin = random_in_cube<Real>(random, 8);
        const Vec3<Real> direction = normalize(quad.centre + random_in_cube<Real>(random, 2) - origin);
        const Wide to_centre = Wide(quad.centre) - Wide(origin);
        const long double slope = dot(Wide(direction), Wide(rotation.column[1]));
        const long double t = dot(to_centre, Wide(rotation.column[1])) / slope;
        const Wide p = Wide(direction) * t - to_centre;
        const long double u = std::abs(dot(p, Wide(rotation.column[0]))),
                          v = std::abs(dot(p, Wide(rotation.column[2])));
        const long double tolerance = 64 * epsilon<Real> / std::abs(slope) * (1 + std::abs(t));
        const Interval<Real> got = interval(quad, origin, direction);
        ASSERT_NEAR(got.near, t, tolerance);
        if (std::abs(u - quad.half_u) > 4 * tolerance && std::abs(v - quad.half_v) > 4 * tolerance) {
            ASSERT_EQ(got.hits, u < quad.half_u && v < quad.half_v);
        }
    }
    // In the plane: no hit, no NaN that counts as one.
    const Quad<Real> floor{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 1, 1};
    const Interval<Real> along = interval(floor, {-3, 0, 0}, {1, 0, 0});
    EXPECT_FALSE(along.hits && along.near > Real(0));
}

// numerics.md S15. A point that the kernels themselves put on the surface, a direction, and no epsilon anywhere.
template <class Real>
void check_departures(const std::function<void(test::SceneBuilder&, std::uint32_t, double)>& add, double size,
                      double chord_tolerance) {
    test::SceneBuilder builder;
    add(builder, builder.emitter(Vec3d(1.0)), size);
    const test::Stages<Real> stages(builder.scene);
    const auto& view = stages.view();
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
        const LightSample<Real> point = sample_light<Config<Real, all_features>>(
            view, 0, Real(0), unit_interval<Real>(random.word()), unit_interval<Real>(random.word()),
            unit_interval<Real>(random.word()));
        Vec3<Real> direction = random_direction<Real>(random);
        const Real slope = dot(direction, point.normal);
        direction = slope < 0 ? -direction : direction;
        const Ray<Real> outward{point.position, direction, Real(0), SurfaceId::of(0, false)};
        ASSERT_FALSE(stages.intersect(outward).side.exists()) << size;
        const Ray<Real> inward{point.position, -direction, Real(0), SurfaceId::of(0, true)};
        const Hit<Real> hit = stages.intersect(inward);
        if (view.quads.size > 0) {
            ASSERT_FALSE(hit.side.exists()) << size;
            continue;
        }
        ASSERT_TRUE(hit.side.exists()) << size;
        ASSERT_TRUE(hit.side.inside());
        // The far end lies on the surface again, at the exact chord.
        const SurfacePoint<Real> end = stages.surface(inward, hit);
        const Vec3<Real> step = (end.position - point.position) - inward.direction * hit.t;
        ASSERT_LE(std::sqrt(dot(step, step)), static_cast<Real>(chord_tolerance * size)) << size;
        ASSERT_GE(dot(end.normal, inward.direction), -Real(1e-4));
        if (view.spheres.size > 0) {
            const Real exact = 2 * view.spheres[0].radius * std::abs(slope);
            ASSERT_NEAR(hit.t, exact, static_cast<Real>(chord_tolerance * size)) << size;
        }
    }
}

TYPED_TEST(PrimitivesTest, RaysLeaveTheirSurfaceAndChordsAreRight) {
    using Real = TypeParam;
    // Chords are right to a few roundings of the body's size, at the origin of coordinates; ten times that for a body a
    // few sizes away from it (its points are rounded to their own coordinates).
    const double tolerance = 16.0 * epsilon<Real>;
    for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
        const Vec3d off = Vec3d(1, -2, 3) * size;
        check_departures<Real>([](auto& b, auto m, double s) { b.sphere(m, Vec3d(0.0), s); }, size, tolerance);
        check_departures<Real>([&](auto& b, auto m, double s) { b.sphere(m, off, s); }, size, 10 * tolerance);
        check_departures<Real>(
            [&](auto& b, auto m, double s) {
                b.ellipsoid(m, off, Vec3d(1, 0.5, 2) * s, {10, 20, 30});
            },
            size, 40 * tolerance);
        check_departures<Real>([&](auto& b, auto m, double s) { b.box(m, off, Vec3d(1, 0.5, 2) * s); }, size,
                               10 * tolerance);
        check_departures<Real>(
            [&](auto& b, auto m, double s) {
                b.box(m, off, Vec3d(1, 0.5, 2) * s, {10, 20, 30});
            },
            size, 10 * tolerance);
        check_departures<Real>(
            [&](auto& b, auto m, double s) {
                b.quad(m, off, s, 2 * s, {10, 20, 30});
            },
            size, tolerance);
    }
}

TYPED_TEST(PrimitivesTest, SurfacePointsLieOnTheSurfaceWithUnitNormals) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    const std::uint32_t material = builder.diffuse(Vec3d(0.5));
    builder.sphere(material, {-4, 0, 0}, 2);
    builder.ellipsoid(material, {4, 0, 0}, {1, 2, 3}, {10, 20, 30});
    builder.box(material, {0, 4, 0}, {1, 2, 3});
    builder.box(material, {0, -4, 0}, {1, 2, 3}, {40, 50, 60});
    builder.quad(material, {0, 0, 4}, 2, 3, {70, 80, 90});
    const test::Stages<Real> stages(builder.scene);
    Random random(8);
    std::array<int, 5> met{};
    for (int i = 0; i < 100000; ++i) {
        const Vec3<Real> origin = random_in_cube<Real>(random, 8);
        const Ray<Real> ray{origin, normalize(random_in_cube<Real>(random, 6) - origin), Real(0), SurfaceId{}};
        const Hit<Real> hit = stages.intersect(ray);
        if (!hit.side.exists()) {
            continue;
        }
        const SurfacePoint<Real> point = stages.surface(ray, hit);
        ASSERT_NEAR(dot(point.normal, point.normal), Real(1), 8 * epsilon<Real>);
        // Near where the ray says, and exactly on the shape of the scene file.
        const Vec3<Real> along = ray.origin + ray.direction * hit.t - point.position;
        ASSERT_LE(std::sqrt(dot(along, along)), 1000 * epsilon<Real>);
        const SceneObject& object = builder.scene.objects[stages.file_index(hit.side)];
        const Rotation rotation = rotation_of(object.rotate_degrees);
        const Vec3d q = Vec3d(point.position) - object.translate;
        const Vec3d local =
            Vec3d{dot(rotation.column[0], q), dot(rotation.column[1], q), dot(rotation.column[2], q)} / object.scale;
        const double tolerance = 64.0 * epsilon<Real>;
        if (object.shape == Shape::sphere) {
            ASSERT_NEAR(dot(local, local), 0.25, tolerance);
        } else if (object.shape == Shape::box) {
            ASSERT_NEAR(std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)}), 0.5, tolerance);
        } else {
            ASSERT_NEAR(local.y, 0, tolerance);
        }
        // The outward normal: along the ray from inside, against it from outside. A quad's is its +y side.
        const Real slope = dot(point.normal, ray.direction);
        ASSERT_EQ(slope > 0, hit.side.inside()) << slope;
        met[stages.file_index(hit.side)] += 1;
    }
    for (const int count : met) {
        EXPECT_GT(count, 500);
    }
}

}  // namespace
}  // namespace pt
