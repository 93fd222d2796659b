// The principled lobe against quadrature in double and the textbook's forms: energy, density, reciprocity, samples by
// chi-square, and its limits, which are other materials bit for bit.
#include "kernels/materials/principled.h"

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
class PrincipledTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(PrincipledTest, Reals);

using Vec3d = Vec3<double>;
template <class Real>
using Lobe = Principled<Config<Real, all_features>>;

template <class Real>
constexpr double epsilon = std::numeric_limits<Real>::epsilon();

struct Kind {
    double metallic, transmission, ior;
    Vec3d colour{0.9, 0.5, 0.1};
    bool inside = false;  // the viewer
};

const Kind kinds[] = {{0, 0, 1.5},
                      {1, 0, 1.5},
                      {0.3, 0, 1.5},
                      {0, 0, 1.02},
                      {0, 0, 2.5},
                      {0, 1, 1.5},
                      {0, 0.6, 1.5},
                      {0.2, 0.5, 1.5},
                      {0.2, 0.5, 1.5, {0.9, 0.5, 0.1}, true},
                      {0, 0, 1},
                      {0, 0, 1.5, Vec3d(0.0)}};

// --- The textbook, in the surface's frame, with light's side above

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

double index_ahead(const Kind& kind) {
    const bool is_from_within = kind.inside && kind.metallic < 1 && kind.transmission > 0;
    return is_from_within ? 1 / kind.ior : kind.ior;
}

double facet_reflectance(const Kind& kind, double colour, double facing) {
    const double schlick = colour + (1 - colour) * std::pow(1 - facing, 5);
    return kind.metallic * schlick + (1 - kind.metallic) * reflectance(index_ahead(kind), facing);
}

double diffuse_share(const Kind& kind) { return (1 - kind.metallic) * (1 - kind.transmission); }

double diffuse_bsdf(const Kind& kind, double colour, double a, double b) {
    const double n = index_ahead(kind);
    return diffuse_share(kind) * colour / pi<double> * (1 - std::max(reflectance(n, a), reflectance(n, b)));
}

// The principled BSDF for two directions above the surface, by its formula in double.
double bsdf(const Kind& kind, double colour, double alpha, const Vec3d& a, const Vec3d& b) {
    const Vec3d half = normalize(a + b);
    const double both = 1 / (1 + smith_lambda(alpha, a.z) + smith_lambda(alpha, b.z));
    return distribution(alpha, half.z) * both * facet_reflectance(kind, colour, std::min(1.0, dot(a, half))) /
               (4 * a.z * b.z) +
           diffuse_bsdf(kind, colour, a.z, b.z);
}

// What a viewer sees of an even light: what facets keep of the visible ones, the glass beneath them and the diffuse
// surface, by its own quadrature.
double directional_albedo(const Kind& kind, double colour, double alpha, double cosine, int side = 512) {
    const Vec3d viewer = viewer_at(cosine);
    const double n = index_ahead(kind), glass = (1 - kind.metallic) * kind.transmission;
    const double by_facets = mean_over_square(side, [&](double t, double turn) {
        const Facet facet = facet_at(alpha, t, 2 * pi<double> * turn);
        const double facing = std::min(1.0, dot(viewer, facet.normal));
        if (facing <= 0) {
            return 0.0;
        }
        double kept = 0;
        const double above = 2 * facing * facet.normal.z - cosine;
        if (above > 0) {
            kept = facet_reflectance(kind, colour, facing) /
                   (1 + smith_lambda(alpha, cosine) + smith_lambda(alpha, above)) / masking(alpha, cosine);
        }
        const double back = reflectance(n, facing);
        const double beyond = std::sqrt(std::max(0.0, 1 - (1 - facing * facing) / (n * n)));
        const double below = -(facet.normal.z * (facing / n - beyond) - cosine / n);
        if (glass > 0 && back < 1 && below > 0) {
            kept += glass * colour * (1 - back) * masking(alpha, below);
        }
        return visible_facets(alpha, cosine, viewer, facet) * kept;
    });
    constexpr int steps = 1 << 14;
    double diffuse = 0;
    for (int i = 0; i < steps; ++i) {
        const double light = (i + 0.5) / steps;
        diffuse += 2 * pi<double> * light * diffuse_bsdf(kind, colour, cosine, light) / steps;
    }
    return by_facets + diffuse;
}

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

