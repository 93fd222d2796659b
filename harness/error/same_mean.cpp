#include "harness/error/same_mean.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace pt {

namespace {

// Relative difference of means that counts as equal: kernels may round differently even where nothing is random.
constexpr double rounding = 1e-6;
// Largest relative standard error of a mean that takes part in the test.
constexpr double known_to = 0.1;

constexpr const char* channel_names[] = {"red", "green", "blue", "mean"};

// Welch's test of two samples for equal means.
struct Welch {
    RunMoments tested, baseline;
    double difference() const { return tested.mean - baseline.mean; }
    double error() const { return std::sqrt(tested.squared_error() + baseline.squared_error()); }
    double degrees_of_freedom() const {
        const double a = tested.squared_error(), b = baseline.squared_error();
        const double squares =
            a * a / static_cast<double>(tested.count - 1) + b * b / static_cast<double>(baseline.count - 1);
        return squares > 0 ? (a + b) * (a + b) / squares : 1;
    }
    // The two-sided p-value of the difference of the means, less the part that rounding may explain.
    double p() const {
        const double allowed = rounding * std::max(std::abs(tested.mean), std::abs(baseline.mean));
        const double beyond = std::abs(difference()) - allowed;
        if (beyond <= 0) {
            return 1;
        }
        return error() > 0 ? 2 * student_t_upper(beyond / error(), degrees_of_freedom()) : 0;
    }
    bool counts(bool same_sampling) const {
        const auto known = [](double squared_error, double mean) {
            return mean > 0 && std::sqrt(squared_error) <= known_to * mean;
        };
        return same_sampling
                   ? known(tested.squared_error() + baseline.squared_error(), std::max(tested.mean, baseline.mean))
                   : known(tested.squared_error(), tested.mean) && known(baseline.squared_error(), baseline.mean);
    }
    // The relative difference of two means, with a confidence interval by first-order propagation of both errors.
    RelativeDifference relative(double confidence) const {
        if (baseline.mean == 0) {
            return {tested.mean == 0 ? 0 : INFINITY, {0, tested.mean == 0 ? 0 : INFINITY}};
        }
        const double ratio = tested.mean / baseline.mean;
        const double width = error() > 0
                                 ? student_t_deviate(0.5 * (1 - confidence), degrees_of_freedom()) *
                                       std::sqrt(tested.squared_error() + ratio * ratio * baseline.squared_error()) /
                                       std::abs(baseline.mean)
                                 : 0;
        return {ratio - 1, {ratio - 1 - width, ratio - 1 + width}};
    }
};

// Keeps the smallest of many p-values, corrected for their number (Sidak), and the unit (pixel, ...) that has it.
class Smallest {
public:
    void add(double p, std::size_t unit) {
        if (count_ == 0 || p < p_) {
            p_ = p;
            unit_ = unit;
        }
        count_ += 1;
    }
    double p() const { return count_ > 0 ? sidak(p_, static_cast<double>(count_)) : 1; }
    std::size_t unit() const { return unit_; }

private:
    double p_ = 1;
    std::size_t unit_ = 0, count_ = 0;
};

using Variances = std::array<double, 3>;

std::vector<Variances> block_variances(const ImageRuns& runs, const std::vector<PixelMoments>& pixels) {
    std::vector<Variances> variances(runs.blocks());
    std::vector<double> sizes(runs.blocks());
    for (std::size_t index = 0; index < pixels.size(); ++index) {
        sizes[runs.block_of(index)] += 1;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            variances[runs.block_of(index)][channel] += pixels[index].covariance[channel];
        }
    }
    for (std::size_t block = 0; block < sizes.size(); ++block) {
        for (double& variance : variances[block]) {
            variance /= sizes[block];
        }
    }
    return variances;
}

