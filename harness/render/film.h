// The host's film: fixed-point sums of radiance per pixel, their scale, and values computed from them.
#pragma once

#include <string>
#include <vector>

#include "harness/scene/scene.h"
#include "kernels/film.h"

namespace pt {

class Film {
public:
    // `bound`: largest radiance of one sample (radiance_bound). `samples`: samples per pixel that will be added in all,
    // from which the film's scale and limit follow.
    Film(std::uint32_t width, std::uint32_t height, double bound, std::uint64_t samples);

    FilmView view();
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    // Samples per pixel in the film's radiance sums; pixel() and radiance() divide the sums by this number.
    std::uint64_t samples() const { return samples_; }
    // Sets the number of samples per pixel added so far, if more will follow; the film's scale and limit do not change.
    void set_samples(std::uint64_t samples) { samples_ = samples; }
    const std::vector<std::int64_t>& sums() const { return sums_; }
    // Replaces the radiance sums by those of a device's film of equal scale. Throws std::logic_error if sizes differ.
    void set(std::vector<std::int64_t> sums, const FilmFaults& faults);
    const FilmFaults& faults() const { return faults_; }
    double scale() const { return scale_; }

    // Mean radiance of a pixel over the film's samples.
    Vec3d pixel(std::uint32_t index) const;
    Vec3d mean() const;
    // Hash of the film's sums, 16 hex digits: FNV-1a over words, high bits folded in. Equal hashes mean equal bits.
    std::string hash() const;
    // The film's mean radiance as linear RGB, row-major from the top.
    std::vector<float> radiance() const;

private:
    std::uint32_t width_, height_;
    std::uint64_t samples_;
    double scale_, limit_;
    std::vector<std::int64_t> sums_;
    FilmFaults faults_;
};

// Describes the faults of a film, as "1 non-finite, 0 negative and 2 saturated samples".
std::string faults_text(const FilmFaults& faults);

// The scale of a film in quanta per unit of radiance: a power of two such that the sums have room for 2^16 samples (or
// `samples`, if more) of 64 times the bound.
double film_scale(double bound, std::uint64_t samples);

}  // namespace pt
