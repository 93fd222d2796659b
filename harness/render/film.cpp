#include "harness/render/film.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "variants/fnv1a.h"

namespace pt {

std::string faults_text(const FilmFaults& faults) {
    return fmt::format("{} non-finite, {} negative and {} saturated samples", faults.nonfinite, faults.negative,
                       faults.saturated);
}

double film_scale(double bound, std::uint64_t samples) {
    int bound_exponent = 0;
    std::frexp(bound, &bound_exponent);  // finds the exponent of the least power of two above `bound`
    int sample_exponent = 16;
    while (sample_exponent < 62 && (std::uint64_t{1} << sample_exponent) < samples) {
        ++sample_exponent;
    }
    // The film scale's exponent is limited, so that the scale stays finite for bounds below the range of float.
    constexpr int largest_exponent = 960;
    return std::ldexp(1.0, std::min(62 - 6 - sample_exponent - bound_exponent, largest_exponent));
}

Film::Film(std::uint32_t width, std::uint32_t height, double bound, std::uint64_t samples)
    : width_(width),
      height_(height),
      samples_(samples),
      scale_(film_scale(bound, samples)),
      limit_(0x1p62 / static_cast<double>(std::max<std::uint64_t>(1, samples))),
      sums_(std::size_t{3} * width * height) {}

FilmView Film::view() {
    FilmView view{.sums = sums_.data(), .faults = &faults_, .scale = scale_, .limit = limit_};
    // With a film scale in this range, the product of a radiance and the scale overflows or underflows single precision
    // only where it is beyond the film's limit, or rounds to 0.
    if (scale_ >= 0x1p-60 && scale_ <= 0x1p100) {
        view.single_scale = static_cast<float>(scale_);
        const float rounded = static_cast<float>(limit_);
        view.single_limit = static_cast<double>(rounded) <= limit_ ? rounded : std::nextafter(rounded, 0.0f);
    }
    return view;
}

void Film::set(std::vector<std::int64_t> sums, const FilmFaults& faults) {
    if (sums.size() != sums_.size()) {
        throw std::logic_error("film sums of another size");
    }
    sums_ = std::move(sums);
    faults_ = faults;
}

Vec3d Film::pixel(std::uint32_t index) const {
    const double unit = 1.0 / (scale_ * static_cast<double>(samples_));
    const std::int64_t* sum = &sums_[3 * static_cast<std::size_t>(index)];
    return {static_cast<double>(sum[0]) * unit, static_cast<double>(sum[1]) * unit, static_cast<double>(sum[2]) * unit};
}

Vec3d Film::mean() const {
    Vec3d total(0.0);
    const std::uint32_t pixels = width_ * height_;
    for (std::uint32_t i = 0; i < pixels; ++i) {
        total += pixel(i);
    }
    return total / static_cast<double>(pixels);
}

// FNV-1a over words rather than bytes, since a film may have hundreds of megabytes.
std::string Film::hash() const {
    std::uint64_t hash = fnv1a_start;
    for (const std::int64_t sum : sums_) {
        hash = fnv1a_word(hash, static_cast<std::uint64_t>(sum));
    }
    return fmt::format("{:016x}", hash);
}

std::vector<float> Film::radiance() const {
    std::vector<float> values(sums_.size());
    for (std::uint32_t i = 0; i < width_ * height_; ++i) {
        const Vec3d mean = pixel(i);
        values[3 * i + 0] = static_cast<float>(mean.x);
        values[3 * i + 1] = static_cast<float>(mean.y);
        values[3 * i + 2] = static_cast<float>(mean.z);
    }
    return values;
}

}  // namespace pt