class SameMeanTest {
public:
    SameMeanTest(const ImageRuns& tested, const ImageRuns& baseline, const SameMeanOptions& options)
        : tested_(tested),
          baseline_(baseline),
          options_(options),
          tested_blocks_(block_means(tested)),
          baseline_blocks_(block_means(baseline)),
          tested_pixels_(pixel_moments(tested)),
          baseline_pixels_(pixel_moments(baseline)),
          tested_variances_(block_variances(tested, tested_pixels_)),
          baseline_variances_(block_variances(baseline, baseline_pixels_)) {
        report_.blocks = tested.blocks();
        report_.pixels = tested.pixels();
    }

    SameMeanReport report() {
        report_.statistics = {image(), blocks(), squares(), pixel(), support(), independence()};
        const auto applied = std::count_if(report_.statistics.begin(), report_.statistics.end(),
                                           [](const Statistic& statistic) { return statistic.applies; });
        report_.level = options_.family_error / static_cast<double>(applied);
        return report_;
    }

private:
    Welch block_test(std::size_t block, std::size_t channel) const {
        return {moments_of(tested_blocks_[block][channel]), moments_of(baseline_blocks_[block][channel])};
    }
    // A pixel's variance is at least the mean variance of its block: where few samples hit a light, runs that hit it
    // less often also spread less, so that a low mean would look too certain.
    Welch pixel_test(std::size_t index, std::size_t channel) const {
        const std::size_t block = tested_.block_of(index);
        const auto moments = [&](const PixelMoments& pixel, const std::vector<Variances>& blocks, std::size_t count) {
            return RunMoments{pixel.mean[channel], std::max(pixel.covariance[channel], blocks[block][channel]), count};
        };
        return {moments(tested_pixels_[index], tested_variances_, tested_.count()),
                moments(baseline_pixels_[index], baseline_variances_, baseline_.count())};
    }
    bool block_counts(std::size_t block) const { return block_test(block, 3).counts(options_.same_sampling); }
    std::size_t block_x(std::size_t block) const { return block % tested_.block_columns() * ImageRuns::block_side; }
    std::size_t block_y(std::size_t block) const { return block / tested_.block_columns() * ImageRuns::block_side; }

