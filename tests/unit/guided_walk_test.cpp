// Guided walks: the decay solves its equation, every density adds up to 1 and is the one by which steps are drawn, and
// no step's weight is beyond its bound.
#include "kernels/guided_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/scene/guide_walks.h"
#include "kernels/shade.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::Random;

template <class Real>
class GuidedWalkTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(GuidedWalkTest, Reals);

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Real>
ScatteringMedium<Real> medium(const Vec3d& sigma_s, const Vec3d& sigma_a, double share, double g = 0,
                              double depth = infinity) {
    SceneMaterial body;
    body.type = MaterialType::subsurface;
    body.sigma_s = sigma_s;
    body.sigma_a = sigma_a;
    body.g = g;
    ScatteringMedium<Real> material{};
    material.g = static_cast<Real>(g);
    for (int i = 0; i < 3; ++i) {
        const double sigma_t = sigma_s[i] + sigma_a[i];
        material.sigma_s[i] = static_cast<Real>(sigma_s[i]);
        material.sigma_t[i] = static_cast<Real>(sigma_t);
        material.scattering_albedo[i] = static_cast<Real>(sigma_t > 0 ? sigma_s[i] / sigma_t : 0);
    }
    material.grey = material.sigma_t.x == material.sigma_t.y && material.sigma_t.y == material.sigma_t.z ? 1 : 0;
    guide_walks(material, body, share, depth);
    return material;
}

// ---- The decay ----

TEST(GuideDecayTest, SolvesItsEquation) {
    for (const double albedo : {0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1 - 1e-8, 1 - 1e-12}) {
        const long double theta = artanh_of_decay(albedo);
        EXPECT_NEAR(static_cast<double>(albedo * theta / std::tanh(theta)), 1, 1e-12) << albedo;
        if (albedo >= 0.3) {
            // The textbook's: 1 = (albedo nu / 2) ln((nu + 1) / (nu - 1)) with nu = 1 / kappa. Below, nu is too near to
            // 1 for a number of 64 bits.
            const long double nu = 1 / std::tanh(theta);
            EXPECT_NEAR(static_cast<double>(albedo * nu / 2 * std::log((nu + 1) / (nu - 1))), 1, 1e-12) << albedo;
        }
    }
}

TEST(GuideDecayTest, HasTheLimitsOfDiffusionAndOfPureAbsorption) {
    // The series of kappa / artanh(kappa) turned round: kappa^2 = 3 a (1 - 4/5 a - ..) with a = 1 - albedo.
    for (const double absorbed : {1e-3, 1e-5, 1e-7}) {
        EXPECT_NEAR(guide_decay(1 - absorbed, 0, infinity) / std::sqrt(3 * absorbed), 1 - 0.4 * absorbed,
                    absorbed * absorbed + 1e-16 / absorbed);
    }
    EXPECT_EQ(guide_decay(1, 0, infinity), least_decay);
    EXPECT_EQ(guide_decay(1, 0.9, infinity), least_decay);
    EXPECT_EQ(guide_decay(0, 0, infinity), most_decay);
    EXPECT_EQ(guide_decay(1e-3, 0, infinity), most_decay);
    EXPECT_EQ(guide_decay(0.9, 0, 0), least_decay);  // a body without any depth
    // Never outside of what sampling allows, and never more where less is absorbed.
    for (const double g : {-0.9999, -0.5, 0.0, 0.5, 0.9999}) {
        double before = most_decay;
        for (double albedo = 0; albedo <= 1; albedo += 1.0 / 256) {
            const double decay = guide_decay(albedo, g, infinity);
            EXPECT_GE(decay, least_decay);
            EXPECT_LE(decay, most_decay);
            EXPECT_LE(decay, before + (g < 0 ? 1 : 1e-15)) << albedo << " " << g;
            before = decay;
        }
    }
}

