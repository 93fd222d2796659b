// Scalar functions and frames against long double, and the exact identities that they must keep.
#include "kernels/math.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "kernels/rng.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

template <class Real>
class MathTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(MathTest, Reals);

constexpr long double exact_pi = 3.14159265358979323846264338327950288L;

// Distance in units of the last place of `exact`.
template <class Real>
long double ulps(Real value, long double exact) {
    const Real magnitude = std::abs(static_cast<Real>(exact));
    const Real next = std::nextafter(magnitude, std::numeric_limits<Real>::infinity());
    return std::abs(static_cast<long double>(value) - exact) / (static_cast<long double>(next) - magnitude);
}

TYPED_TEST(MathTest, SinCosOctantIsWithinOneAndAHalfUnits) {
    using Real = TypeParam;
    constexpr int steps = 100000;
    long double worst_sine = 0, worst_cosine = 0;
    for (int i = -steps; i <= steps; ++i) {
        const Real x = static_cast<Real>(static_cast<long double>(i) / steps * exact_pi / 4);
        const SinCos<Real> result = sin_cos_octant(x);
        if (i != 0) {
            worst_sine = std::max(worst_sine, ulps(result.sine, sinl(static_cast<long double>(x))));
        }
        worst_cosine = std::max(worst_cosine, ulps(result.cosine, cosl(static_cast<long double>(x))));
    }
    // Cephes promises half a unit and a little from the polynomial; the last two additions round once more each.
    EXPECT_LT(worst_sine, 1.5L);
    EXPECT_LT(worst_cosine, 1.5L);
    EXPECT_EQ(sin_cos_octant(Real(0)).sine, Real(0));
    EXPECT_EQ(sin_cos_octant(Real(0)).cosine, Real(1));
}

TYPED_TEST(MathTest, SinCosTurnIsWithinThreeUnitsOfTheRotation) {
    using Real = TypeParam;
    constexpr int steps = 200000;
    // The octant's argument carries the roundings of 2 pi and of one product: 1 unit more than the octant itself, where
    // a unit of a small sine is worth up to 2 in relative terms.
    long double worst = 0;
    for (int i = 0; i <= steps; ++i) {
        const Real u = static_cast<Real>(i) / static_cast<Real>(steps);
        // The reference reduces to an octant too, or the rounding of 2 pi u would spoil it near its zeros.
        const long quarter = lroundl(4 * static_cast<long double>(u));
        const long double angle =
            2 * exact_pi * (static_cast<long double>(u) - 0.25L * static_cast<long double>(quarter));
        const long double sines[] = {sinl(angle), cosl(angle), -sinl(angle), -cosl(angle)};
        const SinCos<Real> result = sin_cos_turn(u);
        const long double sine = sines[quarter & 3], cosine = sines[(quarter + 1) & 3];
        worst = std::max(worst, sine == 0 ? std::abs(static_cast<long double>(result.sine)) : ulps(result.sine, sine));
        worst = std::max(worst,
                         cosine == 0 ? std::abs(static_cast<long double>(result.cosine)) : ulps(result.cosine, cosine));
    }
    EXPECT_LT(worst, 3.0L);
}

TYPED_TEST(MathTest, SinCosTurnIsExactAtQuarterTurns) {
    using Real = TypeParam;
    const Real sines[] = {0, 1, 0, -1, 0};
    const Real cosines[] = {1, 0, -1, 0, 1};
    for (int quarter = 0; quarter <= 4; ++quarter) {
        const SinCos<Real> result = sin_cos_turn(Real(quarter) / Real(4));
        EXPECT_EQ(result.sine, sines[quarter]) << quarter;
        EXPECT_EQ(result.cosine, cosines[quarter]) << quarter;
    }
}

TYPED_TEST(MathTest, SinCosTurnAddsQuarterTurnsExactly) {
    using Real = TypeParam;
    // Multiples of 2^-20: u + 1/4 is exact, so the same octant must come out, bit for bit. Odd multiples only, so that
    // no u lies on the border between two octants.
    for (int i = 1; i < (1 << 20) / 4; i += 2) {
        const Real u = static_cast<Real>(i) * Real(0x1p-20);
        const SinCos<Real> here = sin_cos_turn(u);
        const SinCos<Real> later = sin_cos_turn(u + Real(0.25));
        const SinCos<Real> opposite = sin_cos_turn(u + Real(0.5));
        ASSERT_EQ(later.sine, here.cosine) << u;
        ASSERT_EQ(later.cosine, -here.sine) << u;
        ASSERT_EQ(opposite.sine, -here.sine) << u;
        ASSERT_EQ(opposite.cosine, -here.cosine) << u;
    }
}

