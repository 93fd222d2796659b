// The GGX lobe of rough conductors against quadrature in double: energy, normalisation, masking, reciprocity, and the
// sampler by chi-square.
#include "kernels/materials/rough_conductor.h"

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
class RoughConductorTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RoughConductorTest, Reals);

using Vec3d = Vec3<double>;

constexpr double roughnesses[] = {1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.25, 0.5, 0.75, 1};
constexpr double cosines[] = {1, 0.9, 0.5, 0.1, 0.01};

template <class Real>
constexpr double epsilon = std::numeric_limits<Real>::epsilon();

// A surface that faces no axis.
template <class Real>
Vec3<Real> slanted() {
    return normalize(Vec3<Real>(Real(0.3), Real(-0.5), Real(0.7)));
}

template <class Real>
Vec3<Real> in_plane(double cosine, double turn, const Vec3<Real>& normal) {
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    return Vec3<Real>(
        Frame<double>(normalize(Vec3d(normal))).to_world({sine * std::cos(turn), sine * std::sin(turn), cosine}));
}

template <class Real>
RoughConductor<Real> white(double roughness, double cosine, double turn = 0.7) {
    const Vec3<Real> normal = slanted<Real>();
    return {Vec3<Real>(Real(1)), static_cast<Real>(roughness * roughness), in_plane(cosine, turn, normal), normal};
}

// --- Energy

TYPED_TEST(RoughConductorTest, AWhiteFurnaceLosesWhatSingleScatteringLoses) {
    using Real = TypeParam;
    for (const double roughness : roughnesses) {
        for (const double cosine : cosines) {
            const RoughConductor<Real> lobe = white<Real>(roughness, cosine);
            // Facets of the rim count, so the points are drawn anywhere in their cells.
            test::Random random(1);
            const double kept = mean_over_square(512, [&](double u, double v) {
                const LobeSample<Real> sample = lobe.sample(static_cast<Real>(u + random.uniform(-0.5, 0.5) / 512),
                                                            static_cast<Real>(v + random.uniform(-0.5, 0.5) / 512));
                return sample.cosine > 0 ? static_cast<double>(sample.value.weight.x) : 0.0;
            });
            // The error of 2^18 stratified points, a half of which scatter by 1, is some 3e-5.
            EXPECT_NEAR(kept, kept_energy(roughness * roughness, cosine), 2e-4) << roughness << " " << cosine;
        }
    }
    // D = 1 / pi and q = 1: the integral of ci / (co + ci).
    for (const double cosine : cosines) {
        EXPECT_NEAR(kept_energy(1, cosine), 1 - cosine * std::log1p(1 / cosine), 2e-4) << cosine;
    }
}

TYPED_TEST(RoughConductorTest, NothingIsGainedInAnyCorner) {
    using Real = TypeParam;
    const Real last = Real(1) - Real(epsilon<Real>) / 2;
    for (const double roughness : {0.0, 1e-30, 1e-10, 1e-4, 0.09375, 0.5, 1.0}) {
        for (const double cosine : {1.0, 0.5, 1e-3, 1e-7, 1e-20, 0.0}) {
            for (const Vec3<Real>& normal : {slanted<Real>(), Vec3<Real>(0, 1, 0), Vec3<Real>(0, 0, -1)}) {
                const RoughConductor<Real> lobe(Vec3<Real>(Real(1)), static_cast<Real>(roughness * roughness),
                                                in_plane(cosine, 2.1, normal), normal);
                for (const Real u : {Real(0), Real(0x1p-24), Real(0.5), last}) {
                    for (const Real v : {Real(0), Real(0x1p-24), Real(0.5), last}) {
                        const LobeSample<Real> sample = lobe.sample(u, v);
                        ASSERT_NEAR(dot(sample.direction, sample.direction), 1, 16 * epsilon<Real>);
                        if (sample.cosine > Real(0)) {
                            ASSERT_GE(sample.value.weight.x, 0);
                            ASSERT_LE(sample.value.weight.x, 1);
                            ASSERT_TRUE(std::isfinite(sample.value.pdf));
                            ASSERT_EQ(sample.value.pdf > 0, lobe.is_connectable()) << roughness;
                        }
                    }
                }
            }
        }
    }
}