TEST(GuideDecayTest, GoesByTheBodysDepth) {
    // A ball of radius R mean free paths: what light is worth goes as sinh(kappa r) / r, and decays below its surface
    // as kappa coth(kappa R) - 1 / R.
    const double kappa = guide_decay(0.98, 0, infinity);
    for (const double radius : {0.5, 2.0, 6.0, 20.0, 100.0}) {
        const double exact = kappa / std::tanh(kappa * radius) - 1 / radius;
        EXPECT_NEAR(guide_decay(0.98, 0, radius / 3), exact, 0.2 * exact) << radius;
    }
    SceneObject object;
    object.shape = Shape::sphere;
    object.scale = Vec3d(3.0);
    EXPECT_NEAR(depth_of(object), 0.5, 1e-15);
    object.scale = {3, 3, 3.0000001};
    EXPECT_NEAR(depth_of(object), 0.5, 1e-6);
    object.shape = Shape::box;
    object.scale = {1, 2, 4};
    EXPECT_DOUBLE_EQ(depth_of(object), 8.0 / (2 * (2 + 8 + 4)));
    object.shape = Shape::quad;
    EXPECT_EQ(depth_of(object), infinity);
}

TYPED_TEST(GuidedWalkTest, SizesByAPowerOfTwoChangeNoBit) {
    const auto base = medium<TypeParam>({2, 3, 5}, {0.1, 0.3, 1}, 0.75, 0, 1.5);
    for (const int k : {-40, -3, 7, 40}) {
        const double scale = std::ldexp(1.0, k);
        const auto other = medium<TypeParam>(Vec3d(2, 3, 5) / scale, Vec3d(0.1, 0.3, 1) / scale, 0.75, 0, 1.5 * scale);
        EXPECT_EQ(other.guide_decay, base.guide_decay);
        EXPECT_EQ(other.guide_albedo, base.guide_albedo);
        const Vec3<TypeParam> throughput(0.3, 0.5, 0.7);
        for (const bool scattered : {false, true}) {
            EXPECT_EQ(
                guided_step_weight<TypeParam>(other, throughput, {TypeParam(0.3), true, scattered},
                                              TypeParam(0.7 * scale)),
                guided_step_weight<TypeParam>(base, throughput, {TypeParam(0.3), true, scattered}, TypeParam(0.7)));
        }
    }
}

// ---- Densities ----

// Composite Gauss-Legendre with five points on each of `parts`.
template <class Function>
double integral(double from, double to, int parts, Function&& f) {
    static constexpr double x[] = {0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640, -0.9061798459386640};
    static constexpr double w[] = {128.0 / 225, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                   0.2369268850561891};
    double sum = 0;
    const double half = (to - from) / parts / 2;
    for (int part = 0; part < parts; ++part) {
        for (int i = 0; i < 5; ++i) {
            sum += w[i] * f(from + half * (2 * part + 1 + x[i]));
        }
    }
    return sum * half;
}

TEST(GuidedDensityTest, OfDirectionsAddsUpToOne) {
    for (const double albedo : {0.0, 0.4, 0.9, 0.999, 1.0}) {
        const auto m = medium<double>(Vec3d(albedo), Vec3d(1 - albedo), 0.5);
        const double sum = integral(-1, 1, 4000, [&](double cosine) {
            return GuidedStep<double>{cosine, true, false}.relative_density(m.guide_decay.x, m.guide_albedo.x) / 2;
        });
        EXPECT_NEAR(sum, 1, 1e-12) << albedo;
    }
}

// The density of a step is what light does over the step's weight: the mixture of all six adds up to 1 over all
// directions and over collisions before the surface and the surface itself, whichever channel tells it.
TEST(GuidedDensityTest, OfMixedStepsAddsUpToOne) {
    struct Case {
        Vec3d sigma_s, sigma_a, throughput;
    };
    const Case cases[] = {{Vec3d(0.9), Vec3d(0.1), Vec3d(1.0)},
                          {Vec3d(2.0), Vec3d(0.0), {0.2, 0.5, 1}},
                          {{1, 3, 6}, {0.6, 0.1, 0.3}, {1, 0.5, 0.25}},
                          {{2.994, 2.91, 2.7}, {0.006, 0.09, 0.3}, {1, 1, 1}},
                          {{4, 4, 4}, {0.02, 0.15, 0.4}, {0.1, 2, 0}}};
    for (const Case& c : cases) {
        for (const double share : {0.25, 0.75, 0.99}) {
            const auto m = medium<double>(c.sigma_s, c.sigma_a, share, 0, 3);
            for (const double surface : {0.3, 2.0}) {
                for (int i = 0; i < 3; ++i) {
                    const auto of_direction = [&](double cosine, bool drew_direction) {
                        const auto density = [&](double t, bool scattered) {
                            const double carries = std::exp(-m.sigma_t[i] * t) * (scattered ? m.sigma_s[i] : 1);
                            return carries / guided_step_weight<double>(m, c.throughput,
                                                                        {cosine, drew_direction, scattered}, t)[i];
                        };
                        return integral(0, surface, 60, [&](double t) { return density(t, true); }) +
                               density(surface, false);
                    };
                    EXPECT_NEAR(integral(-1, 1, 40, [&](double mu) { return of_direction(mu, true) / 2; }), 1, 1e-9);
                    // And flights alone, along each direction.
                    for (const double mu : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
                        EXPECT_NEAR(of_direction(mu, false), 1, 1e-10) << mu;
                    }
                }
            }
        }
    }
}