TYPED_TEST(MathTest, ExponentialIsWithinOneUnit) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    const Real overflow = std::log(Limits::max()), underflow = std::log(Limits::denorm_min()) - 1;
    // fdlibm promises less than one unit. Half a unit is the last addition, which the scaling to a denormal number
    // rounds again, by half of the larger unit there; the rest is the polynomial and the reduction.
    const auto check = [](Real x) { ASSERT_LT(ulps(exponential(x), expl(static_cast<long double>(x))), 1.0L) << x; };
    test::Random random(11);
    for (int i = 0; i < 300000; ++i) {
        check(static_cast<Real>(random.uniform(underflow, 0)));
        check(static_cast<Real>(random.uniform(0, overflow)));
        check(static_cast<Real>(random.uniform(-1, 1)));
        check(static_cast<Real>(random.uniform(underflow, std::log(Limits::min()))));  // to denormal numbers
        check(std::ldexp(static_cast<Real>(random.uniform(-1, 1)), -static_cast<int>(random.word() % 1100)));
    }
    // These are the numbers at which the reduction turns to the next power of two: odd multiples of ln(2)/2.
    for (int k = Limits::min_exponent - Limits::digits; k < Limits::max_exponent; ++k) {
        const Real x = static_cast<Real>((k + 0.5L) * logl(2));
        check(std::nextafter(x, -Limits::infinity()));
        check(x);
        check(std::nextafter(x, Limits::infinity()));
    }
}

TYPED_TEST(MathTest, ExponentialKeepsItsLimits) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    EXPECT_EQ(exponential(Real(0)), Real(1));
    EXPECT_EQ(exponential(Real(-0.0)), Real(1));
    EXPECT_EQ(exponential(Limits::denorm_min()), Real(1));
    EXPECT_EQ(exponential(-Limits::denorm_min()), Real(1));
    EXPECT_EQ(exponential(-Limits::infinity()), Real(0));
    EXPECT_EQ(exponential(Limits::lowest()), Real(0));
    EXPECT_EQ(exponential(std::log(Limits::denorm_min()) - 1), Real(0));  // 1 / e of the smallest denormal number
    EXPECT_EQ(exponential(std::log(Limits::denorm_min())), Limits::denorm_min());
    EXPECT_EQ(exponential(Limits::infinity()), Limits::infinity());
    EXPECT_EQ(exponential(Limits::max()), Limits::infinity());
    EXPECT_EQ(exponential(std::log(Limits::max()) + Real(0.01)), Limits::infinity());
    EXPECT_TRUE(std::isnan(exponential(Limits::quiet_NaN())));
}

TYPED_TEST(MathTest, LogarithmIsWithinOneUnit) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    // fdlibm promises less than one unit: half of it is the last subtraction, the rest the terms before.
    const auto check = [](Real x) { ASSERT_LT(ulps(logarithm(x), logl(static_cast<long double>(x))), 1.0L) << x; };
    test::Random random(12);
    for (int i = 0; i < 300000; ++i) {
        check(static_cast<Real>(1 - random.uniform()));
        check(positive_unit_interval<Real>(random.word()));
        check(Real(1) + std::ldexp(static_cast<Real>(random.uniform(-0.5, 1)), -static_cast<int>(random.word() % 60)));
        const int exponents = Limits::max_exponent - Limits::min_exponent;
        check(std::ldexp(static_cast<Real>(random.uniform(1, 2)),
                         Limits::min_exponent - 1 + static_cast<int>(random.word() % exponents)));
        check(static_cast<Real>(1 - random.uniform()) * Limits::min());  // a denormal number, but for a few
    }
    // Powers of two, and where the reduction turns to the next one: sqrt(1/2) times a power of two.
    for (int k = Limits::min_exponent - Limits::digits; k < Limits::max_exponent; ++k) {
        for (const Real x : {std::ldexp(Real(1), k), std::ldexp(std::sqrt(Real(0.5)), k + 1)}) {
            check(std::nextafter(x, Limits::infinity()));
            check(x);
            check(std::max(Limits::denorm_min(), std::nextafter(x, Real(0))));
        }
    }
    check(Limits::max());
}

