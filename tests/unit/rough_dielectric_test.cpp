// The lobes of rough glass against quadrature in double and the textbook's forms (Walter et al. 2007): energy, density,
// reciprocity with its factor n^2, samples by chi-square, and the smooth boundary as its limit.
#include "kernels/materials/rough_dielectric.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/ggx_textbook.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using namespace test::ggx;

template <class Real>
class RoughDielectricTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RoughDielectricTest, Reals);

using Vec3d = Vec3<double>;
template <class Real>
using Lobe = RoughDielectric<Config<Real, all_features>>;

constexpr double roughnesses[] = {1e-4, 1e-2, 0.1, 0.25, 0.5, 1};
constexpr double wide_roughnesses[] = {0.25, 0.5, 0.75, 1};
constexpr double cosines[] = {1, 0.6, 0.05};
constexpr double indices[] = {1.5, 1 / 1.5, 2.4, 1 / 2.4, 1.1};  // ahead / behind

template <class Real>
constexpr double epsilon = std::numeric_limits<Real>::epsilon();

// --- The textbook, in the surface's frame

// Hecht: by the angles on both sides.
double reflectance(double n, double cosine) {
    const double sine = std::sqrt((1 - cosine) * (1 + cosine)) / n;
    if (sine >= 1) {
        return 1;
    }
    const double beyond = std::sqrt((1 - sine) * (1 + sine));
    const double s = (cosine - n * beyond) / (cosine + n * beyond);
    const double p = (n * cosine - beyond) / (n * cosine + beyond);
    return (s * s + p * p) / 2;
}

struct Way {
    Vec3d direction;
    double kept = 0;  // of the light that the facet sends there, 0 where that is the wrong side
};

// A visible facet's two ways; `alpha` of the surface, `n` = index ahead / behind.
Way reflected(double alpha, const Vec3d& viewer, const Vec3d& facet) {
    Way way{facet * (2 * dot(viewer, facet)) - viewer};
    if (way.direction.z > 0) {
        way.kept =
            1 / (1 + smith_lambda(alpha, viewer.z) + smith_lambda(alpha, way.direction.z)) / masking(alpha, viewer.z);
    }
    return way;
}
Way refracted(double alpha, double n, const Vec3d& viewer, const Vec3d& facet) {
    const double cosine = dot(viewer, facet);
    const double beyond = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (n * n)));
    Way way{facet * (cosine / n - beyond) - viewer * (1 / n)};
    way.kept = way.direction.z < 0 ? masking(alpha, -way.direction.z) : 0;
    return way;
}

// What the visible facets' two ways add up to: f(way) each, in proportion to the facets seen and to the light.
template <class F>
double sum_over_ways(double alpha, double n, const Vec3d& viewer, const F& f) {
    return mean_over_square(512, [&](double t, double turn) {
        const Facet facet = facet_at(alpha, t, 2 * pi<double> * turn);
        const double facing = dot(viewer, facet.normal);
        if (facing <= 0) {
            return 0.0;
        }
        const double back = reflectance(n, std::min(1.0, facing));
        const double ways = back * f(reflected(alpha, viewer, facet.normal)) +
                            (back < 1 ? (1 - back) * f(refracted(alpha, n, viewer, facet.normal)) : 0);
        return masking(alpha, viewer.z) * facing / (viewer.z * facet.normal.z) * facet.measure * ways;
    });
}

// A mean over the unit square by points drawn anywhere in their cells, for what has edges.
template <class F>
double mean_over_jittered_square(int side, const F& f) {
    test::Random random(1);
    return mean_over_square(side, [&](double x, double y) {
        const double moved = x + random.uniform(-0.5, 0.5) / side;
        return f(moved, y + random.uniform(-0.5, 0.5) / side);
    });
}

// The height of a direction: from -1 to 1, with more directions near the poles.
double height_at(double w) { return std::copysign(1 - (1 - std::abs(w)) * (1 - std::abs(w)), w); }

// --- The kernel's lobe

// A surface that faces no axis, and glass ahead or, for an index below 1, behind.
template <class Real>
struct Slanted {
    Frame<double> frame{normalize(Vec3d(0.3, -0.5, 0.7))};
    Vec3<Real> normal{Vec3<Real>(frame.normal)};

