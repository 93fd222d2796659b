// What rough conductors that scatter multiply give back: the fit against quadrature, and the furnace.
#include "kernels/ggx_gain.h"

#include <limits>

#include <gtest/gtest.h>

#include "kernels/materials/rough_conductor.h"
#include "tests/support/ggx_textbook.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using namespace test::ggx;

template <class Real>
class GgxGainTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(GgxGainTest, Reals);

constexpr double fit = 2.5e-3;  // as the header says

TYPED_TEST(GgxGainTest, TheFitIsTheDirectionalAlbedos) {
    using Real = TypeParam;
    for (const double alpha : {1e-4, 0.003, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0}) {
        for (const double x : {0.001, 0.01, 0.05, 0.15, 0.3, 0.5, 0.7, 0.85, 0.95, 0.99, 1.0}) {
            const double cosine = std::min(1.0, x * alpha / std::sqrt(1 - x * x * (1 - alpha * alpha)));
            const double gain = static_cast<double>(ggx_gain(static_cast<Real>(x), static_cast<Real>(alpha)));
            // 5e-4 is the error of the quadrature in kept_energy.
            EXPECT_NEAR((1 + gain) * kept_energy(alpha, cosine, 384), 1, fit + 5e-4) << alpha << " " << x;
        }
    }
}

TYPED_TEST(GgxGainTest, AMirrorGainsNothing) {
    using Real = TypeParam;
    EXPECT_EQ(ggx_gain(Real(1), Real(0)), Real(0));
    for (double alpha = 1; alpha > 1e-20; alpha /= 2) {
        for (double x = 1; x > 1e-20; x /= 2) {
            const Real gain = ggx_gain(static_cast<Real>(x), static_cast<Real>(alpha));
            ASSERT_GE(gain, Real(0));
            ASSERT_LE(gain, Real(2.3));
        }
    }
}

template <class Real>
RoughConductor<Real, true> lobe_of(const Vec3<Real>& reflectance, double roughness, double cosine) {
    RoughConductor<Real, true> lobe(reflectance, static_cast<Real>(roughness * roughness),
                                    Vec3<Real>(direction_at(cosine, 0.7)), {Real(0), Real(0), Real(1)});
    lobe.scatter_multiply();
    return lobe;
}

TYPED_TEST(GgxGainTest, AWhiteFurnaceStaysWhite) {
    using Real = TypeParam;
    constexpr int side = 256;
    for (const double roughness : {1e-4, 0.05, 0.25, 0.5, 0.75, 0.9, 1.0}) {
        for (const double cosine : {1.0, 0.9, 0.5, 0.1, 0.01}) {
            const RoughConductor<Real, true> lobe = lobe_of(Vec3<Real>(Real(1)), roughness, cosine);
            test::Random random(1);
            const double kept = mean_over_square(side, [&](double u, double v) {
                const LobeSample<Real> sample = lobe.sample(static_cast<Real>(u + random.uniform(-0.5, 0.5) / side),
                                                            static_cast<Real>(v + random.uniform(-0.5, 0.5) / side));
                return sample.cosine > 0 ? static_cast<double>(sample.value.weight.x) : 0.0;
            });
            EXPECT_NEAR(kept, 1, fit + 5e-4) << roughness << " " << cosine;
        }
    }
}

// The more of it the more a facet reflects of what another sends it; and connections weigh as samples do.
TYPED_TEST(GgxGainTest, ColoursGainByTheirReflectance) {
    using Real = TypeParam;
    const Vec3<Real> copper{Real(1), Real(0.5), Real(0)};
    const RoughConductor<Real, true> lobe = lobe_of(copper, 0.9, 0.6);
    const RoughConductor<Real> once(copper, lobe.facets.alpha, lobe.facets.outgoing, lobe.facets.normal);
    const Real gain = ggx_gain(lobe.facets.cosine / lobe.facets.q, lobe.facets.alpha);
    EXPECT_GT(gain, Real(0.5));
    test::Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Real u = static_cast<Real>(random.uniform()), v = static_cast<Real>(random.uniform());
        const LobeSample<Real> sample = lobe.sample(u, v);
        if (sample.cosine < Real(0.01)) {
            continue;
        }
        const LobeSample<Real> lossy = once.sample(u, v);
        ASSERT_EQ(sample.direction, lossy.direction);
        ASSERT_EQ(sample.value.pdf, lossy.value.pdf);
        ASSERT_EQ(sample.value.weight, lossy.value.weight * (Vec3<Real>(Real(1)) + copper * gain));
        const Vec3<Real> towards = lobe.towards(sample.direction, sample.cosine).weight;
        ASSERT_NEAR(towards.y, sample.value.weight.y, 1e4 * std::numeric_limits<Real>::epsilon());
    }
}

}  // namespace
}  // namespace pt
