#include "harness/error/image_runs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pt {

void ImageRuns::add(const std::vector<Radiance>& parts) {
    const std::size_t size = 3 * pixels();
    if (parts.empty() || (count() > 0 && parts.size() != parts_)) {
        throw std::logic_error("a run of another number of parts");
    }
    for (const Radiance& part : parts) {
        if (part.size() != size) {
            throw std::logic_error("a run's image of another size");
        }
        if (!std::all_of(part.begin(), part.end(), [](double value) { return std::isfinite(value); })) {
            throw std::logic_error("a run's image with a value that is not finite");
        }
    }
    parts_ = parts.size();
    means_.resize(parts_ * pixels());
    squares_.resize(pixels());
    Radiance image(size);
    const double runs = static_cast<double>(count() + 1);
    for (std::size_t part = 0; part < parts_; ++part) {
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            double luminance = 0;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double value = parts[part][3 * pixel + channel];
                image[3 * pixel + channel] += value / static_cast<double>(parts_);
                luminance += value;
            }
            double& mean = means_[part * pixels() + pixel];
            const double delta = luminance - mean;  // Welford's online algorithm for mean and variance
            mean += delta / runs;
            squares_[pixel] += delta * (luminance - mean);
        }
    }
    images_.push_back(std::move(image));
}

std::vector<PixelMoments> pixel_moments(const ImageRuns& runs) {
    std::vector<PixelMoments> all(runs.pixels());
    const double count = static_cast<double>(runs.count());
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        PixelMoments& moments = all[pixel];
        for (std::size_t k = 0; k < runs.count(); ++k) {
            for (std::size_t channel = 0; channel < 3; ++channel) {
                moments.mean[channel] += runs.image(k)[3 * pixel + channel] / count;
            }
        }
        for (std::size_t k = 0; k < runs.count(); ++k) {
            const double* value = &runs.image(k)[3 * pixel];
            const double r = value[0] - moments.mean[0], g = value[1] - moments.mean[1], b = value[2] - moments.mean[2];
            moments.covariance.rr += r * r / (count - 1);
            moments.covariance.gg += g * g / (count - 1);
            moments.covariance.bb += b * b / (count - 1);
            moments.covariance.rg += r * g / (count - 1);
            moments.covariance.rb += r * b / (count - 1);
            moments.covariance.gb += g * b / (count - 1);
        }
    }
    return all;
}

RunMoments moments_of(const std::vector<double>& values) {
    RunMoments moments{0, 0, values.size()};
    const double count = static_cast<double>(values.size());
    for (const double value : values) {
        moments.mean += value / count;
    }
    for (const double value : values) {
        moments.variance += (value - moments.mean) * (value - moments.mean) / (count - 1);
    }
    return moments;
}

BlockMeans block_means(const ImageRuns& runs) {
    BlockMeans means(runs.blocks() + 1);
    for (auto& channels : means) {
        channels.fill(std::vector<double>(runs.count()));
    }
    std::vector<double> sizes(means.size());
    for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
        sizes[runs.block_of(pixel)] += 1;
    }
    sizes.back() = static_cast<double>(runs.pixels());
    for (std::size_t k = 0; k < runs.count(); ++k) {
        for (std::size_t pixel = 0; pixel < runs.pixels(); ++pixel) {
            for (const std::size_t block : {runs.block_of(pixel), runs.blocks()}) {
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    const double share = runs.image(k)[3 * pixel + channel] / sizes[block];
                    means[block][channel][k] += share;
                    means[block][3][k] += share / 3;
                }
            }
        }
    }
    return means;
}

}  // namespace pt