    Statistic image() {
        Smallest smallest;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            smallest.add(block_test(tested_.blocks(), channel).p(), channel);
        }
        report_.image = block_test(tested_.blocks(), 3).relative(options_.confidence);
        return {"image", smallest.p(), true, channel_names[smallest.unit()]};
    }

    Statistic blocks() {
        Smallest smallest;
        for (std::size_t block = 0; block < tested_.blocks(); ++block) {
            bool counted = false;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const Welch test = block_test(block, channel);
                if (test.counts(options_.same_sampling)) {
                    smallest.add(test.p(), 3 * block + channel);
                    counted = true;
                }
            }
            report_.blocks_counted += counted ? 1 : 0;
        }
        if (report_.blocks_counted == 0) {
            return {"blocks", 1, false};
        }
        const std::size_t block = smallest.unit() / 3;
        report_.worst_block = block_test(block, 3).relative(options_.confidence);
        report_.worst_block_x = block_x(block);
        report_.worst_block_y = block_y(block);
        return {"blocks", smallest.p(), true,
                fmt::format("block {},{} {}", block_x(block), block_y(block), channel_names[smallest.unit() % 3])};
    }

    // Estimates the trace of C^2 for a covariance matrix C, unbiased for normal errors, too large for heavier tails.
    double squared_trace(const Covariance& covariance, std::size_t count) const {
        const double n = static_cast<double>(count - 1);
        const double trace = covariance.trace();
        return std::max(
            0.0, n * n / ((n - 1) * (n + 2)) * (Covariance::product_trace(covariance, covariance) - trace * trace / n));
    }

    // Estimated squared bias of some pixels: the squared difference of the two mean images less its part from noise.
    // Because this is a sum of products of different runs, its expectation is the squared bias for any distribution,
    // and its variance without a bias follows from the covariances.
    struct SquaredBias {
        double square = 0, variance = 0;
        double more_variance = 0;  // bound on the variance that a bias d adds to `square`: 4 d' C d, C the covariance
        double noise = 0;          // variance of the difference of the mean images, summed over channels
        double light = 0;          // squared mean radiance of the baseline
        double pixels = 0;
        SquaredBias& operator+=(const SquaredBias& other) {
            square += other.square;
            variance += other.variance;
            more_variance += other.more_variance;
            noise += other.noise;
            light += other.light;
            pixels += other.pixels;
            return *this;
        }
        // Whether the noise of these pixels exceeds rounding errors. Where it does not, the images are not random, and
        // a squared difference tests nothing that other statistics miss.
        bool is_random() const { return noise > rounding * rounding * light; }
    };
    SquaredBias pixel_bias(std::size_t index) const {
        const PixelMoments &a = tested_pixels_[index], &b = baseline_pixels_[index];
        const double n = static_cast<double>(tested_.count()), m = static_cast<double>(baseline_.count());
        SquaredBias bias;
        bias.pixels = 1;
        bias.noise = a.covariance.trace() / n + b.covariance.trace() / m;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double difference = a.mean[channel] - b.mean[channel];
            const double rounded = rounding * std::max(std::abs(a.mean[channel]), std::abs(b.mean[channel]));
            bias.square += difference * difference - rounded * rounded;
            bias.light += b.mean[channel] * b.mean[channel];
        }
        bias.square -= bias.noise;
        bias.variance = 2 * squared_trace(a.covariance, tested_.count()) / (n * (n - 1)) +
                        2 * squared_trace(b.covariance, baseline_.count()) / (m * (m - 1)) +
                        4 * Covariance::product_trace(a.covariance, b.covariance) / (n * m);
        bias.more_variance = 4 * bias.square * bias.noise;
        return bias;
    }

    // Sums the squared biases of all pixels, weighted by the noise of the pixel's block, since a pixel's own noise
    // would favour pixels that happen to be quiet. The sum is compared with a chi-square distribution of equal mean and
    // variance (docs/numerics.md).
    Statistic squares() {
        std::vector<SquaredBias> blocks(tested_.blocks());
        for (std::size_t index = 0; index < tested_.pixels(); ++index) {
            blocks[tested_.block_of(index)] += pixel_bias(index);
        }
        SquaredBias all;
        double sum = 0, variance = 0, traces = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block) {
            const SquaredBias& bias = blocks[block];
            if (bias.is_random() && block_counts(block)) {
                const double weight = bias.pixels / bias.noise;
                sum += weight * bias.square;
                variance += weight * weight * bias.variance;
                traces += weight * bias.noise;
                all += bias;
            }
        }
        if (variance <= 0) {
            return {"squares", 1, false};
        }
        set_root_mean_square(all);
        const double degrees_of_freedom = 2 * traces * traces / variance;
        const double z = sum / std::sqrt(variance);
        return {"squares",
                chi_square_upper(degrees_of_freedom + z * std::sqrt(2 * degrees_of_freedom), degrees_of_freedom), true,
                fmt::format("{:+.1f} standard errors", z)};
    }

    void set_root_mean_square(const SquaredBias& bias) {
        const double error = std::sqrt(bias.variance + std::max(0.0, bias.more_variance));
        const double width = normal_deviate(0.5 * (1 - options_.confidence)) * error;
        const auto relative = [&](double square) { return std::sqrt(std::max(0.0, square) / bias.light); };
        report_.root_mean_square = relative(bias.square);
        report_.root_mean_square_interval = {relative(bias.square - width), relative(bias.square + width)};
    }

    Statistic pixel() {
        Smallest smallest;
        for (std::size_t index = 0; index < tested_.pixels(); ++index) {
            bool counted = false;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const Welch test = pixel_test(index, channel);
                if (test.counts(options_.same_sampling)) {
                    smallest.add(test.p(), 3 * index + channel);
                    counted = true;
                }
            }
            report_.pixels_counted += counted ? 1 : 0;
        }
        const std::size_t index = smallest.unit() / 3;
        return {"pixel", smallest.p(), report_.pixels_counted > 0,
                fmt::format("pixel {},{} {}", index % tested_.width(), index / tested_.width(),
                            channel_names[smallest.unit() % 3])};
    }

    static bool is_lit(const ImageRuns& runs, std::size_t index) {
        for (std::size_t k = 0; k < runs.count(); ++k) {
            for (std::size_t channel = 0; channel < 3; ++channel) {
                if (runs.image(k)[3 * index + channel] != 0) {
                    return true;
                }
            }
        }
        return false;
    }

    // Compares how many pixels only one of the two variants has lit, which should be equally many for either. (Fisher's
    // exact test on all lit pixels would ignore that most are lit in both.)
    Statistic support() {
        for (std::size_t index = 0; index < tested_.pixels(); ++index) {
            const bool tested = is_lit(tested_, index), baseline = is_lit(baseline_, index);
            report_.lit_in_tested_only += tested && !baseline ? 1 : 0;
            report_.lit_in_baseline_only += baseline && !tested ? 1 : 0;
        }
        const std::size_t tested = report_.lit_in_tested_only, baseline = report_.lit_in_baseline_only;
        return {"support", options_.same_sampling ? fair_coin(tested, tested + baseline) : 1, options_.same_sampling,
                fmt::format("{} pixels against {}", tested, baseline)};
    }

    Statistic independence() {
        const Independence independence = test_independence(tested_);
        report_.dependence = independence.strongest();
        return {"independence", independence.p, true, report_.dependence.name};
    }

    const ImageRuns &tested_, &baseline_;
    SameMeanOptions options_;
    BlockMeans tested_blocks_, baseline_blocks_;
    std::vector<PixelMoments> tested_pixels_, baseline_pixels_;
    std::vector<Variances> tested_variances_, baseline_variances_;  // mean variance of a pixel in each block
    SameMeanReport report_;
};

}  // namespace