TYPED_TEST(MathTest, LogarithmKeepsItsLimits) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    EXPECT_EQ(logarithm(Real(1)), Real(0));
    EXPECT_FALSE(std::signbit(logarithm(Real(1))));
    EXPECT_EQ(logarithm(Real(0)), -Limits::infinity());
    EXPECT_EQ(logarithm(Real(-0.0)), -Limits::infinity());
    EXPECT_EQ(logarithm(Limits::infinity()), Limits::infinity());
    for (const Real x : {-Limits::denorm_min(), Real(-1), -Limits::infinity(), Limits::quiet_NaN()}) {
        EXPECT_TRUE(std::isnan(logarithm(x))) << x;
    }
}

// No neighbours in the wrong order within `steps` of x to either side.
template <class Real, class Function>
void expect_ascending(const Function& function, Real x, int steps) {
    for (int i = 0; i < steps; ++i) {
        x = std::nextafter(x, -std::numeric_limits<Real>::infinity());
    }
    for (int i = 0; i < 2 * steps; ++i) {
        const Real next = std::nextafter(x, std::numeric_limits<Real>::infinity());
        ASSERT_LE(function(x), function(next)) << x;
        x = next;
    }
}

TYPED_TEST(MathTest, ExponentialAndLogarithmAscend) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    constexpr int steps = 2000;
    const auto e = [](Real x) { return exponential(x); };
    const auto l = [](Real x) { return logarithm(x); };
    // A step would show first at 0 and 1, at the turns of both reductions, at the border to denormal numbers, and at
    // the ends of the range.
    const Real half_ln2 = std::log(Real(2)) / 2, root_half = std::sqrt(Real(0.5));
    for (const Real x : {Real(0), half_ln2, -half_ln2, 5 * half_ln2, -5 * half_ln2, -41 * half_ln2, Real(-1), Real(1),
                         std::log(Limits::min()), std::log(Limits::denorm_min()), std::log(Limits::max())}) {
        expect_ascending(e, x, steps);
    }
    for (const Real x : {Real(1), root_half, 2 * root_half, root_half / 1024, Real(0.5), Real(2), Limits::min(),
                         Limits::min() * root_half, Limits::denorm_min() * (steps + 1), Real(0x1p-33)}) {
        expect_ascending(l, x, steps);
    }
    test::Random random(13);
    for (int i = 0; i < 200; ++i) {
        expect_ascending(e, static_cast<Real>(random.uniform(-100, 0)), steps);
        expect_ascending(l, static_cast<Real>(random.uniform()), steps);
    }
}

template <class Real>
Real frame_error(const Vec3<Real>& n) {
    const Frame<Real> frame(n);
    const Vec3<Real> t = frame.tangent, b = frame.bitangent;
    Real worst = 0;
    for (const Real deviation :
         {dot(t, t) - 1, dot(b, b) - 1, dot(t, b), dot(t, n), dot(b, n), dot(cross(t, b), n) - 1}) {
        worst = std::max(worst, std::abs(deviation));
    }
    return worst;
}

TYPED_TEST(MathTest, FrameIsOrthonormalAndRightHanded) {
    using Real = TypeParam;
    // The normal itself is unit to 2 roundings; Duff et al. add a handful.
    const Real tolerance = 12 * std::numeric_limits<Real>::epsilon();
    test::Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const Real z = static_cast<Real>(random.uniform(-1, 1));
        const Real azimuth = static_cast<Real>(random.uniform(0, 6.283185307179586));
        const Real radius = std::sqrt(std::max(Real(0), (1 - z) * (1 + z)));
        ASSERT_LE(frame_error(normalize(Vec3<Real>{radius * std::cos(azimuth), radius * std::sin(azimuth), z})),
                  tolerance);
    }
    // Towards -z, where Frisvad's frame fails, and towards the switch at z = 0.
    for (int exponent = 0; exponent <= 140; ++exponent) {
        const Real x = std::ldexp(Real(1), -exponent);
        for (const Real sign : {Real(-1), Real(1)}) {
            EXPECT_LE(frame_error(normalize(Vec3<Real>{x, x * Real(0.5), sign})), tolerance) << exponent;
            EXPECT_LE(frame_error(normalize(Vec3<Real>{Real(0.75), Real(-0.5), sign * x})), tolerance) << exponent;
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const Real sign : {Real(-1), Real(1)}) {
            Vec3<Real> n(0);
            n[axis] = sign;
            EXPECT_EQ(frame_error(n), Real(0));
        }
    }
    EXPECT_EQ(frame_error(Vec3<Real>{1, 0, Real(-0.0)}), Real(0));
}

