#include "harness/render/pixel_variance.h"

#include <algorithm>
#include <stdexcept>

namespace pt {

std::vector<std::uint32_t> variance_stops(std::uint32_t samples, std::uint32_t most) {
    const std::uint32_t batches = std::min(samples, most);
    std::vector<std::uint32_t> stops;
    for (std::uint64_t i = 1; i <= batches; ++i) {
        stops.push_back(static_cast<std::uint32_t>(i * samples / batches));
    }
    return stops;
}

// West's update of a weighted mean and its sum of squares, which gives exactly 0 squares where all batches are equal.
void PixelVariance::add(const Film& film) {
    const std::vector<std::int64_t>& sums = film.sums();
    if (sums_.empty()) {
        sums_.resize(sums.size());
        means_.resize(sums.size());
        squares_.resize(sums.size());
    }
    if (film.samples() <= samples_ || sums.size() != sums_.size()) {
        throw std::logic_error("a film that does not go on from the last one");
    }
    const auto count = static_cast<double>(film.samples() - samples_);
    const double share = count / static_cast<double>(film.samples());
    const double unit = 1 / (film.scale() * count);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double mean = static_cast<double>(sums[i] - sums_[i]) * unit;
        const double off = mean - means_[i];
        means_[i] = batches_ == 0 ? mean : means_[i] + share * off;
        squares_[i] += batches_ == 0 ? 0 : count * off * (mean - means_[i]);
    }
    sums_ = sums;
    samples_ = film.samples();
    ++batches_;
}

std::vector<float> PixelVariance::of_mean() const {
    if (batches_ < 2) {
        throw std::logic_error("the variance of a single batch");
    }
    // A batch of n samples has n times less variance than one sample, whose variance is thus squares_ / (batches - 1).
    const double factor = 1 / (static_cast<double>(batches_ - 1) * static_cast<double>(samples_));
    std::vector<float> values(squares_.size());
    std::transform(squares_.begin(), squares_.end(), values.begin(),
                   [&](double square) { return static_cast<float>(square * factor); });
    return values;
}

}  // namespace pt
