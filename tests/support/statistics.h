// Statistics for tests: means with their standard errors, chi-square with its p-value, and a seeded number source.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace pt::test {

// A seeded stream of numbers, the same everywhere. SplitMix64: Steele, Lea and Flood, OOPSLA 2014.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    std::uint32_t word() { return static_cast<std::uint32_t>(bits() >> 32); }
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }

private:
    std::uint64_t state_;
};

// Mean and its standard error, estimated from the values (Welford 1962).
class Mean {
public:
    void add(double value) {
        count_ += 1;
        const double delta = value - mean_;
        mean_ += delta / static_cast<double>(count_);
        squares_ += delta * (value - mean_);
    }
    std::uint64_t count() const { return count_; }
    double value() const { return mean_; }
    double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
    double standard_error() const { return count_ > 1 ? std::sqrt(variance() / static_cast<double>(count_)) : 0; }

private:
    std::uint64_t count_ = 0;
    double mean_ = 0, squares_ = 0;
};

// Upper regularised incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a).
double regularised_gamma_q(double a, double x);

// Probability of a chi-square at least this large with so many degrees of freedom.
double chi_square_p_value(double chi_square, double degrees_of_freedom);

// Pearson's test of counts against probabilities (which sum to 1); cells that expect less than 5 are pooled.
double chi_square_test(const std::vector<std::uint64_t>& counts, const std::vector<double>& probabilities);
// The p-value of a chi-square test for cells of equal probability.
double chi_square_test(const std::vector<std::uint64_t>& counts);

// Two-sided p-value below which a chi-square test fails. With some 80 such tests in the suite, chance alone would fail
// one in 160 choices of the seeds; the seeds are fixed.
inline constexpr double chi_square_alpha = 1e-4;

// How many standard errors a mean may lie from its exact value.
inline constexpr double tolerated_errors = 4.5;

}  // namespace pt::test
