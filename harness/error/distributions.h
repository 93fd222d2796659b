// Tail probabilities and quantiles for statistical tests of images, in double precision. They keep their relative
// precision far out in the tails, where the levels of a test over thousands of pixels lie.
#pragma once

#include <cstdint>

namespace pt {

// Probability that a standard normal number is at least z.
double normal_upper(double z);
// The z with normal_upper(z) == p, for p in (0, 1), clamped to +-normal_deviate_limit.
double normal_deviate(double p);
inline constexpr double normal_deviate_limit = 37.5;

// Probability that a Student t variable with these degrees of freedom (> 0, not necessarily whole) is at least t.
double student_t_upper(double t, double degrees_of_freedom);
// The t with student_t_upper(t) == p, for p in (0, 1/2].
double student_t_deviate(double p, double degrees_of_freedom);

// Probability that a chi-square variable with these degrees of freedom is at least x.
double chi_square_upper(double x, double degrees_of_freedom);

// Regularised incomplete beta function I_x(a, b); `complement` is 1 - x, which the caller may know more precisely.
double regularised_beta(double a, double b, double x, double complement);

// Two-sided p-value of `successes` in `trials` under a probability of one half (exact binomial test).
double fair_coin(std::uint64_t successes, std::uint64_t trials);

// The p-value of the smallest of `count` p-values (Sidak 1967). Exact for independent tests, and conservative for
// two-sided tests of correlated normal variables.
double sidak(double p, double count);

}  // namespace pt