TYPED_TEST(GuidedWalkTest, CosineIsTheInverseOfItsDistribution) {
    constexpr long double rounding = unit_round_off<TypeParam>;
    for (const double albedo : {0.0, 0.3, 0.6, 0.9, 0.99, 0.9999, 1.0}) {
        const auto m = medium<TypeParam>(Vec3d(albedo), Vec3d(1 - albedo), 0.5);
        const auto decay = static_cast<long double>(m.guide_decay.x);
        for (int i = 0; i <= 4096; ++i) {
            const TypeParam u = static_cast<TypeParam>(std::min(i, 4095)) / 4096;
            const auto cosine = static_cast<long double>(guided_cosine(m.guide_decay.x, m.guide_albedo.x, u));
            ASSERT_LE(std::fabs(cosine), 1);
            const long double share = (std::log1p(decay) - std::log1p(-decay * cosine)) / (2 * std::atanh(decay));
            // A cosine's rounding, times the density there; and some ten roundings of numbers about 1, those of the
            // decay grown by 1 / (1 - decay^2) at its ends.
            const long double density = decay / (2 * std::atanh(decay)) / (1 - decay * cosine);
            const long double tolerance = rounding * (10 + 4 / (1 - decay * decay)) * (1 + density);
            ASSERT_NEAR(static_cast<double>(share), static_cast<double>(u), static_cast<double>(tolerance))
                << albedo << " " << u;
        }
    }
}

TYPED_TEST(GuidedWalkTest, ExponentialLessOneKeepsItsDigits) {
    for (const double size : {1e-12, 1e-6, 1e-3, 0.1, 0.5, 1.0, 2.0, 2.6}) {
        for (const double sign : {-1.0, 1.0}) {
            const auto x = static_cast<TypeParam>(sign * size);
            const long double exact = std::expm1(static_cast<long double>(x));
            EXPECT_NEAR(static_cast<double>(exponential_less_one(x) / exact), 1, 16 * unit_round_off<TypeParam>) << x;
        }
    }
    EXPECT_EQ(exponential_less_one(TypeParam(0)), TypeParam(0));
}

TYPED_TEST(GuidedWalkTest, ChoiceHasItsSharesAndNeverAChannelThatCarriesNothing) {
    const Vec3<TypeParam> throughput(TypeParam(0.5), TypeParam(0), TypeParam(1.5));
    for (const double share : {0.25, 0.5, 0.75}) {
        const auto m = medium<TypeParam>({1, 2, 3}, {1, 1, 1}, share);
        std::uint32_t guided = 0, first = 0;
        constexpr std::uint32_t steps = 4096;
        for (std::uint32_t i = 0; i < steps; ++i) {
            const StepChoice choice = choose_step(m, throughput, static_cast<TypeParam>(i) / steps);
            EXPECT_NE(choice.colour, 1u);
            guided += choice.is_guided ? 1 : 0;
            first += choice.colour == 0 ? 1 : 0;
        }
        EXPECT_EQ(guided, static_cast<std::uint32_t>(share * steps));
        EXPECT_NEAR(first, steps / 4, 2);
        // The last number of a unit interval on either side of the share.
        const Vec3<TypeParam> one(TypeParam(1), TypeParam(0), TypeParam(0));
        const TypeParam last = unit_interval<TypeParam>(0xffffffffu);
        EXPECT_EQ(choose_step(m, one, last).colour, 0u);
        EXPECT_EQ(choose_step(m, one, m.guided_share * last).colour, 0u);
    }
}

// ---- Bounds ----