TYPED_TEST(RoughConductorTest, SchlickGoesFromTheColourToWhite) {
    using Real = TypeParam;
    const Vec3<Real> gold{Real(1), Real(0.75), Real(0.25)};
    EXPECT_EQ(schlick_reflectance(gold, Real(1)), gold);
    EXPECT_EQ(schlick_reflectance(gold, Real(0)), Vec3<Real>(Real(1)));
    EXPECT_EQ(schlick_reflectance(gold, Real(0.5)).y, Real(0.75 + 0.25 / 32));
    EXPECT_EQ(schlick_reflectance(gold, Real(1.0001)), gold);
}

// --- Density

// Over the whole sphere of directions, also those into the surface: Heitz's weak white furnace, which Smith's masking
// alone passes.
TYPED_TEST(RoughConductorTest, TheDensityIsNormalised) {
    using Real = TypeParam;
    for (const double roughness : {0.09375, 0.25, 0.5, 0.75, 1.0}) {
        const double alpha = roughness * roughness;
        for (const double cosine : cosines) {
            const RoughConductor<Real> lobe = white<Real>(roughness, cosine, 0);
            ASSERT_TRUE(lobe.is_connectable());
            const Vec3d viewer = viewer_at(cosine);
            const Frame<double> frame(normalize(Vec3d(lobe.facets.normal)));
            const double all = mean_over_square(512, [&](double t, double turn) {
                const Facet facet = facet_at(alpha, t, 2 * pi<double> * turn);
                const double facing = dot(viewer, facet.normal);
                if (facing <= 0) {
                    return 0.0;
                }
                const Vec3d incoming = facet.normal * (2 * facing) - viewer;
                const double pdf = static_cast<double>(
                    lobe.towards(Vec3<Real>(frame.to_world(incoming)), static_cast<Real>(incoming.z)).pdf);
                // Solid angle of directions a facet's, and of facets a cell.
                return pdf * 4 * facing * facet.measure / (distribution(alpha, facet.normal.z) * facet.normal.z);
            });
            // The slopes of a narrow lobe stand out of single precision's directions by few bits.
            EXPECT_NEAR(all, 1, sizeof(Real) == 4 ? 1e-4 + 2 * epsilon<Real> / alpha : 2e-5)
                << roughness << " " << cosine;
        }
    }
}

TYPED_TEST(RoughConductorTest, ItsSamplesSayTheDensityAndTheWeightOfTheirDirections) {
    using Real = TypeParam;
    test::Random random(3);
    for (const double roughness : {0.09375, 0.1, 0.3, 1.0}) {
        for (const double cosine : cosines) {
            const RoughConductor<Real> lobe = white<Real>(roughness, cosine, 2.5);
            for (int i = 0; i < 200; ++i) {
                const LobeSample<Real> sample =
                    lobe.sample(static_cast<Real>(random.uniform()), static_cast<Real>(random.uniform()));
                if (sample.cosine < Real(1e-3)) {
                    continue;
                }
                const LobeValue<Real> value = lobe.towards(sample.direction, sample.cosine);
                const double tolerance = 64 * epsilon<Real> / (roughness * roughness) / cosine;
                ASSERT_NEAR(value.pdf / sample.value.pdf, 1, tolerance) << roughness << " " << cosine;
                ASSERT_NEAR(value.weight.x, sample.value.weight.x, 64 * epsilon<Real> / 1e-3);
            }
        }
    }
}

TYPED_TEST(RoughConductorTest, IsReciprocal) {
    using Real = TypeParam;
    test::Random random(4);
    const Vec3<Real> normal = slanted<Real>();
    for (int i = 0; i < 20000; ++i) {
        const Real alpha = static_cast<Real>(random.uniform(0.05, 1));
        const Vec3<Real> a = in_plane(random.uniform(0.01, 1), random.uniform(0, 7), normal);
        const Vec3<Real> b = in_plane(random.uniform(0.01, 1), random.uniform(0, 7), normal);
        const auto bsdf = [&](const Vec3<Real>& from, const Vec3<Real>& to) {
            const Real cosine = dot(to, normal);
            const LobeValue<Real> value =
                RoughConductor<Real>(Vec3<Real>(Real(0.5)), alpha, from, normal).towards(to, cosine);
            return static_cast<double>(value.weight.x * value.pdf / cosine);
        };
        ASSERT_NEAR(bsdf(a, b) / bsdf(b, a), 1, 512 * epsilon<Real>);
    }
}

// --- Samples