TYPED_TEST(MathTest, FrameMapsTheLocalZAxisToTheNormal) {
    using Real = TypeParam;
    const Vec3<Real> n = normalize(Vec3<Real>{1, -2, 3});
    EXPECT_EQ(Frame<Real>(n).to_world({0, 0, 1}), n);
}

TEST(MathTest, GammaBoundsThatManyRoundings) {
    EXPECT_EQ(unit_round_off<float>, std::numeric_limits<float>::epsilon() / 2);
    EXPECT_EQ(unit_round_off<double>, std::numeric_limits<double>::epsilon() / 2);
    EXPECT_GT(gamma<float>(3), 3 * unit_round_off<float>);
    EXPECT_LT(gamma<float>(3), 3.0001f * unit_round_off<float>);
}

TEST(MathTest, MinMaxClampFollowTheTernary) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(min(1.0f, 2.0f), 1.0f);
    EXPECT_EQ(max(1.0f, 2.0f), 2.0f);
    EXPECT_EQ(clamp(-3.0f, -1.0f, 1.0f), -1.0f);
    EXPECT_EQ(clamp(3.0f, -1.0f, 1.0f), 1.0f);
    EXPECT_EQ(min(nan, 2.0f), 2.0f);  // a comparison with NaN is false: the second operand
    EXPECT_EQ(max(nan, 2.0f), 2.0f);
}

// The tests' own chi-square, against values of the distribution from Abramowitz and Stegun, table 26.7 and the closed
// forms Q(1, x) = e^-x and Q(1/2, x) = erfc(sqrt x).
TEST(StatisticsTest, RegularisedGammaMatchesClosedForms) {
    for (const double x : {1e-6, 0.1, 0.9, 1.0, 1.9, 2.1, 5.0, 30.0, 200.0}) {
        EXPECT_NEAR(test::regularised_gamma_q(1, x) / std::exp(-x), 1, 1e-12) << x;
        EXPECT_NEAR(test::regularised_gamma_q(0.5, x) / std::erfc(std::sqrt(x)), 1, 1e-12) << x;
        EXPECT_NEAR(test::regularised_gamma_q(3, x) / (std::exp(-x) * (1 + x + x * x / 2)), 1, 1e-12) << x;
    }
    EXPECT_NEAR(test::chi_square_p_value(18.30704, 10), 0.05, 1e-7);
    EXPECT_NEAR(test::chi_square_p_value(149.44925, 100), 0.001, 1e-8);
    // A large number of degrees of freedom is near the normal distribution of Wilson and Hilferty.
    const double freedom = 4095, value = 4095 + 3 * std::sqrt(2.0 * 4095);
    const double z = (std::cbrt(value / freedom) - (1 - 2 / (9 * freedom))) / std::sqrt(2 / (9 * freedom));
    EXPECT_NEAR(test::chi_square_p_value(value, freedom), 0.5 * std::erfc(z / std::sqrt(2.0)), 1e-6);
}

TEST(StatisticsTest, ChiSquareTestAcceptsTheTruthAndRejectsALie) {
    test::Random random(7);
    std::vector<std::uint64_t> counts(64);
    for (int i = 0; i < 100000; ++i) {
        counts[static_cast<std::size_t>(64 * random.uniform())] += 1;
    }
    EXPECT_GT(test::chi_square_test(counts), test::chi_square_alpha);
    counts[3] += 400;  // 0.4 % of the draws, ten standard deviations of one cell
    EXPECT_LT(test::chi_square_test(counts), test::chi_square_alpha);
    EXPECT_EQ(test::chi_square_test({50, 50, 1}, {0.5, 0.5, 0.0}), 0);
}

TEST(StatisticsTest, MeanKnowsItsStandardError) {
    test::Mean mean;
    for (const double value : {1.0, 2.0, 3.0, 4.0}) {
        mean.add(value);
    }
    EXPECT_DOUBLE_EQ(mean.value(), 2.5);
    EXPECT_DOUBLE_EQ(mean.variance(), 5.0 / 3.0);
    EXPECT_DOUBLE_EQ(mean.standard_error(), std::sqrt(5.0 / 12.0));
}

}  // namespace
}  // namespace pt