    Vec3<Real> to_world(const Vec3d& local) const { return Vec3<Real>(frame.to_world(local)); }
    Vec3d to_local(const Vec3<Real>& world) const {
        const Vec3d v(world);
        return {dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal)};
    }
    // From above the surface, or, if `inside`, from below.
    Lobe<Real> lobe(double roughness, double ior, const Vec3d& viewer, bool inside = false) const {
        DielectricMaterial<Real> glass{};
        glass.tint = Vec3<Real>(Real(1));
        const auto boundary = [](double n) {
            return Boundary<Real>{static_cast<Real>(n), static_cast<Real>(1 / n), static_cast<Real>((n - 1) * (n + 1))};
        };
        glass.entering = boundary(ior);
        glass.leaving = boundary(1 / ior);
        Vertex<Real> vertex{};
        vertex.surface_normal = inside ? -normal : normal;
        vertex.inside = inside;
        vertex.hit = SurfaceId::of(0, inside);
        return {glass, Path<Real>::no_medium, static_cast<Real>(roughness * roughness), to_world(viewer), vertex};
    }
};

// --- Energy

TYPED_TEST(RoughDielectricTest, AWhiteFurnaceLosesWhatSingleScatteringLoses) {
    using Real = TypeParam;
    constexpr int side = 128;
    for (const double roughness : roughnesses) {
        for (const double n : indices) {
            for (const double cosine : cosines) {
                const double alpha = roughness * roughness;
                const Vec3d viewer = direction_at(cosine, 0.7);
                const Lobe<Real> lobe = Slanted<Real>().lobe(roughness, n, viewer);
                // Points drawn anywhere in their cells, and the choice of the way by a golden ratio's multiples.
                double choice = 0;
                const double kept = mean_over_jittered_square(side, [&](double u, double v) {
                    choice = std::fmod(choice + 0.6180339887498949, 1.0);
                    const LobeSample<Real> sample =
                        lobe.sample(std::min(static_cast<Real>(choice), Real(1) - Real(epsilon<Real>)),
                                    static_cast<Real>(u), static_cast<Real>(v));
                    return sample.cosine != 0 ? static_cast<double>(sample.value.weight.x) : 0.0;
                });
                const double exact = sum_over_ways(alpha, n, viewer, [](const Way& way) { return way.kept; });
                EXPECT_LE(exact, 1 + 1e-4);
                EXPECT_NEAR(kept, exact, 2e-3) << roughness << " " << n << " " << cosine;
            }
        }
    }
}

