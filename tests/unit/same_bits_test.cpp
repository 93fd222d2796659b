// Forms that take fewer instructions than the ones that they stand for, held to those bit for bit.
#include <cmath>
#include <random>
#include <type_traits>

#include <gtest/gtest.h>

#include "kernels/shade.h"

namespace pt {
namespace {

template <class Real>
class SameBits : public testing::Test {
protected:
    Real uniform(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(random_); }
    Vec3<Real> vector(Real size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    std::uint32_t word() { return static_cast<std::uint32_t>(random_()); }

private:
    std::mt19937 random_{20};
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SameBits, Reals);

// Rays from anywhere and from the box's own planes, along directions some of whose entries are all but 0.
TYPED_TEST(SameBits, OfSlabsWhoseReciprocalsAreFinite) {
    using Real = TypeParam;
    std::uint32_t hits = 0, starts_on_plane = 0;
    for (int i = 0; i < 200000; ++i) {
        const Vec3<Real> low = this->vector(2);
        const Vec3<Real> high = low + Vec3<Real>(this->uniform(0, 2), this->uniform(0, 2), i % 7 == 0 ? 0 : 1);
        Vec3<Real> origin = this->vector(3);
        if (i % 3 == 0) {
            origin[i / 3 % 3] = i % 2 == 0 ? low[i / 3 % 3] : high[i / 3 % 3];
            ++starts_on_plane;
        }
        Vec3<Real> direction = normalize(this->vector(1));
        direction[i / 5 % 3] *= std::ldexp(Real(1), -(i % 97));
        if (!has_finite_reciprocal(direction)) {
            continue;
        }
        const Vec3<Real> inverse = reciprocal(direction);
        const Interval<Real> expected = slab_interval(low, high, origin, inverse);
        const Interval<Real> got = finite_slab_interval(low, high, origin, inverse);
        ASSERT_EQ(got.hits, expected.hits) << i;
        ASSERT_EQ(got.near, expected.near) << i;
        ASSERT_EQ(got.far, expected.far) << i;
        hits += got.hits ? 1u : 0u;
    }
    EXPECT_GT(hits, 5000u);
    EXPECT_GT(starts_on_plane, 10000u);
}

TYPED_TEST(SameBits, OnlyPlainDirectionsHaveFiniteReciprocals) {
    using Real = TypeParam;
    const Real tiny = Real(0x1p-101);
    EXPECT_TRUE(has_finite_reciprocal(Vec3<Real>(1, -1, Real(0x1p-100))));
    for (const Real bad : {Real(0), -Real(0), tiny, -tiny}) {
        EXPECT_FALSE(has_finite_reciprocal(Vec3<Real>(bad, 1, 1)));
        EXPECT_FALSE(has_finite_reciprocal(Vec3<Real>(1, bad, 1)));
        EXPECT_FALSE(has_finite_reciprocal(Vec3<Real>(1, 1, bad)));
    }
}

TYPED_TEST(SameBits, OfTheIntervalFromMinusOneToOne) {
    using Real = TypeParam;
    const auto check = [](std::uint32_t word) {
        ASSERT_EQ(symmetric_interval<Real>(word), Real(2) * unit_interval<Real>(word) - Real(1)) << word;
    };
    for (const std::uint32_t word : {0u, 1u, 255u, 256u, 0x7fffffffu, 0x80000000u, 0xfffffeffu, 0xffffffffu}) {
        check(word);
    }
    for (int i = 0; i < 100000; ++i) {
        check(this->word());
    }
    EXPECT_EQ(symmetric_interval<Real>(0), Real(-1));
    EXPECT_LT(symmetric_interval<Real>(0xffffffffu), Real(1));
}

TYPED_TEST(SameBits, OfAProductWithAFacesNormal) {
    using Real = TypeParam;
    Vertex<Real> vertex{};
    for (int i = 0; i < 6000; ++i) {
        vertex.hit = SurfaceId::of_face(17, static_cast<std::uint32_t>(i % 3), i % 2 == 0);
        const Vec3<Real> v = this->vector(1);
        ASSERT_EQ(vertex.dot_normal(v), dot(v, vertex.normal())) << i;
    }
    vertex.hit = SurfaceId::of(17, false);
    vertex.surface_normal = normalize(Vec3<Real>(1, 2, -3));
    const Vec3<Real> v = this->vector(1);
    EXPECT_EQ(vertex.dot_normal(v), dot(v, vertex.surface_normal));
}

// A sphere that a line passes by is met at 0, so that nobody who wants t > 0 need ask whether it hits.
TYPED_TEST(SameBits, OfASphereThatALinePassesBy) {
    using Real = TypeParam;
    static_assert(misses_at_zero<Sphere<Real>>);
    static_assert(misses_at_zero<NearSphere<Real>>);
    static_assert(!misses_at_zero<OrientedBox<Real>>);
    std::uint32_t misses = 0;
    for (int i = 0; i < 20000; ++i) {
        NearSphere<Real> sphere{};
        sphere.radius = this->uniform(Real(0.1), 2);
        sphere.inverse_radius = Real(1) / sphere.radius;
        sphere.centre = this->vector(3);
        sphere.is_near_eye = i % 2;
        sphere.eye_power = (dot(sphere.centre, sphere.centre) - sphere.radius * sphere.radius) * sphere.inverse_radius *
                           sphere.inverse_radius;
        const Interval<Real> crossing = interval(sphere, this->vector(3), normalize(this->vector(1)));
        if (!crossing.hits) {
            ASSERT_EQ(crossing.near, Real(0)) << i;
            ASSERT_EQ(crossing.far, Real(0)) << i;
            ++misses;
        }
    }
    EXPECT_GT(misses, 1000u);
}

TEST(SurfaceIds, PrecedeEachOtherByObjectWhateverTheirFaces) {
    for (const std::uint32_t low : {0u, 1u, 5u, SurfaceId::most_objects - 2}) {
        for (const std::uint32_t high : {low + 1, SurfaceId::most_objects - 1}) {
            for (const SurfaceId first : {SurfaceId::of(low, true), SurfaceId::of_face(low, 2, true)}) {
                for (const SurfaceId second : {SurfaceId::of(high, false), SurfaceId::of_face(high, 0, false)}) {
                    EXPECT_TRUE(first.precedes(second)) << low << ' ' << high;
                    EXPECT_FALSE(second.precedes(first)) << low << ' ' << high;
                }
            }
        }
    }
}

}  // namespace
}  // namespace pt
