// Tails and quantiles against values of SciPy 1.15 (scipy.stats, scipy.special), far out too.
#include "harness/error/distributions.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pt {
namespace {

// Relative; a tail of 1e-300 has to be right as well.
void expect_close(double value, double expected, double tolerance = 1e-12) {
    EXPECT_LE(std::abs(value - expected), tolerance * std::abs(expected)) << value << " instead of " << expected;
}

TEST(DistributionsTest, NormalTail) {
    EXPECT_EQ(normal_upper(0), 0.5);
    expect_close(normal_upper(1), 0.15865525393145707);
    expect_close(normal_upper(-1.5), 0.9331927987311419);
    expect_close(normal_upper(5), 2.866515718791933e-07);
    expect_close(normal_upper(-8), 0.9999999999999993);
    expect_close(normal_upper(20), 2.7536241186061556e-89);
    expect_close(normal_upper(37), 5.7255712225239266e-300);
}

TEST(DistributionsTest, NormalQuantile) {
    EXPECT_NEAR(normal_deviate(0.5), 0, 1e-15);
    expect_close(normal_deviate(0.3), 0.5244005127080409);
    expect_close(normal_deviate(0.975), -1.959963984540054);
    expect_close(normal_deviate(1e-3), 3.090232306167813);
    expect_close(normal_deviate(6.5e-8), 5.278846003592598);
    expect_close(normal_deviate(1e-100), 21.273453560965322);
    expect_close(normal_deviate(1e-300), 37.0470962993612);
    EXPECT_EQ(normal_deviate(0), normal_deviate_limit);
    EXPECT_EQ(normal_deviate(1), -normal_deviate_limit);
}

TEST(DistributionsTest, StudentTail) {
    EXPECT_EQ(student_t_upper(0, 3), 0.5);
    expect_close(student_t_upper(2.5, 15), 0.012252901623256915);
    expect_close(student_t_upper(-1.2, 15), 0.8756251063059888);
    expect_close(student_t_upper(9, 15), 9.807357125879558e-08);
    expect_close(student_t_upper(30, 7.3), 3.2444026595639765e-09);
    expect_close(student_t_upper(1e-3, 1), 0.4996816902199194);
    expect_close(student_t_upper(1000, 2.5), 2.2747463948307502e-08);
    expect_close(student_t_upper(12, 30), 2.7900927075996303e-13);
    expect_close(student_t_upper(4, 1e6), 3.1673517005023895e-05, 1e-8);  // logarithms of gamma functions cancel
    EXPECT_EQ(student_t_upper(INFINITY, 15), 0);
    EXPECT_EQ(student_t_upper(-INFINITY, 15), 1);
}

TEST(DistributionsTest, StudentQuantile) {
    expect_close(student_t_deviate(0.025, 15), 2.131449545559323);
    EXPECT_NEAR(student_t_deviate(0.5, 4), 0, 1e-15);
    expect_close(student_t_deviate(1e-8, 15), 10.714732022798797);
    // At this deviate scipy.stats.t.sf is 1e-12; t.isf itself is off by 2e-11 here.
    expect_close(student_t_deviate(1e-12, 2.5), 55306.174076515817);
    expect_close(student_t_deviate(1e-4, 30), 4.23398595727202);
    expect_close(student_t_deviate(0.01, 1e6), 2.3263516031208056, 1e-8);
}

TEST(DistributionsTest, ChiSquareTail) {
    EXPECT_EQ(chi_square_upper(0, 5), 1);
    EXPECT_EQ(chi_square_upper(-3, 5), 1);
    EXPECT_EQ(chi_square_upper(INFINITY, 5), 0);
    expect_close(chi_square_upper(0.3, 1), 0.583882420770365);
    expect_close(chi_square_upper(12, 1), 0.0005320055051392492);
    expect_close(chi_square_upper(1, 7.5), 0.9969690906883704);
    expect_close(chi_square_upper(60, 7.5), 2.677921323876724e-10);
    // On both sides of where the formula for large degrees of freedom begins.
    expect_close(chi_square_upper(32, 31), 0.41674402994554294);
    expect_close(chi_square_upper(33, 32), 0.4180195006078761);
    expect_close(chi_square_upper(100, 40), 4.791357300338064e-07);
    expect_close(chi_square_upper(1100, 1024), 0.04904492609210413);
    expect_close(chi_square_upper(1400, 1024), 3.712608863558748e-14);
    expect_close(chi_square_upper(800, 1024), 0.9999999560516534);
    expect_close(chi_square_upper(3.02e6, 3e6), 1.8627960868160166e-16, 1e-9);
    expect_close(chi_square_upper(2.98e6, 3e6), 0.9999999999999999);
}

TEST(DistributionsTest, IncompleteBeta) {
    EXPECT_EQ(regularised_beta(2, 3, 0, 1), 0);
    EXPECT_EQ(regularised_beta(2, 3, 1, 0), 1);
    expect_close(regularised_beta(0.5, 0.5, 0.1, 0.9), 0.20483276469913345);
    expect_close(regularised_beta(2, 3, 0.7, 0.3), 0.9163);
    expect_close(regularised_beta(500, 0.5, 0.99, 0.01), 0.0015273578790529904);
    expect_close(regularised_beta(30, 700, 0.001, 0.999), 7.973230254157165e-38, 1e-11);
}

TEST(DistributionsTest, FairCoin) {
    EXPECT_EQ(fair_coin(0, 0), 1);
    EXPECT_EQ(fair_coin(5, 10), 1);
    expect_close(fair_coin(3, 20), 0.0025768280029296875);
    expect_close(fair_coin(17, 20), 0.0025768280029296875);
    expect_close(fair_coin(20, 20), 1.9073486328125e-06);
    expect_close(fair_coin(7, 7), 0.015625);
    expect_close(fair_coin(120, 200), 0.005685155996750306);
    expect_close(fair_coin(30100, 60000), 0.41655427944466006, 1e-9);
}

TEST(DistributionsTest, Sidak) {
    EXPECT_EQ(sidak(0, 7), 0);
    EXPECT_EQ(sidak(1, 7), 1);
    expect_close(sidak(0.5, 3), 0.875);
    expect_close(sidak(1e-3, 5), 0.004990009995001);
    expect_close(sidak(1e-10, 3072), 3.071999528294448e-07);
}

}  // namespace
}  // namespace pt
