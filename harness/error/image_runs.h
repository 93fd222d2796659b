// Images of independent runs of a variant, the data of the statistical tests between variants and of one variant alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pt {

// An image of mean radiance: three channels per pixel, row by row.
using Radiance = std::vector<double>;

class ImageRuns {
public:
    ImageRuns(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {}

    // Adds a run as parts, each the mean image of equally many samples. Throws std::logic_error if a part has another
    // size than the image or a value that is not finite, or if earlier runs had another number of parts.
    void add(const std::vector<Radiance>& parts);

    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    std::size_t pixels() const { return std::size_t{width_} * height_; }
    std::size_t count() const { return images_.size(); }
    std::size_t parts() const { return parts_; }
    // A run's image: the mean of its parts.
    const Radiance& image(std::size_t run) const { return images_[run]; }
    // Unbiased variance over runs of a part's luminance (sum of channels) in a pixel, summed over the parts.
    double variance_of_parts(std::size_t pixel) const { return squares_[pixel] / static_cast<double>(count() - 1); }

    // Blocks of 16x16 pixels; those at the right and lower edges may be smaller.
    static constexpr std::uint32_t block_side = 16;
    std::uint32_t block_columns() const { return (width_ + block_side - 1) / block_side; }
    std::size_t blocks() const { return std::size_t{block_columns()} * ((height_ + block_side - 1) / block_side); }
    std::size_t block_of(std::size_t pixel) const {
        return pixel / width_ / block_side * block_columns() + pixel % width_ / block_side;
    }

private:
    std::uint32_t width_, height_;
    std::vector<Radiance> images_;
    std::size_t parts_ = 0;
    std::vector<double> means_;    // mean over runs of each part's luminance: [part][pixel]
    std::vector<double> squares_;  // squared deviations from `means_`, summed over runs and parts: [pixel]
};

// The symmetric 3x3 covariance matrix of the colour channels over runs.
struct Covariance {
    double rr = 0, gg = 0, bb = 0, rg = 0, rb = 0, gb = 0;
    double trace() const { return rr + gg + bb; }
    // The trace of the product of two covariances.
    static double product_trace(const Covariance& a, const Covariance& b) {
        return a.rr * b.rr + a.gg * b.gg + a.bb * b.bb + 2 * (a.rg * b.rg + a.rb * b.rb + a.gb * b.gb);
    }
    double operator[](std::size_t channel) const { return channel == 0 ? rr : channel == 1 ? gg : bb; }
};

struct PixelMoments {
    std::array<double, 3> mean{};
    Covariance covariance;  // unbiased covariance of the colour channels over runs
};

// The mean and covariance of every pixel over all runs. Precondition: at least two runs.
std::vector<PixelMoments> pixel_moments(const ImageRuns& runs);

// Mean and unbiased variance of a value over runs.
struct RunMoments {
    double mean = 0, variance = 0;
    std::size_t count = 0;
    double squared_error() const { return variance / static_cast<double>(count); }
};
RunMoments moments_of(const std::vector<double>& values);

// Means over 16x16 blocks in every run: [block][channel][run]. Channel 3 is the mean of the three colour channels; the
// last block is the whole image.
using BlockMeans = std::vector<std::array<std::vector<double>, 4>>;
BlockMeans block_means(const ImageRuns& runs);

}  // namespace pt