TYPED_TEST(GuidedWalkTest, NoStepGrowsTheSumBeyondItsBound) {
    Random random(3);
    for (int i = 0; i < 200000; ++i) {
        const auto any = [&](double low, double high) { return std::pow(10, random.uniform(low, high)); };
        const bool grey = i % 3 == 0;
        const double scale = any(-10, 10);
        Vec3d sigma_s, sigma_a, carried;
        for (int c = 0; c < 3; ++c) {
            sigma_s[c] = grey && c > 0 ? sigma_s[0] : scale * any(-3, 3) * (random.uniform() < 0.9 ? 1 : 0);
            sigma_a[c] = grey && c > 0 ? sigma_a[0] : scale * any(-3, 3) * (random.uniform() < 0.7 ? 1 : 0);
            carried[c] = any(-8, 1) * (random.uniform() < 0.9 ? 1 : 0);
        }
        const double share = random.uniform(0.01, 0.99);
        const auto m = medium<TypeParam>(sigma_s, sigma_a, share, 0, any(-3, 3) / scale);
        const Vec3<TypeParam> throughput(carried);
        const GuidedStep<TypeParam> step{static_cast<TypeParam>(random.uniform(-1, 1)), random.uniform() < 0.5,
                                         random.uniform() < 0.5};
        const auto t = static_cast<TypeParam>(any(-8, 4) / scale);
        const Vec3<TypeParam> weight = guided_step_weight(m, throughput, step, t);
        double before = 0, after = 0;
        for (int c = 0; c < 3; ++c) {
            ASSERT_TRUE(std::isfinite(weight[c]) && weight[c] >= 0) << i;
            before += static_cast<double>(throughput[c]);
            after += static_cast<double>(throughput[c]) * static_cast<double>(weight[c]);
        }
        ASSERT_LE(after, before / (1 - share) * (1 + 64 * unit_round_off<TypeParam>)) << i;
    }
}

TYPED_TEST(GuidedWalkTest, WhiteMediaAreWalkedAsEver) {
    // Diffusion without end: there is nothing to be guided to, and every weight is 1.
    const auto m = medium<TypeParam>(Vec3d(3.0), Vec3d(0.0), 0.75);
    for (const TypeParam cosine : {TypeParam(-1), TypeParam(0.2), TypeParam(1)}) {
        for (const TypeParam t : {TypeParam(0), TypeParam(0.3), TypeParam(7)}) {
            for (const bool scattered : {false, true}) {
                const auto weight =
                    guided_step_weight<TypeParam>(m, Vec3<TypeParam>(TypeParam(1)), {cosine, true, scattered}, t);
                EXPECT_NEAR(static_cast<double>(weight.x), 1, 3 * 7 * least_decay + 8 * unit_round_off<TypeParam>);
            }
        }
    }
}

TYPED_TEST(GuidedWalkTest, BlackMediaLetNothingGoOn) {
    const auto m = medium<TypeParam>(Vec3d(0.0), {1, 2, 3}, 0.75);
    const Vec3<TypeParam> one{TypeParam(1), TypeParam(1), TypeParam(1)};
    EXPECT_EQ(guided_step_weight<TypeParam>(m, one, {TypeParam(0.5), true, true}, TypeParam(0.1)),
              Vec3<TypeParam>(TypeParam(0)));
}

// ---- Steps as the kernels take them ----

