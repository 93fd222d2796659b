#include "harness/error/metrics.h"

#include <cmath>
#include <stdexcept>

namespace pt {

namespace {

// The constant in the denominators of relative metrics that keeps dark pixels from dominating (docs/numerics.md 1.1).
constexpr double dark = 1e-2;

void check_sizes(const Image& image, std::initializer_list<const Image*> others) {
    for (const Image* other : others) {
        if (image.empty() || image.size() % 3 != 0 || other->size() != image.size()) {
            throw std::logic_error("images of different sizes, or empty, are compared");
        }
    }
}

double bias_squared(const Halves& halves, const Image& r1, const Image& r2) {
    double sum = 0;
    for (std::size_t i = 0; i < r1.size(); ++i) {
        const double h1 = halves.first[i];
        const double h2 = halves.second[i];
        sum += 0.5 * ((h1 - r1[i]) * (h2 - r2[i]) + (h1 - r2[i]) * (h2 - r1[i]));
    }
    return sum / static_cast<double>(r1.size());
}

}  // namespace

const std::vector<std::pair<std::string_view, std::string_view>> metric_definitions{
    {"images",
     "x: mean linear radiance of the samples so far, double precision, no clamp; r1, r2: the reference's independent "
     "halves, r = (r1+r2)/2; a closed form is both halves; mean: over all pixels and three channels; a sample or pixel "
     "that is not finite makes every metric null"},
    {"me_rgb", "mean over pixels of (x-r), by channel"},
    {"mse", "mean of (x-r)^2"},
    {"mse_dual", "mean of (x-r1)(x-r2): unbiased for the mean of (x-mu)^2, mu the exact image; may be negative"},
    {"rel_mse", "mean of (x-r)^2/(r^2+1e-2)"},
    {"rel_mse_dual", "mean of (x-r1)(x-r2)/(r^2+1e-2)"},
    {"smape", "mean of |x-r|/(|x|+|r|+1e-2)"},
    {"bias2",
     "mean of ((h1-r1)(h2-r2)+(h1-r2)(h2-r1))/2, h1 and h2 the means of the first and the last half of the run's "
     "samples: the squared bias at what the run froze, whatever the noise; null at one sample, where half as many are "
     "no checkpoint, and where a run's samples are not independent"},
};

std::uint64_t nonfinite_pixels(const Image& image) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i + 2 < image.size(); i += 3) {
        const bool finite = std::isfinite(image[i]) && std::isfinite(image[i + 1]) && std::isfinite(image[i + 2]);
        count += finite ? 0u : 1u;
    }
    return count;
}

std::optional<Errors> errors_of(const Image& image, const Halves* halves, const Image& first_reference,
                                const Image& second_reference) {
    check_sizes(image, {&first_reference, &second_reference});
    if (nonfinite_pixels(image) != 0) {
        return std::nullopt;
    }
    Errors errors;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double x = image[i];
        const double r1 = first_reference[i];
        const double r2 = second_reference[i];
        const double r = 0.5 * (r1 + r2);
        const double square = (x - r) * (x - r);
        const double product = (x - r1) * (x - r2);
        errors.me_rgb[i % 3] += x - r;
        errors.mse += square;
        errors.mse_dual += product;
        errors.rel_mse += square / (r * r + dark);
        errors.rel_mse_dual += product / (r * r + dark);
        errors.smape += std::abs(x - r) / (std::abs(x) + std::abs(r) + dark);
    }
    const auto values = static_cast<double>(image.size());
    for (double& channel : errors.me_rgb) {
        channel /= values / 3;
    }
    for (double* mean : {&errors.mse, &errors.mse_dual, &errors.rel_mse, &errors.rel_mse_dual, &errors.smape}) {
        *mean /= values;
    }
    if (halves != nullptr) {
        check_sizes(image, {&halves->first, &halves->second});
        if (nonfinite_pixels(halves->first) + nonfinite_pixels(halves->second) != 0) {
            return std::nullopt;
        }
        errors.bias2 = bias_squared(*halves, first_reference, second_reference);
    }
    return errors;
}

ReferenceNoise noise_of(const Image& first_reference, const Image& second_reference) {
    check_sizes(first_reference, {&second_reference});
    double squares = 0;
    double fourths = 0;
    double mean_squares = 0;
    for (std::size_t i = 0; i < first_reference.size(); ++i) {
        const double r = 0.5 * (first_reference[i] + second_reference[i]);
        const double difference = first_reference[i] - second_reference[i];
        squares += difference * difference;
        fourths += difference * difference * difference * difference;
        mean_squares += r * r;
    }
    const auto values = static_cast<double>(first_reference.size());
    // Reference halves r1, r2 (mean mu, normal noise, variance u): E (r1-r2)^4 = 12 u^2, var (r1-mu)(r2-mu) = u^2.
    return {0.25 * squares / values, mean_squares / values, std::sqrt(fourths / values / 12 / (values / 3))};
}

}  // namespace pt
