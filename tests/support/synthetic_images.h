// Runs of images that were never rendered: cheap numbers with the statistics of a renderer's. A sample is black or a
// hit; how often it hits differs from pixel to pixel, how bright a hit is has a heavy tail, the channels of a sample go
// together.
#pragma once

#include <functional>

#include "harness/error/image_runs.h"
#include "tests/support/statistics.h"

namespace pt::test {

struct SyntheticImage {
    std::uint32_t width = 32, height = 32;
    std::size_t runs = 16;
    std::uint32_t spp = 16;  // of a run, in four parts
    // A dense estimator hits in every sample, as one that samples lights does; the sparse one waits for chance. Their
    // means are equal.
    bool dense = false;
    // What a sample's radiance is multiplied by, what light is added to it, and with which probability.
    std::function<double(std::uint32_t x, std::uint32_t y)> factor = {};
    double extra = 0, extra_probability = 0;
};

// How often a sample of a pixel hits, and the mean of a hit.
double hit_probability(std::uint32_t x, std::uint32_t y);
double hit_mean(std::uint32_t x, std::uint32_t y);

ImageRuns synthetic_runs(const SyntheticImage& image, std::uint64_t seed);

}  // namespace pt::test