TYPED_TEST(RoughDielectricTest, NothingIsGainedInAnyCorner) {
    using Real = TypeParam;
    const Real last = Real(1) - Real(epsilon<Real>) / 2;
    const Slanted<Real> surface;
    for (const double roughness : {0.0, 1e-30, 1e-10, 1e-4, 0.09375, 0.25, 1.0}) {
        for (const double ior : {0.01, 0.5, 1.0, 1 + 1e-6, 1.01, 1.5, 1e4}) {
            for (const double cosine : {1.0, 0.5, 1e-3, 1e-7, 1e-20, 0.0}) {
                for (const bool inside : {false, true}) {
                    const Lobe<Real> lobe =
                        surface.lobe(roughness, ior, direction_at(inside ? -cosine : cosine, 2.1), inside);
                    for (const Real u : {Real(0), Real(0x1p-24), Real(0.5), last}) {
                        for (const Real v : {Real(0), Real(0x1p-24), Real(0.5), last}) {
                            for (const Real choice : {Real(0), Real(0.05), Real(0.5), last}) {
                                const LobeSample<Real> sample = lobe.sample(choice, u, v);
                                ASSERT_NEAR(dot(sample.direction, sample.direction), 1, 16 * epsilon<Real>);
                                if (sample.cosine != Real(0)) {
                                    ASSERT_GE(sample.value.weight.x, 0);
                                    ASSERT_LE(sample.value.weight.x, 1);
                                    ASSERT_TRUE(std::isfinite(sample.value.pdf));
                                    ASSERT_GE(sample.value.pdf, 0);
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

// --- Density

// Facet by facet: the density of mirrored and refracted directions by Walter's equations 14 and 17.
TYPED_TEST(RoughDielectricTest, TheDensityIsTheTextbooks) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(2);
    int compared = 0;
    for (const double roughness : wide_roughnesses) {
        const double alpha = roughness * roughness;
        for (const double n : indices) {
            for (int i = 0; i < 2000; ++i) {
                const Vec3d viewer = direction_at(random.uniform(0.05, 1), random.uniform(0, 6));
                const Vec3d facet = facet_at(alpha, random.uniform(0, 0.9), random.uniform(0, 7)).normal;
                const double facing = dot(viewer, facet);
                if (facing < 0.05) {
                    continue;
                }
                const Lobe<Real> lobe = surface.lobe(roughness, n, viewer);
                if (!lobe.is_connectable()) {
                    continue;
                }
                const double back = reflectance(n, facing);
                const double visible = masking(alpha, viewer.z) * facing * distribution(alpha, facet.z) / viewer.z;
                // Rounded directions move the facet by some epsilon / (1 - 1/n) of its slopes.
                const double tolerance = 4096 * epsilon<Real> / alpha / std::abs(n - 1);
                const Way mirrored = reflected(alpha, viewer, facet);
                if (mirrored.direction.z > 0.01) {
                    const LobeValue<Real> value =
                        lobe.towards(surface.to_world(mirrored.direction), static_cast<Real>(mirrored.direction.z));
                    ASSERT_NEAR(value.pdf / (back * visible / (4 * facing)), 1, tolerance);
                    ASSERT_NEAR(value.weight.x, mirrored.kept, 1e-4);
                }
                const Way passed = refracted(alpha, n, viewer, facet);
                if (back < 0.5 && passed.direction.z < -0.01) {
                    const double beyond = dot(passed.direction, facet);
                    const double sum = facing + n * beyond;
                    const LobeValue<Real> value =
                        lobe.towards(surface.to_world(passed.direction), static_cast<Real>(passed.direction.z));
                    ASSERT_NEAR(value.pdf / ((1 - back) * visible * n * n * -beyond / (sum * sum)), 1, tolerance)
                        << roughness << " " << n << " " << facing;
                    ASSERT_NEAR(value.weight.x, passed.kept, 1e-4);
                    compared += 1;
                }
            }
        }
    }
    EXPECT_GT(compared, 10000);
}

// Over all directions, on a grid that knows of no facets: what is neither density nor lost on the wrong side is
// missing.
TYPED_TEST(RoughDielectricTest, TheDensityIsNormalised) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    for (const double roughness : {0.75, 1.0}) {
        for (const double n : {1.5, 1 / 1.5, 2.4}) {
            for (const double cosine : {1.0, 0.6, 0.2}) {
                const Vec3d viewer = direction_at(cosine, 0);
                const Lobe<Real> lobe = surface.lobe(roughness, n, viewer);
                const double all = mean_over_jittered_square(512, [&](double height, double turn) {
                    const double w = 2 * height - 1;
                    const Vec3d local = direction_at(height_at(w), 2 * pi<double> * turn);
                    const double pdf =
                        static_cast<double>(lobe.towards(surface.to_world(local), static_cast<Real>(local.z)).pdf);
                    return 8 * pi<double> * (1 - std::abs(w)) * pdf;
                });
                const double exact = sum_over_ways(roughness * roughness, n, viewer,
                                                   [](const Way& way) { return way.kept > 0 ? 1.0 : 0.0; });
                EXPECT_NEAR(all, exact, 1e-3) << roughness << " " << n << " " << cosine;
            }
        }
    }
}

TYPED_TEST(RoughDielectricTest, ItsSamplesSayTheDensityAndTheWeightOfTheirDirections) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(3);
    int passed = 0;
    for (const double roughness : {0.2, 0.5, 1.0}) {
        for (const double n : indices) {
            const Lobe<Real> lobe = surface.lobe(roughness, n, direction_at(0.6, 2.5));
            if (!lobe.is_connectable()) {
                continue;
            }
            for (int i = 0; i < 500; ++i) {
                const LobeSample<Real> sample =
                    lobe.sample(static_cast<Real>(random.uniform()), static_cast<Real>(random.uniform()),
                                static_cast<Real>(random.uniform()));
                if (std::abs(sample.cosine) < Real(1e-3)) {
                    continue;
                }
                const LobeValue<Real> value = lobe.towards(sample.direction, sample.cosine);
                // At the edge of total reflection 1 - R has an infinite slope.
                const double tolerance = 1024 * epsilon<Real> / (roughness * roughness) / std::abs(n - 1);
                ASSERT_NEAR(value.pdf / sample.value.pdf, 1, std::max(tolerance, 16 * std::sqrt(epsilon<Real>)))
                    << roughness << " " << n << " " << sample.cosine;
                ASSERT_NEAR(value.weight.x, sample.value.weight.x, 128 * epsilon<Real> / 1e-3);
                passed += sample.cosine < 0 ? 1 : 0;
            }
        }
    }
    EXPECT_GT(passed, 2000);
}

// f(a, b) nb^-2 = f(b, a) na^-2 for light from b to a, radiance not scaled by n^2 (Veach 1997, eq. 5.14, but for that).
TYPED_TEST(RoughDielectricTest, IsReciprocalButForTheSquaresOfTheIndices) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(4);
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        const double roughness = random.uniform(0.4, 1), ior = random.uniform(1.3, 2.5);
        const Vec3d a = direction_at(random.uniform(0.05, 1), random.uniform(0, 7));
        const double side = i % 2 == 0 ? 1 : -1;
        const Vec3d b = direction_at(side * random.uniform(0.05, 1), random.uniform(0, 7));
        const auto bsdf = [&](const Vec3d& to, const Vec3d& from, bool inside) {
            const Real cosine = static_cast<Real>(inside ? -from.z : from.z);
            const LobeValue<Real> value =
                surface.lobe(roughness, ior, to, inside).towards(surface.to_world(from), cosine);
            return static_cast<double>(value.weight.x * value.pdf) / std::abs(static_cast<double>(cosine));
        };
        const double there = bsdf(a, b, false), back = bsdf(b, a, side < 0);
        // At grazing facets, from within at the edge of total reflection, 1 - R has an infinite slope.
        const Vec3d half = a + b * (side < 0 ? ior : 1);
        const bool is_grazing = std::abs(dot(a, half)) < 0.1 * std::sqrt(dot(half, half));
        if (there > 1e-3 && !is_grazing) {
            ASSERT_NEAR(there / back, side < 0 ? ior * ior : 1, 0x1p15 * epsilon<Real>);
            compared += side < 0 ? 1 : 0;
        } else if (!is_grazing) {
            ASSERT_LT(back, 1e-2);
        }
    }
    EXPECT_GT(compared, 1000);
}

// --- Samples

// Directions of all sides, against the density of the lobe (which the tests above hold to the textbook's) and the share
// that is lost.
TYPED_TEST(RoughDielectricTest, SamplesFollowTheDensity) {
    using Real = TypeParam;
    constexpr int columns = 16, rows = 16, within = 48, draws = 1 << 17;
    const Slanted<Real> surface;
    std::uint64_t seed = 10;
    for (const double roughness : {0.5, 1.0}) {
        for (const double n : {1.5, 1 / 1.5}) {
            for (const double cosine : {1.0, 0.6, 0.1}) {
                const Vec3d viewer = direction_at(cosine, 0);
                const Lobe<Real> lobe = surface.lobe(roughness, n, viewer);
                const Lobe<double> exact = Slanted<double>().lobe(roughness, n, viewer);
                std::vector<double> probabilities(columns * rows + 1);
                double all = 0;
                for (int cell = 0; cell < columns * rows; ++cell) {
                    probabilities[cell] = mean_over_jittered_square(within, [&](double height, double turn) {
                        const double w = 2 * (cell / rows + height) / columns - 1;
                        const Vec3d local = direction_at(height_at(w), 2 * pi<double> * (cell % rows + turn) / rows);
                        return 8 * pi<double> * (1 - std::abs(w)) / (columns * rows) *
                               exact.towards(Slanted<double>().to_world(local), local.z).pdf;
                    });
                    all += probabilities[cell];
                }
                const double kept = sum_over_ways(roughness * roughness, n, viewer,
                                                  [](const Way& way) { return way.kept > 0 ? 1.0 : 0.0; });
                ASSERT_NEAR(all, kept, 2e-3) << roughness << " " << n << " " << cosine;
                for (double& probability : probabilities) {
                    probability *= kept / all;
                }
                probabilities.back() = std::max(0.0, 1 - kept);
                std::vector<std::uint64_t> counts(columns * rows + 1);
                test::Random random(seed++);
                for (int i = 0; i < draws; ++i) {
                    const Real choice = unit_interval<Real>(random.word());
                    const Real u = unit_interval<Real>(random.word());
                    const LobeSample<Real> sample = lobe.sample(choice, u, unit_interval<Real>(random.word()));
                    if (sample.cosine == Real(0)) {
                        counts.back() += 1;
                        continue;
                    }
                    const Vec3d local = surface.to_local(sample.direction);
                    const double angle = std::atan2(local.y, local.x) / (2 * pi<double>);
                    const double w = std::copysign(1 - std::sqrt(std::max(0.0, 1 - std::abs(local.z))), local.z);
                    const int column = std::clamp(static_cast<int>((w + 1) / 2 * columns), 0, columns - 1);
                    const int row = std::min(rows - 1, static_cast<int>((angle < 0 ? angle + 1 : angle) * rows));
                    counts[column * rows + row] += 1;
                }
                EXPECT_GT(test::chi_square_test(counts, probabilities), test::chi_square_alpha)
                    << roughness << " " << n << " " << cosine << " all " << all;
            }
        }
    }
}

// --- The limit

TYPED_TEST(RoughDielectricTest, WithoutRoughnessItIsTheSmoothBoundaryBitByBit) {
    using Real = TypeParam;
    using SmoothConfig = Config<Real, all_features>;
    test::Random random(5);
    int passed = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto component = [&] { return static_cast<Real>(random.uniform(-1, 1)); };
        DielectricMaterial<Real> glass{};
        glass.tint = Vec3<Real>(Real(1));
        glass.entering = {Real(1.5), Real(1 / 1.5), Real(1.25)};
        glass.leaving = {Real(1 / 1.5), Real(1.5), Real(-1.25 / 2.25)};
        Vertex<Real> vertex{};
        vertex.inside = i % 2 == 0;
        vertex.hit = SurfaceId::of(0, vertex.inside);
        vertex.surface_normal = normalize(Vec3<Real>{component(), component(), component()});
        Path<Real> path{};
        path.direction = normalize(Vec3<Real>{component(), component(), component()});
        path.throughput = Vec3<Real>(Real(1));
        path.direction = dot(path.direction, vertex.normal()) > 0 ? -path.direction : path.direction;
        const Lobe<Real> lobe(glass, Path<Real>::no_medium, Real(0), -path.direction, vertex);
        const Real choice = unit_interval<Real>(random.word());
        const Real u = unit_interval<Real>(random.word());
        const LobeSample<Real> sample = lobe.sample(choice, u, unit_interval<Real>(random.word()));
        glass.template scatter_by<SmoothConfig>(path, vertex, choice);
        ASSERT_EQ(sample.direction, path.direction);
        ASSERT_EQ(sample.value.weight, Vec3<Real>(Real(1)));
        ASSERT_EQ(sample.value.pdf, Real(0));
        ASSERT_FALSE(lobe.is_connectable());
        passed += sample.cosine < 0 ? 1 : 0;
    }
    EXPECT_GT(passed, 5000);
}

TYPED_TEST(RoughDielectricTest, ANarrowLobeKeepsToTheSmoothDirections) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    const Vec3d viewer = direction_at(0.5, 1);
    const Lobe<Real> narrow = surface.lobe(1e-4, 1.5, viewer);
    const Lobe<Real> smooth = surface.lobe(0, 1.5, viewer);
    for (const Real choice : {Real(0), Real(0.5)}) {
        const LobeSample<Real> exact = smooth.sample(choice, Real(0.5), Real(0.5));
        for (int i = 0; i < 64; ++i) {
            for (int j = 0; j < 64; ++j) {
                const LobeSample<Real> sample =
                    narrow.sample(choice, static_cast<Real>((i + 0.5) / 64), static_cast<Real>((j + 0.5) / 64));
                ASSERT_NEAR(sample.value.weight.x, 1, 1e-6);
                const Vec3d off = Vec3d(sample.direction) - Vec3d(exact.direction);
                // No visible facet of these is steeper than some 200 alpha.
                ASSERT_LE(std::sqrt(dot(off, off)), 1000 * 1e-8 + 16 * epsilon<Real>);
            }
        }
    }
}

}  // namespace
}  // namespace pt
