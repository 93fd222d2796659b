// Estimates the variance of each pixel's mean from the film alone, by batch means (Law and Kelton, Simulation Modeling
// and Analysis, 9.5.3): the film's sums at stops within a render give the means of batches of samples, and their
// scatter gives the variance of a sample. Kernels and the film's bits are not affected.
#pragma once

#include <vector>

#include "harness/render/film.h"

namespace pt {

// Limit on the number of batches of samples: gives a relative standard error of 9 % where batch means are normal.
inline constexpr std::uint32_t most_variance_batches = 256;

// The numbers of samples after which a render stops: after each sample or, for more than `most` samples, after `most`
// batches that differ by one sample at most. They increase, and the last one is `samples`.
std::vector<std::uint32_t> variance_stops(std::uint32_t samples, std::uint32_t most = most_variance_batches);

class PixelVariance {
public:
    // Adds the batch of samples that has been added to the film since the last call. Every call must pass a film of the
    // same size and scale, with more samples than before.
    void add(const Film& film);

    std::uint32_t batches() const { return batches_; }
    // Variance of the mean over all samples so far, three channels per pixel. The estimate is unbiased where samples
    // are independent, for any sizes of batches. Precondition: at least two batches.
    std::vector<float> of_mean() const;

private:
    std::uint32_t batches_ = 0;
    std::uint64_t samples_ = 0;
    std::vector<std::int64_t> sums_;  // radiance sums that the film had at the last stop
    std::vector<double> means_;       // mean radiance by channel over the batches so far, weighted by samples
    std::vector<double> squares_;
};

}  // namespace pt