// A surface that faces no axis; local directions have the viewer above it.
template <class Real>
struct Slanted {
    Frame<double> frame{normalize(Vec3d(0.3, -0.5, 0.7))};
    Vec3<Real> normal{Vec3<Real>(frame.normal)};

    Vec3<Real> to_world(const Vec3d& local) const { return Vec3<Real>(frame.to_world(local)); }
    Vec3d to_local(const Vec3<Real>& world) const {
        const Vec3d v(world);
        return {dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal)};
    }
    PrincipledMaterial<Real> material(const Kind& kind, double roughness) const {
        PrincipledMaterial<Real> material{};
        material.metallic = static_cast<Real>(kind.metallic);
        material.transmission = static_cast<Real>(kind.transmission);
        material.alpha = static_cast<Real>(roughness * roughness);
        material.glass.tint = Vec3<Real>(Real(1));
        const auto boundary = [](double n) {
            return Boundary<Real>{static_cast<Real>(n), static_cast<Real>(1 / n), static_cast<Real>((n - 1) * (n + 1))};
        };
        material.glass.entering = boundary(kind.ior);
        material.glass.leaving = boundary(1 / kind.ior);
        return material;
    }
    Vertex<Real> vertex(const Kind& kind) const {
        Vertex<Real> vertex{};
        vertex.surface_normal = normal;
        vertex.inside = kind.inside;
        vertex.hit = SurfaceId::of(0, kind.inside);
        return vertex;
    }
    Lobe<Real> lobe(const Kind& kind, double roughness, const Vec3d& viewer) const {
        const PrincipledMaterial<Real> made = material(kind, roughness);
        return {made, Path<Real>::no_medium, Vec3<Real>(kind.colour), made.alpha, to_world(viewer), vertex(kind)};
    }
};

// --- Energy

TYPED_TEST(PrincipledTest, AnEvenLightIsKeptAsQuadratureHasIt) {
    using Real = TypeParam;
    constexpr int side = 128;
    for (const double roughness : {0.01, 0.3, 0.6, 1.0}) {
        for (const Kind& kind : kinds) {
            for (const double cosine : {1.0, 0.6, 0.1}) {
                const Lobe<Real> lobe = Slanted<Real>().lobe(kind, roughness, direction_at(cosine, 0.7));
                double choice = 0, square = 0;
                const double kept = mean_over_jittered_square(side, [&](double u, double v) {
                    choice = std::fmod(choice + 0.6180339887498949, 1.0);
                    const LobeSample<Real> sample =
                        lobe.sample(std::min(static_cast<Real>(choice), Real(1) - Real(epsilon<Real>)),
                                    static_cast<Real>(u), static_cast<Real>(v));
                    const double weight = sample.cosine != 0 ? static_cast<double>(sample.value.weight.y) : 0.0;
                    square += weight * weight / (side * side);
                    return weight;
                });
                double exact = directional_albedo(kind, kind.colour.y, roughness * roughness, cosine);
                if (kind.ior == 1 && kind.transmission > 0) {
                    exact = kind.colour.y;
                }
                // The error is taken as if the points were independent.
                const double error = std::sqrt(std::max(0.0, square - kept * kept)) / side;
                EXPECT_NEAR(kept, exact, test::tolerated_errors * error + 1e-4)
                    << roughness << " " << cosine << " m " << kind.metallic << " t " << kind.transmission << " n "
                    << kind.ior << (kind.inside ? " inside" : "");
            }
        }
    }
}

// A white material reflects and transmits no more light than there is, at any roughness, index and angle.
TEST(PrincipledEnergy, AWhiteOneGainsNothing) {
    for (const double alpha : {1e-6, 0.01, 0.1, 0.3, 1.0}) {
        for (const double ior : {1.0, 1.02, 1.33, 1.5, 2.5, 20.0}) {
            for (const double cosine : {1.0, 0.8, 0.5, 0.3, 0.1, 0.02}) {
                for (const double metallic : {0.0, 0.5, 1.0}) {
                    for (const bool inside : {false, true}) {
                        const Kind kind{metallic, inside ? 0.25 : 0, ior, Vec3d(1.0), inside};
                        EXPECT_LE(directional_albedo(kind, 1, alpha, cosine, 128), 1 + 1e-5)
                            << alpha << " " << ior << " " << cosine << " " << metallic << " " << inside;
                    }
                }
            }
        }
    }
}

