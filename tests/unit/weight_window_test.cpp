// The arithmetic of roulette and splitting by what a path is expected to bring: the window, the bounds on it, where a
// vertex lies in the grid.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "kernels/path_tree.h"

namespace pt {
namespace {

template <class Real>
class WeightWindowTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(WeightWindowTest, Reals);

TYPED_TEST(WeightWindowTest, BelowItAPathComesToItsLowerBound) {
    using Real = TypeParam;
    const Real lowest = Real(0.5);
    const Vec3<Real> carried(Real(0.25));
    EXPECT_EQ(survival_probability(Real(0.125), lowest, carried), Real(0.25));
    EXPECT_EQ(survival_probability(Real(0.5), lowest, carried), Real(1));
    EXPECT_EQ(survival_probability(Real(7), lowest, carried), Real(1));
    Path<Real> path{};
    path.throughput = {Real(0.25), Real(0.5), Real(0.125)};
    EXPECT_FALSE(survives_by_share(path, Real(0.125), lowest, Real(0.25)));
    EXPECT_TRUE(survives_by_share(path, Real(0.125), lowest, Real(0.2499)));
    EXPECT_EQ(path.throughput, Vec3<Real>(1, 2, Real(0.5)));
    // Within the window nothing happens, whatever the number.
    EXPECT_TRUE(survives_by_share(path, Real(0.5), lowest, Real(0.9999)));
    EXPECT_EQ(path.throughput, Vec3<Real>(1, 2, Real(0.5)));
}

TYPED_TEST(WeightWindowTest, SurvivalHasBounds) {
    using Real = TypeParam;
    const Vec3<Real> little(Real(0x1p-10));
    EXPECT_EQ(survival_probability(Real(0), Real(1), little), least_survival<Real>);
    EXPECT_EQ(survival_probability(Real(0), Real(1), Vec3<Real>(0, 32, 1)), Real(0.5));
    EXPECT_EQ(survival_probability(Real(0), Real(1), Vec3<Real>(0, 64, 1)), Real(1));
    EXPECT_EQ(survival_probability(Real(0), Real(1), Vec3<Real>(0, 100, 1)), Real(1));
    // A number that is none ends no path.
    EXPECT_EQ(survival_probability(std::numeric_limits<Real>::quiet_NaN(), Real(1), little), Real(1));
}

// However small the estimates are, a path that is not ended does not come to carry more than the film has room for.
TYPED_TEST(WeightWindowTest, NoPathCarriesMoreThanItsBound) {
    using Real = TypeParam;
    Path<Real> path{};
    path.throughput = Vec3<Real>(Real(0.75), Real(0.5), Real(0));
    for (int vertex = 0; vertex < 100; ++vertex) {
        ASSERT_TRUE(survives_by_share(path, Real(0), Real(1), Real(0)));
        // The throughput may be above the bound by two roundings.
        ASSERT_LE(path.throughput.x, most_carried<Real> * (Real(1) + gamma<Real>(2)));
    }
    EXPECT_GT(path.throughput.x, most_carried<Real> / 2);
}

TYPED_TEST(WeightWindowTest, AboveItAPathSplits) {
    using Real = TypeParam;
    EXPECT_EQ(branch_count(Real(0), Real(2), 8), 1u);
    EXPECT_EQ(branch_count(Real(2), Real(2), 8), 1u);
    EXPECT_EQ(branch_count(Real(2.5), Real(2), 8), 2u);
    EXPECT_EQ(branch_count(Real(7), Real(2), 8), 4u);
    EXPECT_EQ(branch_count(Real(1e30), Real(2), 8), 8u);
    EXPECT_EQ(branch_count(Real(1e30), Real(2), 1), 1u);
    EXPECT_EQ(branch_count(std::numeric_limits<Real>::quiet_NaN(), Real(2), 8), 1u);
    EXPECT_EQ(branch_count(std::numeric_limits<Real>::infinity(), Real(2), 8), 8u);
}

TYPED_TEST(WeightWindowTest, EveryPointHasACell) {
    using Real = TypeParam;
    EXPECT_EQ(cell_along(Real(-1), 4), 0u);
    EXPECT_EQ(cell_along(Real(0.99), 4), 0u);
    EXPECT_EQ(cell_along(Real(1), 4), 1u);
    EXPECT_EQ(cell_along(Real(3.99), 4), 3u);
    EXPECT_EQ(cell_along(Real(1e30), 4), 3u);
    EXPECT_EQ(cell_along(std::numeric_limits<Real>::infinity(), 4), 3u);
    EXPECT_EQ(cell_along(std::numeric_limits<Real>::quiet_NaN(), 4), 0u);
    AdjointCache<Real> cache{};
    cache.cells = 4;
    cache.low = {-1, -2, -3};
    cache.cells_a_unit = {2, 1, Real(0.5)};
    const Vec3<Real> up{0, 1, 0};
    EXPECT_EQ(adjoint_place(cache, {Real(0.25), Real(1.5), Real(2)}, up), ((2u * 4 + 2) * 4 + 3) * 4 + 2);
    EXPECT_EQ(adjoint_place(cache, {-9, 9, 9}, -up), ((3u * 4 + 3) * 4 + 3) * 4 + 0);
}

TYPED_TEST(WeightWindowTest, ASideIsTheNearestAxis) {
    using Real = TypeParam;
    EXPECT_EQ(nearest_side(Vec3<Real>(1, 0, 0)), 0u);
    EXPECT_EQ(nearest_side(Vec3<Real>(Real(-0.8), Real(0.6), 0)), 1u);
    EXPECT_EQ(nearest_side(Vec3<Real>(Real(-0.6), Real(0.8), 0)), 2u);
    EXPECT_EQ(nearest_side(Vec3<Real>(0, -1, 0)), 3u);
    EXPECT_EQ(nearest_side(Vec3<Real>(Real(0.1), Real(0.1), Real(0.98))), 4u);
    EXPECT_EQ(nearest_side(Vec3<Real>(0, Real(0.6), Real(-0.8))), 5u);
}

// Segments and the branch's number share a word; the longest path that a scene file may ask for, and a final bounce,
// leave the number alone.
TYPED_TEST(WeightWindowTest, SegmentsAndBranchShareAWord) {
    using Splitting = Config<TypeParam, set_of(Feature::splitting)>;
    using Plain = Config<TypeParam, no_features>;
    Path<TypeParam> path{};
    path.segment = 1000001;
    EXPECT_EQ(segments_of<Splitting>(path), 1000001u);
    path.segment |= (most_branches_of_tree - 1) << segment_bits;
    EXPECT_EQ(segments_of<Splitting>(path), 1000001u);
    EXPECT_EQ(path.segment >> segment_bits, most_branches_of_tree - 1);
    EXPECT_EQ(segments_of<Plain>(path), path.segment);
}

}  // namespace
}  // namespace pt