// From a collision deep inside: cosine and flight of the next step have the mixture's distribution.
TYPED_TEST(GuidedWalkTest, StepsHaveTheirDistribution) {
    using Kernel = Config<TypeParam, all_features | samplings>;
    constexpr double albedo = 0.8, share = 0.6;
    test::SceneBuilder builder;
    builder.camera({0, 600, 0}, {0, 0, 0}, {1, 0, 0}).depth(2);
    builder.box(builder.subsurface(Vec3d(albedo), Vec3d(1 - albedo)), {0, 0, 0}, {1e5, 1000, 1e5});
    RenderSettings settings = default_settings(builder.scene);
    settings.guided_share = share;
    const SceneBuffers<TypeParam> buffers(builder.scene, settings);
    const ScatteringMedium<TypeParam>& m = buffers.view().materials[0].subsurface.medium;
    constexpr int columns = 16, rows = 8;
    std::vector<std::uint64_t> counts(columns * rows);
    std::vector<double> probabilities(columns * rows);
    const auto decay = static_cast<double>(m.guide_decay.x), guided_albedo = static_cast<double>(m.guide_albedo.x);
    for (int column = 0; column < columns; ++column) {
        const double sum = integral(-1 + 2.0 * column / columns, -1 + 2.0 * (column + 1) / columns, 20, [&](double mu) {
            return (1 - share) / 2 + share * guided_albedo / (2 * (1 - decay * mu));
        });
        std::fill_n(probabilities.begin() + column * rows, rows, sum / rows);
    }
    PathCounters counters;
    for (std::uint32_t sample = 0; sample < 100000; ++sample) {
        Path<TypeParam> path = generate<Kernel>(buffers.view(), 0, sample);
        // 200 below the surface that the eye, from which places are told, has 100 below it.
        path.origin = {TypeParam(0), TypeParam(-300), TypeParam(0)};
        path.throughput = Vec3<TypeParam>(TypeParam(1));
        GuidedWalk<TypeParam> walk;
        walk.step = 0;
        walk.object = 0;
        walk.on_surface = false;
        walk.meet_surface({TypeParam(0), TypeParam(1), TypeParam(0)}, {.colour = 0, .is_guided = false});
        path.segment = 1;
        ASSERT_TRUE(walk_on<Kernel>(buffers.view(), path, walk, counters));
        const Vec3d from(path.origin);
        const auto cosine = static_cast<double>(path.direction.y);
        ASSERT_TRUE(walk_on<Kernel>(buffers.view(), path, walk, counters));
        const Vec3d way = Vec3d(path.origin) - from;
        const double t = std::sqrt(dot(way, way));
        // P(flight < t), given the cosine.
        const double guided = share * guided_albedo / (1 - decay * cosine);
        const double below =
            ((1 - share) * -std::expm1(-t) + guided * -std::expm1(-(1 - decay * cosine) * t)) / (1 - share + guided);
        const int column = std::min(static_cast<int>((cosine + 1) / 2 * columns), columns - 1);
        const int row = std::min(static_cast<int>(below * rows), rows - 1);
        counts[column * rows + row] += 1;
    }
    EXPECT_GT(test::chi_square_test(counts, probabilities), test::chi_square_alpha);
}

TYPED_TEST(GuidedWalkTest, GoesTowardsTheNearestSurface) {
    using V = Vec3<TypeParam>;
    const auto vector = [](double x, double y, double z) {
        return V(static_cast<TypeParam>(x), static_cast<TypeParam>(y), static_cast<TypeParam>(z));
    };
    const V known = vector(1, 0, 0);
    test::SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, 1});
    const std::uint32_t material = builder.diffuse(Vec3d(0.5));
    builder.sphere(material, {0, 0, 5}, 2);
    builder.ellipsoid(material, {0, 0, 5}, {4, 2, 2});
    builder.box(material, {0, 0, 5}, {2, 4, 6});
    builder.box(material, {0, 0, 5}, {2, 4, 6}, {0, 0, 30});
    const SceneBuffers<TypeParam> buffers(builder.scene, default_settings(builder.scene));
    const SceneView<TypeParam>& view = buffers.view();
    EXPECT_EQ(outward_near(view.spheres[0], vector(0, 0.5, 5), known), vector(0, 1, 0));
    EXPECT_EQ(outward_near(view.spheres[0], vector(0, 0, 5), known), known);
    EXPECT_EQ(outward_near(view.ellipsoids[0], vector(0, 0, 5), known), known);
    EXPECT_EQ(outward_near(view.ellipsoids[0], vector(0, -0.9, 5), known), vector(0, -1, 0));
    EXPECT_EQ(outward_near(view.axis_boxes[0], vector(-0.9, 1.5, 5), known), vector(-1, 0, 0));
    EXPECT_EQ(outward_near(view.axis_boxes[0], vector(0, 1.5, 5), known), vector(0, 1, 0));
    EXPECT_EQ(outward_near(view.axis_boxes[0], vector(0, 0.5, 2.5), known), vector(0, 0, -1));
    const V turned = outward_near(view.oriented_boxes[0], vector(0.8, 0.4, 5), known);
    EXPECT_NEAR(static_cast<double>(turned.x), std::cos(pi<double> / 6), 1e-6);
    EXPECT_NEAR(static_cast<double>(turned.y), 0.5, 1e-6);
}

}  // namespace
}  // namespace pt
