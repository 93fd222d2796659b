#include "harness/error/distributions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pt {

namespace {

constexpr int most_terms = 1000000;
constexpr double tiny = 1e-290;  // replaces a denominator of 0, since Lentz's algorithm divides by denominators

// Evaluates a continued fraction b0 + a1/(b1 + a2/(b2 + ...)) from the front (Lentz 1976).
class Lentz {
public:
    explicit Lentz(double b0) : value_(b0 == 0 ? tiny : b0), c_(value_) {}
    // Adds the next term, a/(b + ...), to the continued fraction, and returns the relative change of its value.
    double add(double a, double b) {
        d_ = b + a * d_;
        d_ = 1 / (d_ == 0 ? tiny : d_);
        c_ = b + a / c_;
        c_ = c_ == 0 ? tiny : c_;
        value_ *= c_ * d_;
        return std::abs(c_ * d_ - 1);
    }
    double value() const { return value_; }

private:
    double value_, c_, d_ = 0;
};

constexpr double converged = 4e-16;

// The difference between lgamma(a) and Stirling's formula for it, for a >= 16.
double stirling_rest(double a) {
    const double square = a * a;
    return (1.0 / 12 - (1.0 / 360 - (1.0 / 1260 - 1.0 / 1680 / square) / square) / square) / a;
}

// The factor x^a e^-x / Gamma(a) of the incomplete gamma functions. For large `a` it is computed relative to its
// maximum, because the logarithms of its factors would be huge and cancel.
double gamma_front(double a, double x) {
    if (a < 16) {
        return std::exp(a * std::log(x) - x - std::lgamma(a));
    }
    const double from_mode = (x - a) / a;
    return std::exp(-a * (from_mode - std::log1p(from_mode)) - stirling_rest(a)) *
           std::sqrt(a / (2 * std::numbers::pi));
}

// The lower incomplete gamma function by its series, for x < a + 1.
double lower_gamma(double a, double x) {
    double term = 1 / a;
    double sum = term;
    for (int n = 1; n < most_terms && term > sum * converged; ++n) {
        term *= x / (a + n);
        sum += term;
    }
    return sum * gamma_front(a, x);
}

// The upper incomplete gamma function by its continued fraction, for x >= a + 1.
double upper_gamma(double a, double x) {
    Lentz fraction(x + 1 - a);
    for (int n = 1; n < most_terms && fraction.add(-n * (n - a), x + 1 - a + 2 * n) > converged; ++n) {
    }
    return gamma_front(a, x) / fraction.value();
}

// The factor x^a (1-x)^b / (a B(a, b)), which multiplies the continued fraction of the beta function I_x(a, b).
double beta_front(double a, double b, double x, double complement) {
    const double log_beta = std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
    return std::exp(a * std::log(x) + b * std::log(complement) - log_beta) / a;
}

// The beta function I_x(a, b) by its continued fraction (Abramowitz and Stegun 26.5.8), for x < (a + 1) / (a + b + 2).
double beta_by_fraction(double a, double b, double x, double complement) {
    Lentz fraction(1);
    for (int m = 0; m < most_terms; ++m) {
        fraction.add(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)), 1);
        const double k = m + 1;
        if (fraction.add(k * (b - k) * x / ((a + 2 * k - 1) * (a + 2 * k)), 1) <= converged) {
            break;
        }
    }
    return beta_front(a, b, x, complement) / fraction.value();
}

// Finds by bisection the argument in [low, high] at which a decreasing function has `value`.
template <class Function>
double where_falling(Function function, double value, double low, double high) {
    for (int i = 0; i < 200 && high - low > 1e-15 * std::max(std::abs(low), std::abs(high)); ++i) {
        const double middle = 0.5 * (low + high);
        (function(middle) > value ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

double normal_upper(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

// Inverse of normal_upper: Newton's method on the logarithm of the tail, whose steps do not leave its domain, from the
// approximation 26.2.23 of Abramowitz and Stegun (4.5e-4).
double normal_deviate(double p) {
    if (p > 0.5) {
        return -normal_deviate(1 - p);
    }
    if (!(p > normal_upper(normal_deviate_limit))) {
        return normal_deviate_limit;
    }
    const double log_p = std::log(p);
    const double t = std::sqrt(-2 * log_p);
    double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    for (int i = 0; i < 3; ++i) {
        const double tail = normal_upper(z);
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        z += (std::log(tail) - log_p) * tail / density;
    }
    return z;
}

double regularised_beta(double a, double b, double x, double complement) {
    if (x <= 0) {
        return 0;
    }
    if (complement <= 0) {
        return 1;
    }
    return x < (a + 1) / (a + b + 2) ? beta_by_fraction(a, b, x, complement)
                                     : 1 - beta_by_fraction(b, a, complement, x);
}

double student_t_upper(double t, double degrees_of_freedom) {
    const double ratio = t * t / degrees_of_freedom;
    const double x = 1 / (1 + ratio);
    const double complement = std::isinf(ratio) ? 1 : ratio / (1 + ratio);
    const double beyond = 0.5 * regularised_beta(0.5 * degrees_of_freedom, 0.5, x, complement);
    return t >= 0 ? beyond : 1 - beyond;
}

double student_t_deviate(double p, double degrees_of_freedom) {
    double high = 1;
    while (high < 1e150 && student_t_upper(high, degrees_of_freedom) > p) {
        high *= 2;
    }
    return where_falling([&](double t) { return student_t_upper(t, degrees_of_freedom); }, p, 0, high);
}

double chi_square_upper(double x, double degrees_of_freedom) {
    const double a = 0.5 * degrees_of_freedom;
    const double half = 0.5 * x;
    if (half <= 0) {
        return 1;
    }
    if (std::isinf(half)) {
        return 0;
    }
    return half < a + 1 ? 1 - lower_gamma(a, half) : upper_gamma(a, half);
}

// The binomial tail is a beta function: P(at least k of n) = I_p(k, n - k + 1).
double fair_coin(std::uint64_t successes, std::uint64_t trials) {
    const std::uint64_t most = std::max(successes, trials - successes);
    if (trials == 0) {
        return 1;
    }
    const double k = static_cast<double>(most);
    return std::min(1.0, 2 * regularised_beta(k, static_cast<double>(trials) - k + 1, 0.5, 0.5));
}

double sidak(double p, double count) { return p >= 1 ? 1 : -std::expm1(count * std::log1p(-p)); }

}  // namespace pt