TYPED_TEST(RoughConductorTest, SamplesFollowTheVisibleFacets) {
    using Real = TypeParam;
    constexpr int columns = 16, rows = 16, within = 24, draws = 1 << 17;
    std::uint64_t seed = 10;
    for (const double roughness : {1e-4, 0.1, 0.5, 1.0}) {
        // Single precision's directions do not tell the facets of a narrow lobe apart.
        if (sizeof(Real) == 4 && roughness < 0.1) {
            continue;
        }
        const double alpha = roughness * roughness;
        for (const double cosine : {1.0, 0.6, 0.05}) {
            const Vec3d viewer = viewer_at(cosine);
            std::vector<double> probabilities(columns * rows);
            double all = 0;
            for (int cell = 0; cell < columns * rows; ++cell) {
                probabilities[cell] = mean_over_square(within, [&](double t, double turn) {
                    const Facet facet =
                        facet_at(alpha, (cell / rows + t) / columns, 2 * pi<double> * (cell % rows + turn) / rows);
                    return visible_facets(alpha, cosine, viewer, facet) / (columns * rows);
                });
                all += probabilities[cell];
            }
            ASSERT_NEAR(all, 1, 1e-4);
            for (double& probability : probabilities) {
                probability /= all;
            }
            const RoughConductor<Real> lobe = white<Real>(roughness, cosine, 0);
            const Frame<double> frame(normalize(Vec3d(lobe.facets.normal)));
            std::vector<std::uint64_t> counts(columns * rows);
            test::Random random(seed++);
            for (int i = 0; i < draws; ++i) {
                const Vec3<Real> direction =
                    lobe.sample(unit_interval<Real>(random.word()), unit_interval<Real>(random.word())).direction;
                const Vec3d half = Vec3d(direction) + Vec3d(lobe.facets.outgoing);
                const double x = dot(half, frame.tangent), y = dot(half, frame.bitangent), z = dot(half, frame.normal);
                const double tangent_squared = (x * x + y * y) / (z * z);
                const double t = 1 - alpha / std::sqrt(alpha * alpha + tangent_squared);
                const double angle = std::atan2(y, x) / (2 * pi<double>);
                const int column = std::min(columns - 1, static_cast<int>(t * columns));
                const int row = std::min(rows - 1, static_cast<int>((angle < 0 ? angle + 1 : angle) * rows));
                counts[column * rows + row] += 1;
            }
            EXPECT_GT(test::chi_square_test(counts, probabilities), test::chi_square_alpha)
                << roughness << " " << cosine;
        }
    }
}

// --- The limit

TYPED_TEST(RoughConductorTest, WithoutRoughnessItIsTheMirrorBitByBit) {
    using Real = TypeParam;
    test::Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const auto component = [&] { return static_cast<Real>(random.uniform(-1, 1)); };
        const Vec3<Real> normal = normalize(Vec3<Real>{component(), component(), component()});
        Vec3<Real> direction = normalize(Vec3<Real>{component(), component(), component()});
        direction = dot(direction, normal) > 0 ? -direction : direction;
        const RoughConductor<Real> lobe(Vec3<Real>(Real(1)), Real(0), -direction, normal);
        const LobeSample<Real> sample =
            lobe.sample(unit_interval<Real>(random.word()), unit_interval<Real>(random.word()));
        ASSERT_EQ(sample.direction, reflect(direction, normal));
        ASSERT_EQ(sample.value.weight, Vec3<Real>(Real(1)));
        ASSERT_EQ(sample.value.pdf, Real(0));
    }
}

TYPED_TEST(RoughConductorTest, ANarrowLobeKeepsToTheMirrorsDirection) {
    using Real = TypeParam;
    const double alpha = 1e-8;
    const RoughConductor<Real> lobe = white<Real>(1e-4, 0.5);
    const Vec3d mirrored = Vec3d(reflect(-lobe.facets.outgoing, lobe.facets.normal));
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            const LobeSample<Real> sample =
                lobe.sample(static_cast<Real>((i + 0.5) / 64), static_cast<Real>((j + 0.5) / 64));
            const Vec3d off = Vec3d(sample.direction) - mirrored;
            // No visible facet of these is steeper than some 200 alpha.
            ASSERT_LE(std::sqrt(dot(off, off)), 500 * alpha + 8 * epsilon<Real>);
        }
    }
}

}  // namespace
}  // namespace pt