// Why the diffuse surface is not weighed by 1 - F(v.h), as glTF has it.
TEST(PrincipledEnergy, TheWeightOfGltfWouldGainAtGrazingAngles) {
    const Vec3d viewer = viewer_at(0.1);
    const double beneath = mean_over_square(512, [&](double u, double turn) {
        const Vec3d half = normalize(viewer + direction_at(std::sqrt(u), 2 * pi<double> * turn));
        return 1 - reflectance(1.5, std::min(1.0, dot(viewer, half)));
    });
    EXPECT_GT(reflectance(1.5, 0.1) + beneath, 1.3);
}

// Without roughness the sum has a closed form where the viewer looks straight on: F(1) + c (1 - mean of F).
TEST(PrincipledEnergy, StraightOnASmoothOneKeepsAllButItsMeanReflectance) {
    double mean = 0;
    constexpr int steps = 1 << 14;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        mean += 2 * cosine * reflectance(1.5, cosine) / steps;
    }
    // The hemispherical reflectance of index 1.5 (Walsh 1926).
    EXPECT_NEAR(mean, 0.0918, 1e-4);
    EXPECT_NEAR(directional_albedo({0, 0, 1.5}, 0.5, 1e-6, 1), 0.04 + 0.5 * (1 - mean), 1e-5);
}

