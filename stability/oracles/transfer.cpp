#include "stability/oracles/transfer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace pt::stability {

namespace {

constexpr long double euler_gamma = 0.577215664901532860606512090082402431L;

// The exponential integral E_n by its power series, whose term n - 1 has the logarithm.
long double series(int n, long double x) {
    long double digamma = -euler_gamma;
    for (int i = 1; i < n; ++i) {
        digamma += 1.0L / i;
    }
    long double sum = 0, power = 1;  // `power` is (-x)^m / m!, a factor of the series' term m
    for (int m = 0; m < 200; ++m) {
        const long double term = m == n - 1 ? power * (digamma - std::log(x)) : -power / (m - n + 1);
        sum += term;
        if (m >= n && std::abs(term) < 1e-21L * std::abs(sum)) {
            break;
        }
        power *= -x / (m + 1);
    }
    return sum;
}

// The exponential integral E_n by its continued fraction, evaluated from the far end.
long double continued_fraction(int n, long double x) {
    long double tail = x;
    for (int m = 200; m >= 1; --m) {
        tail = x + (n + m - 1) / (1 + m / tail);
    }
    return std::exp(-x) / tail;
}

}  // namespace

long double exponential_integral(int n, long double x) {
    if (x == 0) {
        return n > 1 ? 1.0L / (n - 1) : HUGE_VALL;
    }
    return x < 1.5L ? series(n, x) : continued_fraction(n, x);
}

HFunction::HFunction(double albedo) : albedo_(albedo), nodes_(gauss_legendre(96)) {
    // H(mu) behaves like mu ln(mu) at 0, and the substitution mu = t^4 smooths it for quadrature.
    for (Node& node : nodes_) {
        const long double t = node.x;
        node = {t * t * t * t, node.weight * 4 * t * t * t};
    }
    values_.assign(nodes_.size(), 1);
    const long double root = std::sqrt(1 - albedo_);
    for (int step = 0; step < 4000; ++step) {
        long double change = 0;
        std::vector<long double> next(nodes_.size());
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            long double sum = 0;
            for (std::size_t j = 0; j < nodes_.size(); ++j) {
                sum += nodes_[j].weight * nodes_[j].x * values_[j] / (nodes_[i].x + nodes_[j].x);
            }
            // Successive iterates lie on both sides of H, so their mean converges several times as fast.
            next[i] = (values_[i] + 1 / (root + albedo_ / 2 * sum)) / 2;
            change = std::max(change, std::abs(next[i] - values_[i]) / next[i]);
        }
        values_ = std::move(next);
        if (change < 1e-16L) {
            break;
        }
    }
}

double HFunction::at(double mu) const {
    long double sum = 0;
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
        sum += mu > 0 ? nodes_[j].weight * nodes_[j].x * values_[j] / (mu + nodes_[j].x) : 0;
    }
    return mu > 0 ? static_cast<double>(1 / (std::sqrt(1 - albedo_) + albedo_ / 2 * sum)) : 1;
}

double HFunction::plane_albedo(double mu) const {
    return static_cast<double>(1 - std::sqrt(1 - albedo_) * static_cast<long double>(at(mu)));
}

double HFunction::diffuse_albedo() const {
    long double moment = 0;
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
        moment += nodes_[j].weight * nodes_[j].x * values_[j];
    }
    return static_cast<double>(1 - 2 * std::sqrt(1 - albedo_) * moment);
}

double mean_collisions(double albedo, double mu) {
    const double step = 1e-3 * (1 - albedo);
    const HFunction low(albedo - step), high(albedo + step);
    const double below = mu > 0 ? low.plane_albedo(mu) : low.diffuse_albedo();
    const double above = mu > 0 ? high.plane_albedo(mu) : high.diffuse_albedo();
    return albedo * (std::log(above) - std::log(below)) / (2 * step);
}

namespace {

// Cell borders of a slab, denser towards both faces; a smooth function of the index, as Romberg extrapolation needs.
std::vector<long double> cell_borders(long double depth, int cells) {
    std::vector<long double> borders;
    for (int i = 0; i <= cells; ++i) {
        const long double t = static_cast<long double>(i) / cells;
        borders.push_back(depth * t * t * t * (10 - t * (15 - 6 * t)));
    }
    return borders;
}

// Solves A x = b for a symmetric positive definite A by Cholesky's method.
std::vector<long double> solve(std::vector<std::vector<long double>> a, std::vector<long double> b) {
    const std::size_t n = b.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            long double sum = a[i][j];
            for (std::size_t k = 0; k < j; ++k) {
                sum -= a[i][k] * a[j][k];
            }
            a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    return b;
}

// The share of photons that cross an optical depth x without a collision: at cosine mu or, for mu = 0, of diffuse
// light. It gives the density of first collisions in a slab, and the light that crosses the slab unscattered.
long double uncollided(long double x, double mu) { return mu > 0 ? std::exp(-x / mu) : 2 * exponential_integral(3, x); }

SlabShares galerkin(double optical_depth, double albedo, double mu, int cells) {
    const std::vector<long double> x = cell_borders(optical_depth, cells);
    const auto n = static_cast<std::size_t>(cells);
    std::vector<std::vector<long double>> third(n + 1, std::vector<long double>(n + 1));  // E3 of cell border distances
    for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            third[i][j] = third[j][i] = exponential_integral(3, x[i] - x[j]);
        }
    }
    // Galerkin's matrix has the integrals of w/2 E1(|x-y|) over cells i and j: second differences of E3, as E3'' = E1.
    std::vector<std::vector<long double>> matrix(n, std::vector<long double>(n));
    std::vector<long double> source(n);
    const long double w = albedo;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            const long double twice = third[i + 1][j] + third[i][j + 1] - third[i][j] - third[i + 1][j + 1];
            const long double width = x[i + 1] - x[i];
            matrix[i][j] = i == j ? width - w / 2 * (2 * width + twice) : -w / 2 * twice;
        }
        source[i] = uncollided(x[i], mu) - uncollided(x[i + 1], mu);
    }
    const std::vector<long double> density = solve(std::move(matrix), std::move(source));
    long double reflected = 0, transmitted = uncollided(optical_depth, mu);
    for (std::size_t i = 0; i < n; ++i) {
        reflected += w / 2 * density[i] * (third[i][0] - third[i + 1][0]);
        transmitted += w / 2 * density[i] * (third[n][i + 1] - third[n][i]);
    }
    return {static_cast<double>(reflected), static_cast<double>(transmitted), 0};
}

}  // namespace

SlabShares slab_shares(double optical_depth, double albedo, double mu) {
    static std::map<std::tuple<double, double, double>, SlabShares> known;
    const std::tuple key(optical_depth, albedo, mu);
    if (const auto found = known.find(key); found != known.end()) {
        return found->second;
    }
    // Romberg's table: errors are a series in even powers of the cell width.
    std::vector<SlabShares> row;
    double correction = 0;
    for (const int cells : {48, 96, 192, 384}) {
        SlabShares next = galerkin(optical_depth, albedo, mu, cells);
        double power = 4;
        for (SlabShares& previous : row) {
            const SlabShares better{next.reflected + (next.reflected - previous.reflected) / (power - 1),
                                    next.transmitted + (next.transmitted - previous.transmitted) / (power - 1), 0};
            correction =
                std::max(std::abs(better.reflected - next.reflected), std::abs(better.transmitted - next.transmitted));
            previous = next;
            next = better;
            power *= 4;
        }
        row.push_back(next);
    }
    SlabShares shares = row.back();
    shares.error = correction;
    known.emplace(key, shares);
    return shares;
}

}  // namespace pt::stability
