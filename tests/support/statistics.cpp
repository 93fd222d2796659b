#include "tests/support/statistics.h"

#include <limits>

namespace pt::test {

namespace {

// x times the density at x of the gamma distribution of shape a: x^a e^-x / Gamma(a).
double gamma_density_times_x(double a, double x) { return std::exp(a * std::log(x) - x - std::lgamma(a)); }

// Lower regularised incomplete gamma function, 1 - Q(a, x), by its series; it converges fast for x < a + 1.
double lower_by_series(double a, double x) {
    double term = 1 / a;
    double sum = term;
    for (int n = 1; n < 100000 && term > sum * 1e-16; ++n) {
        term *= x / (a + n);
        sum += term;
    }
    return sum * gamma_density_times_x(a, x);
}

// Continued fraction for the upper function, by Lentz's method; converges fast for x >= a + 1.
double upper_by_fraction(double a, double x) {
    const double tiny = std::numeric_limits<double>::min() * 1e16;
    double b = x + 1 - a;
    double c = 1 / tiny;
    double d = 1 / b;
    double fraction = d;
    for (int n = 1; n < 100000; ++n) {
        const double numerator = -n * (n - a);
        b += 2;
        d = numerator * d + b;
        d = 1 / (std::abs(d) < tiny ? tiny : d);
        c = b + numerator / c;
        c = std::abs(c) < tiny ? tiny : c;
        fraction *= d * c;
        if (std::abs(d * c - 1) < 1e-15) {
            break;
        }
    }
    return fraction * gamma_density_times_x(a, x);
}

}  // namespace

double regularised_gamma_q(double a, double x) {
    if (x <= 0) {
        return 1;
    }
    return x < a + 1 ? 1 - lower_by_series(a, x) : upper_by_fraction(a, x);
}

double chi_square_p_value(double chi_square, double degrees_of_freedom) {
    return regularised_gamma_q(0.5 * degrees_of_freedom, 0.5 * chi_square);
}

double chi_square_test(const std::vector<std::uint64_t>& counts, const std::vector<double>& probabilities) {
    double total = 0;
    for (const std::uint64_t count : counts) {
        total += static_cast<double>(count);
    }
    double chi_square = 0;
    double pooled_count = 0, pooled_expected = 0;
    int cells = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        pooled_count += static_cast<double>(counts[i]);
        pooled_expected += total * probabilities[i];
        if (pooled_expected >= 5) {
            chi_square += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
            pooled_count = pooled_expected = 0;
            ++cells;
        }
    }
    if (pooled_count > 0 && pooled_expected <= 0) {
        return 0;  // something fell where nothing may fall
    }
    if (pooled_expected > 0) {
        chi_square += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
        ++cells;
    }
    return chi_square_p_value(chi_square, cells - 1);
}

double chi_square_test(const std::vector<std::uint64_t>& counts) {
    return chi_square_test(counts, std::vector<double>(counts.size(), 1.0 / static_cast<double>(counts.size())));
}

}  // namespace pt::test