TYPED_TEST(PrincipledTest, NothingIsOffInAnyCorner) {
    using Real = TypeParam;
    const Real last = Real(1) - Real(epsilon<Real>) / 2;
    const Slanted<Real> surface;
    for (const double roughness : {0.0, 1e-30, 1e-4, 0.09375, 0.25, 1.0}) {
        for (const double metallic : {0.0, 1e-10, 0.5, 1 - 1e-7, 1.0}) {
            for (const double transmission : {0.0, 1e-10, 0.5, 1.0}) {
                for (const double ior : {1.0, 1 + 1e-6, 1.5, 1e4}) {
                    for (const double cosine : {1.0, 0.5, 1e-3, 1e-20, 0.0}) {
                        for (const bool inside : {false, true}) {
                            const Kind kind{metallic, transmission, ior, Vec3d(1, 0.5, 0), inside};
                            const Lobe<Real> lobe = surface.lobe(kind, roughness, direction_at(cosine, 2.1));
                            for (const Real u : {Real(0), Real(0.5), last}) {
                                for (const Real v : {Real(0), Real(0x1p-24), last}) {
                                    for (const Real choice : {Real(0), Real(0.05), Real(0.5), last}) {
                                        const LobeSample<Real> sample = lobe.sample(choice, u, v);
                                        ASSERT_NEAR(dot(sample.direction, sample.direction), 1, 16 * epsilon<Real>);
                                        if (sample.cosine == Real(0)) {
                                            continue;
                                        }
                                        for (int i = 0; i < 3; ++i) {
                                            ASSERT_GE(sample.value.weight[i], 0);
                                            // A facet's angle to the viewer is at most half way to 90 degrees:
                                            // its reflectance is below 2^5 times the surface's.
                                            ASSERT_LE(sample.value.weight[i], 32);
                                        }
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
}

// --- Density

TYPED_TEST(PrincipledTest, WhatIsSentAboveTheSurfaceIsTheTextbooks) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(2);
    for (const double roughness : {0.3, 0.6, 1.0}) {
        for (const Kind& kind : kinds) {
            for (int i = 0; i < 2000; ++i) {
                const Vec3d viewer = direction_at(random.uniform(0.05, 1), random.uniform(0, 6));
                const Vec3d light = direction_at(random.uniform(0.05, 1), random.uniform(0, 6));
                const Lobe<Real> lobe = surface.lobe(kind, roughness, viewer);
                // Index 1 is invisible to glass, and its facets are none.
                if (!lobe.are_facets_wide) {
                    continue;
                }
                const LobeValue<Real> value = lobe.towards(surface.to_world(light), static_cast<Real>(light.z));
                for (int channel = 0; channel < 3; ++channel) {
                    const double exact =
                        bsdf(kind, kind.colour[channel], roughness * roughness, viewer, light) * light.z;
                    ASSERT_NEAR(static_cast<double>(value.weight[channel] * value.pdf), exact,
                                4096 * epsilon<Real> * (exact / (roughness * roughness) + 1))
                        << roughness << " " << kind.metallic << " " << kind.transmission << " " << kind.ior;
                }
            }
        }
    }
}

// Over all directions, on a grid that knows of no facets: what samples do not lose on the wrong side.
TYPED_TEST(PrincipledTest, TheDensityIsNormalised) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    for (const double roughness : {0.75, 1.0}) {
        for (const Kind& kind : kinds) {
            for (const double cosine : {1.0, 0.6, 0.2}) {
                const Lobe<Real> lobe = surface.lobe(kind, roughness, direction_at(cosine, 0));
                if (!lobe.is_connectable()) {
                    continue;
                }
                const double all = mean_over_jittered_square(256, [&](double height, double turn) {
                    const double w = 2 * height - 1;
                    const Vec3d local = direction_at(height_at(w), 2 * pi<double> * turn);
                    const double pdf =
                        static_cast<double>(lobe.towards(surface.to_world(local), static_cast<Real>(local.z)).pdf);
                    return 8 * pi<double> * (1 - std::abs(w)) * pdf;
                });
                double choice = 0;
                const double kept = mean_over_jittered_square(256, [&](double u, double v) {
                    choice = std::fmod(choice + 0.6180339887498949, 1.0);
                    const LobeSample<Real> sample =
                        lobe.sample(std::min(static_cast<Real>(choice), Real(1) - Real(epsilon<Real>)),
                                    static_cast<Real>(u), static_cast<Real>(v));
                    return sample.cosine != Real(0) && sample.value.pdf > Real(0) ? 1.0 : 0.0;
                });
                EXPECT_NEAR(all, kept, 5e-3) << roughness << " " << cosine << " " << kind.metallic << " "
                                             << kind.transmission << " " << kind.ior;
            }
        }
    }
}

TYPED_TEST(PrincipledTest, ItsSamplesSayTheDensityAndTheWeightOfTheirDirections) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(3);
    for (const double roughness : {0.2, 0.5, 1.0}) {
        for (const Kind& kind : kinds) {
            const Lobe<Real> lobe = surface.lobe(kind, roughness, direction_at(0.6, 2.5));
            for (int i = 0; i < 500 && lobe.are_facets_wide; ++i) {
                const LobeSample<Real> sample =
                    lobe.sample(static_cast<Real>(random.uniform()), static_cast<Real>(random.uniform()),
                                static_cast<Real>(random.uniform()));
                if (std::abs(sample.cosine) < Real(1e-3)) {
                    continue;
                }
                const LobeValue<Real> value = lobe.towards(sample.direction, sample.cosine);
                // At the edge of total reflection 1 - R has an infinite slope.
                const double tolerance =
                    std::max(4096 * epsilon<Real> / (roughness * roughness), 16 * std::sqrt(epsilon<Real>));
                ASSERT_NEAR(value.pdf / sample.value.pdf, 1, tolerance)
                    << roughness << " " << kind.metallic << " " << kind.transmission << " " << sample.cosine;
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_NEAR(value.weight[channel], sample.value.weight[channel], tolerance);
                }
            }
        }
    }
}

// f(a, b) = f(b, a), and through the surface f(a, b) nb^-2 = f(b, a) na^-2, for radiance not scaled by n^2.
TYPED_TEST(PrincipledTest, IsReciprocalButForTheSquaresOfTheIndices) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(4);
    int through = 0;
    for (int i = 0; i < 20000; ++i) {
        Kind outside{random.uniform(0, 1), random.uniform(0, 1), random.uniform(1.3, 2.5)};
        Kind within = outside;
        within.inside = true;
        const double roughness = random.uniform(0.4, 1);
        const Vec3d a = direction_at(random.uniform(0.05, 1), random.uniform(0, 7));
        const double side = i % 2 == 0 ? 1 : -1;
        const Vec3d b = direction_at(side * random.uniform(0.05, 1), random.uniform(0, 7));
        const auto sent = [&](const Kind& kind, const Vec3d& to, const Vec3d& from) {
            const LobeValue<Real> value =
                surface.lobe(kind, roughness, to).towards(surface.to_world(from), static_cast<Real>(from.z));
            return static_cast<double>(value.weight.y * value.pdf) / std::abs(from.z);
        };
        // Seen from within, the surface is upside down.
        const auto turned = [](const Vec3d& v) { return Vec3d(v.x, v.y, -v.z); };
        const double there = sent(outside, a, b);
        const double back = side > 0 ? sent(outside, b, a) : sent(within, turned(b), turned(a));
        const Vec3d half = a + b * (side < 0 ? outside.ior : 1);
        const bool is_grazing = std::abs(dot(a, half)) < 0.1 * std::sqrt(dot(half, half));
        if (there > 1e-3 && !is_grazing) {
            ASSERT_NEAR(there / back, side < 0 ? outside.ior * outside.ior : 1, 0x1p15 * epsilon<Real>);
            through += side < 0 ? 1 : 0;
        }
    }
    EXPECT_GT(through, 1000);
}

// --- Samples

TYPED_TEST(PrincipledTest, SamplesFollowTheDensity) {
    using Real = TypeParam;
    constexpr int columns = 16, rows = 16, within = 48, draws = 1 << 17;
    const Slanted<Real> surface;
    std::uint64_t seed = 10;
    for (const double roughness : {0.5, 1.0}) {
        for (const Kind& kind : {kinds[0], kinds[2], kinds[6], kinds[7], kinds[8]}) {
            for (const double cosine : {1.0, 0.6, 0.1}) {
                const Vec3d viewer = direction_at(cosine, 0);
                const Lobe<Real> lobe = surface.lobe(kind, roughness, viewer);
                const Lobe<double> exact = Slanted<double>().lobe(kind, roughness, viewer);
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
                // What is lost is what the density lacks: the quadrature is right to 2e-3.
                const double lost = static_cast<double>(counts.back()) / draws;
                EXPECT_NEAR(1 - all, lost, 2e-3 + 4.5 * std::sqrt(lost / draws));
                counts.pop_back();
                probabilities.pop_back();
                for (double& probability : probabilities) {
                    probability /= all;
                }
                EXPECT_GT(test::chi_square_test(counts, probabilities), test::chi_square_alpha)
                    << roughness << " " << cosine << " m " << kind.metallic << " t " << kind.transmission;
            }
        }
    }
}

// --- Limits

template <class Real>
void expect_same(const LobeSample<Real>& sample, const LobeSample<Real>& other) {
    ASSERT_EQ(sample.cosine, other.cosine);
    if (other.cosine != Real(0)) {
        ASSERT_EQ(sample.direction, other.direction);
        ASSERT_EQ(sample.value.weight, other.value.weight);
        ASSERT_EQ(sample.value.pdf, other.value.pdf);
    }
}

TYPED_TEST(PrincipledTest, AllMetalItIsARoughConductorBitByBit) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(5);
    for (const double roughness : {0.0, 1e-3, 0.2, 0.6, 1.0}) {
        for (int i = 0; i < 4000; ++i) {
            const Vec3d viewer = direction_at(random.uniform(0.01, 1), random.uniform(0, 7));
            const Vec3d light = direction_at(random.uniform(0.01, 1), random.uniform(0, 7));
            const Kind kind{1, random.uniform(0, 1), random.uniform(1, 2), {0.9, 0.5, 0.1}, i % 2 == 0};
            const Lobe<Real> lobe = surface.lobe(kind, roughness, viewer);
            const RoughConductor<Real> metal(Vec3<Real>(kind.colour), static_cast<Real>(roughness * roughness),
                                             surface.to_world(viewer), surface.normal);
            const Real u = unit_interval<Real>(random.word()), v = unit_interval<Real>(random.word());
            expect_same(lobe.sample(unit_interval<Real>(random.word()), u, v), metal.sample(u, v));
            ASSERT_EQ(lobe.is_connectable(), metal.is_connectable());
            if (metal.is_connectable()) {
                const auto value = lobe.towards(surface.to_world(light), static_cast<Real>(light.z));
                const auto other = metal.towards(surface.to_world(light), static_cast<Real>(light.z));
                ASSERT_EQ(value.weight, other.weight);
                ASSERT_EQ(value.pdf, other.pdf);
            }
        }
    }
}

TYPED_TEST(PrincipledTest, AllGlassItIsARoughDielectricBitByBit) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(6);
    for (const double roughness : {0.0, 1e-3, 0.2, 0.6, 1.0}) {
        for (int i = 0; i < 4000; ++i) {
            const Vec3d viewer = direction_at(random.uniform(0.01, 1), random.uniform(0, 7));
            const Vec3d light = direction_at(random.uniform(-1, 1), random.uniform(0, 7));
            const Kind kind{0, 1, random.uniform(1.05, 2), Vec3d(1.0), i % 2 == 0};
            const Lobe<Real> lobe = surface.lobe(kind, roughness, viewer);
            const PrincipledMaterial<Real> material = surface.material(kind, roughness);
            const RoughDielectric<Config<Real, all_features>> glass(
                material.glass, Path<Real>::no_medium, material.alpha, surface.to_world(viewer), surface.vertex(kind));
            const Real choice = unit_interval<Real>(random.word()), u = unit_interval<Real>(random.word());
            const Real v = unit_interval<Real>(random.word());
            LobeSample<Real> other = glass.sample(choice, u, v);
            if (glass.is_connectable()) {
                other.value.pdf = max(other.value.pdf, Real(0x1p-60));
            }
            expect_same(lobe.sample(choice, u, v), other);
            ASSERT_EQ(lobe.is_connectable(), glass.is_connectable());
            if (glass.is_connectable()) {
                const auto value = lobe.towards(surface.to_world(light), static_cast<Real>(light.z));
                const auto by_glass = glass.towards(surface.to_world(light), static_cast<Real>(light.z));
                ASSERT_EQ(value.pdf, by_glass.pdf);
                if (by_glass.pdf > Real(0)) {
                    ASSERT_EQ(value.weight, by_glass.weight);
                }
            }
        }
    }
}

TYPED_TEST(PrincipledTest, OfIndexOneItIsADiffuseSurfaceBitByBit) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    test::Random random(7);
    for (const double roughness : {0.0, 0.5, 1.0}) {
        const Kind kind{0, 0, 1};
        const Lobe<Real> lobe = surface.lobe(kind, roughness, direction_at(0.3, 1));
        for (int i = 0; i < 4000; ++i) {
            const Vec3d light = direction_at(random.uniform(0.01, 1), random.uniform(0, 7));
            const LobeValue<Real> value = lobe.towards(surface.to_world(light), static_cast<Real>(light.z));
            ASSERT_EQ(value.weight, Vec3<Real>(kind.colour));
            ASSERT_EQ(value.pdf, static_cast<Real>(light.z) * (Real(1) / pi<Real>));
            const Real u = unit_interval<Real>(random.word()), v = unit_interval<Real>(random.word());
            const LobeSample<Real> sample = lobe.sample(unit_interval<Real>(random.word()), u, v);
            ASSERT_EQ(sample.direction, Frame<Real>(surface.normal).to_world(cosine_hemisphere(u, v)));
            ASSERT_EQ(sample.value.weight, Vec3<Real>(kind.colour));
        }
    }
}

// Beneath facets that are too narrow to be connected the diffuse surface is, by itself.
TYPED_TEST(PrincipledTest, BeneathNarrowFacetsTheDiffuseSurfaceIsConnected) {
    using Real = TypeParam;
    const Slanted<Real> surface;
    const Kind kind{0.25, 0.25, 1.5};
    const Vec3d viewer = direction_at(0.5, 1);
    const Lobe<Real> lobe = surface.lobe(kind, 0.01, viewer);
    EXPECT_TRUE(lobe.is_connectable());
    EXPECT_FALSE(lobe.lets_through());
    test::Random random(8);
    double lobes = 0, diffuse = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d light = direction_at(random.uniform(0.01, 1), random.uniform(0, 7));
        const LobeValue<Real> value = lobe.towards(surface.to_world(light), static_cast<Real>(light.z));
        ASSERT_NEAR(static_cast<double>(value.weight.y * value.pdf),
                    diffuse_bsdf(kind, kind.colour.y, viewer.z, light.z) * light.z, 64 * epsilon<Real>);
        const LobeSample<Real> sample = lobe.sample(
            unit_interval<Real>(random.word()), unit_interval<Real>(random.word()), unit_interval<Real>(random.word()));
        (sample.value.pdf > Real(0) ? diffuse : lobes) += 1;
    }
    EXPECT_GT(lobes, 200);
    EXPECT_GT(diffuse, 200);
    EXPECT_EQ(lobe.towards(surface.to_world(direction_at(-0.5, 0)), Real(-0.5)).pdf, Real(0));
    EXPECT_FALSE(surface.lobe({1, 0, 1.5}, 0.01, viewer).is_connectable());
}

}  // namespace
}  // namespace pt
