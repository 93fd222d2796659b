#include "tests/support/synthetic_images.h"

namespace pt::test {

namespace {

// Pareto with exponent 2.5 and mean 1: a variance, but no kurtosis.
double heavy(double uniform) { return 0.6 * std::pow(1 - uniform, -0.4); }

// Adds a sample of mean hit_probability * hit_mean to three channels.
void add_sample(const SyntheticImage& image, std::uint32_t x, std::uint32_t y, Random& random, double* sum) {
    const double probability = hit_probability(x, y);
    double light = 0;
    if (image.dense) {
        light = probability * hit_mean(x, y) * (0.5 + random.uniform());
    } else if (random.uniform() < probability) {
        light = hit_mean(x, y) * heavy(random.uniform());
    }
    if (image.factor) {
        light *= image.factor(x, y);
    }
    if (image.extra_probability > 0 && random.uniform() < image.extra_probability) {
        light += image.extra;
    }
    if (light > 0) {
        const double tint = random.uniform(0.9, 1.1);
        sum[0] += light;
        sum[1] += 0.8 * light * tint;
        sum[2] += 0.6 * light * (2 - tint);
    }
}

constexpr std::uint32_t parts = 4;

Radiance part_of_run(const SyntheticImage& image, Random& random) {
    Radiance radiance(std::size_t{3} * image.width * image.height);
    const std::uint32_t samples = image.spp / parts;
    for (std::size_t pixel = 0; pixel < radiance.size() / 3; ++pixel) {
        const auto x = static_cast<std::uint32_t>(pixel % image.width);
        const auto y = static_cast<std::uint32_t>(pixel / image.width);
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            add_sample(image, x, y, random, &radiance[3 * pixel]);
        }
    }
    for (double& value : radiance) {
        value /= samples;
    }
    return radiance;
}

}  // namespace

// From one in fifty at the left to nine in ten at the right.
double hit_probability(std::uint32_t x, std::uint32_t) { return 0.02 + 0.88 * (x % 32) / 31.0; }

double hit_mean(std::uint32_t x, std::uint32_t y) { return 0.2 + 0.1 * ((x / 4 + y / 4) % 4); }

ImageRuns synthetic_runs(const SyntheticImage& image, std::uint64_t seed) {
    Random random(seed);
    ImageRuns runs(image.width, image.height);
    for (std::size_t k = 0; k < image.runs; ++k) {
        std::vector<Radiance> run;
        for (std::uint32_t part = 0; part < parts; ++part) {
            run.push_back(part_of_run(image, random));
        }
        runs.add(run);
    }
    return runs;
}

}  // namespace pt::test
