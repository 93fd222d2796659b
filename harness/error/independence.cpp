#include "harness/error/independence.h"

#include <algorithm>
#include <cmath>

namespace pt {

namespace {

// The error of a pixel's luminance in each run, relative to its mean over the runs: [pixel][run].
using RunErrors = std::vector<std::vector<double>>;

RunErrors run_errors_of(const ImageRuns& runs) {
    RunErrors errors(runs.pixels(), std::vector<double>(runs.count()));
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        double mean = 0;
        for (std::size_t k = 0; k < runs.count(); ++k) {
            const double* channels = &runs.image(k)[3 * pixel];
            errors[pixel][k] = channels[0] + channels[1] + channels[2];
            mean += errors[pixel][k] / static_cast<double>(runs.count());
        }
        for (double& error : errors[pixel]) {
            error -= mean;
        }
    }
    return errors;
}

double covariance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        sum += a[k] * b[k];
    }
    return sum / static_cast<double>(a.size() - 1);
}

// Weights of pixels, by block: 1/variance, pooled over the block, since a pixel's own variance correlates with its
// error. 0 for blocks in which only rounding errors vary.
std::vector<double> weights_of(const ImageRuns& runs, const RunErrors& errors) {
    constexpr double rounding = 1e-6;
    std::vector<double> variances(runs.blocks()), counts(runs.blocks()), roundings(runs.blocks());
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        const std::size_t block = runs.block_of(pixel);
        const double* channels = &runs.image(0)[3 * pixel];
        const double rounded = rounding * (channels[0] + channels[1] + channels[2]);
        variances[block] += covariance(errors[pixel], errors[pixel]);
        roundings[block] += rounded * rounded;
        counts[block] += 1;
    }
    std::vector<double> weights(runs.blocks());
    for (std::size_t block = 0; block < weights.size(); ++block) {
        weights[block] = variances[block] > roundings[block] ? counts[block] / variances[block] : 0;
    }
    return weights;
}

// Sums covariances of errors over the image; all are 0 in expectation if samples are independent. The sum's standard
// error follows from the sum of the squares, whatever the distribution of errors.
class Pool {
public:
    explicit Pool(const char* name) : name_(name) {}
    void add(double weight, double product, double variance) {
        sum_ += weight * product;
        squares_ += weight * product * weight * product;
        variances_ += weight * variance;
    }
    Dependence dependence() const {
        if (squares_ == 0) {
            return {name_, 0, 0, 1};
        }
        return {name_, sum_ / variances_, std::sqrt(squares_) / variances_, normal_upper(sum_ / std::sqrt(squares_))};
    }

private:
    const char* name_;
    double sum_ = 0, squares_ = 0, variances_ = 0;
};

// How far the variance of a run exceeds what its m parts would give it if they were independent, 1/m of a part's
// variance. Any excess comes from covariances of the parts.
Dependence excess_variance(const ImageRuns& runs, const RunErrors& errors, const std::vector<double>& weights) {
    Pool pool("excess variance of a run");
    const double parts = static_cast<double>(runs.parts());
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        const double independent = runs.variance_of_parts(pixel) / (parts * parts);
        pool.add(weights[runs.block_of(pixel)], covariance(errors[pixel], errors[pixel]) - independent, independent);
    }
    return pool.dependence();
}

Dependence between_neighbours(const ImageRuns& runs, const RunErrors& errors, const std::vector<double>& weights) {
    Pool pool("correlation of neighbouring pixels");
    const auto add = [&](std::size_t a, std::size_t b) {
        pool.add(std::sqrt(weights[runs.block_of(a)] * weights[runs.block_of(b)]), covariance(errors[a], errors[b]),
                 0.5 * (covariance(errors[a], errors[a]) + covariance(errors[b], errors[b])));
    };
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        if (pixel % runs.width() + 1 < runs.width()) {
            add(pixel, pixel + 1);
        }
        if (pixel + runs.width() < runs.pixels()) {
            add(pixel, pixel + runs.width());
        }
    }
    return pool.dependence();
}

// Correlation of successive runs: the mean product of their errors minus the expected product of any two runs. (Errors
// sum to 0 over K runs, so that product is -1/K of the variance.)
Dependence between_runs(const ImageRuns& runs, const RunErrors& errors, const std::vector<double>& weights) {
    Pool pool("correlation of successive seeds");
    const double count = static_cast<double>(runs.count());
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        double successive = 0;
        for (std::size_t k = 0; k + 1 < runs.count(); ++k) {
            successive += errors[pixel][k] * errors[pixel][k + 1] / (count - 1);
        }
        const double variance = covariance(errors[pixel], errors[pixel]);
        pool.add(weights[runs.block_of(pixel)], successive + variance / count, variance);
    }
    return pool.dependence();
}

}  // namespace

const Dependence& Independence::strongest() const {
    return *std::min_element(dependences.begin(), dependences.end(),
                             [](const Dependence& a, const Dependence& b) { return a.p < b.p; });
}

Independence test_independence(const ImageRuns& runs) {
    const RunErrors errors = run_errors_of(runs);
    const std::vector<double> weights = weights_of(runs, errors);
    Independence result{{excess_variance(runs, errors, weights), between_neighbours(runs, errors, weights),
                         between_runs(runs, errors, weights)},
                        1};
    result.p = sidak(result.strongest().p, static_cast<double>(result.dependences.size()));
    return result;
}

}  // namespace pt