std::string RelativeDifference::text() const {
    return fmt::format("{:+.3g} % [{:.3g}, {:.3g}]", 100 * value, 100 * interval.low, 100 * interval.high);
}

bool SameMeanReport::same() const { return strongest().p >= level; }

const Statistic& SameMeanReport::strongest() const {
    return *std::min_element(statistics.begin(), statistics.end(),
                             [](const Statistic& a, const Statistic& b) { return a.p < b.p; });
}

std::string SameMeanReport::text() const {
    std::string line = "p";
    for (const Statistic& statistic : statistics) {
        line += statistic.applies ? fmt::format(" {} {:.2g}", statistic.name, statistic.p)
                                  : fmt::format(" {} -", statistic.name);
    }
    line += fmt::format(" (level {:.2g}); mean {}", level, image.text());
    if (blocks_counted > 0) {
        line += fmt::format("; worst of {} blocks at {},{} {}", blocks_counted, worst_block_x, worst_block_y,
                            worst_block.text());
    }
    if (statistics[2].applies) {
        line += fmt::format("; root mean square {:.3g} % [{:.3g}, {:.3g}]", 100 * root_mean_square,
                            100 * root_mean_square_interval.low, 100 * root_mean_square_interval.high);
    }
    const double width = normal_deviate(0.025) * dependence.error;
    return line + fmt::format("; {} pixels lit here only, {} there; {} {:.2g} [{:.2g}, {:.2g}]", lit_in_tested_only,
                              lit_in_baseline_only, dependence.name, dependence.value, dependence.value - width,
                              dependence.value + width);
}

SameMeanReport test_same_mean(const ImageRuns& tested, const ImageRuns& baseline, const SameMeanOptions& options) {
    if (tested.width() != baseline.width() || tested.height() != baseline.height() ||
        tested.count() != baseline.count() || tested.count() < 3 || tested.parts() < 2) {
        throw std::logic_error("the same mean: as many runs of each variant, at least three of two parts, of one size");
    }
    return SameMeanTest(tested, baseline, options).report();
}

}  // namespace pt
