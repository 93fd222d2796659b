// The host's film: fixed-point sums, their scale, and what can be read off them.
#pragma once

#include <string>
#include <vector>

#include "harness/scene/scene.h"
#include "kernels/film.h"

namespace pt {

class Film {
public:
    // `bound`: radiance that one sample can carry (radiance_bound); `samples`: samples a pixel that will be added in
    // all, which the scale and the limit are for.
    Film(std::uint32_t width, std::uint32_t height, double bound, std::uint64_t samples);

    FilmView view();
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    // Samples a pixel that pixel() and radiance() divide the sums by.
    std::uint64_t samples() const { return samples_; }
    // Sets the number of samples that have been added so far, if they are only a part; scale and limit stay those of
    // the whole.
    void set_samples(std::uint64_t samples) { samples_ = samples; }
    const std::vector<std::int64_t>& sums() const { return sums_; }
    // Takes over what was summed elsewhere at this film's scale. Throws std::logic_error if the sizes differ.
    void set(std::vector<std::int64_t> sums, const FilmFaults& faults);
    const FilmFaults& faults() const { return faults_; }
    double scale() const { return scale_; }

    // Mean radiance of a pixel over the samples.
    Vec3d pixel(std::uint32_t index) const;
    Vec3d mean() const;
    // FNV-1a over the sums, a word at a time, with the high bits folded in: 16 hex digits. Equal hashes mean equal
    // bits, whatever the variant.
    std::string hash() const;
    // The image as linear RGB, row-major.
    std::vector<float> radiance() const;

private:
    std::uint32_t width_, height_;
    std::uint64_t samples_;
    double scale_, limit_;
    std::vector<std::int64_t> sums_;
    FilmFaults faults_;
};

// The faults in words, as "1 non-finite, 0 negative and 2 saturated samples".
std::string faults_text(const FilmFaults& faults);

// The scale of a film in quanta a unit of radiance: a power of two such that 2^16 samples (or `samples`, if more) of 64
// times the bound fit.
double film_scale(double bound, std::uint64_t samples);

}  // namespace pt
