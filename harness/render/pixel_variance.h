// The variance of a pixel's mean, estimated from the film alone: its sums at stops within a render give the means of
// batches of samples, and a sample's variance follows from how those scatter (batch means; Law and Kelton, Simulation
// Modeling and Analysis, 9.5.3). No kernel takes part, and the film's bits stay.
#pragma once

#include <vector>

#include "harness/render/film.h"

namespace pt {

// Most batches of samples: enough for a relative standard error of 9 % where they are normal.
inline constexpr std::uint32_t most_variance_batches = 256;

// The numbers of samples at which a render stops: after each sample, or, beyond `most`, after batches that differ by
// one sample at most. They increase, and the last one is `samples`.
std::vector<std::uint32_t> variance_stops(std::uint32_t samples, std::uint32_t most = most_variance_batches);

class PixelVariance {
public:
    // The film after the batch that ends at film.samples(); of one size and scale, with more samples at each call.
    void add(const Film& film);

    std::uint32_t batches() const { return batches_; }
    // Variance of the mean over all samples so far, three channels a pixel: unbiased where samples are independent,
    // whatever the sizes of the batches. Precondition: two batches or more.
    std::vector<float> of_mean() const;

private:
    std::uint32_t batches_ = 0;
    std::uint64_t samples_ = 0;
    std::vector<std::int64_t> sums_;  // at the last stop
    std::vector<double> means_;       // over the batches so far, each weighted by its samples; squares_ is about these
    std::vector<double> squares_;
};

}  // namespace pt
