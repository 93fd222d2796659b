// The test of the same mean, tried on estimators that are equal, over many seeds, and on defects of known size. The
// images are synthetic, with the statistics of rendered ones, but where a renderer makes the defect itself.
#include "harness/error/same_mean.h"

#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_images.h"

namespace pt {
namespace {

using test::SyntheticImage;

enum Kind { image, blocks, squares, pixel, support, independence };

double p_of(const SameMeanReport& report, Kind kind) { return report.statistics[kind].p; }

SameMeanReport compare(const SyntheticImage& tested, const SyntheticImage& baseline, std::uint64_t seed = 1) {
    return test_same_mean(test::synthetic_runs(tested, 2 * seed), test::synthetic_runs(baseline, 2 * seed + 1),
                          {.same_sampling = tested.dense == baseline.dense});
}

// How many of `trials` trials may succeed if each does with this probability: the least number that chance passes less
// than once in 1e4.
std::uint64_t most_by_chance(std::uint64_t trials, double probability) {
    std::uint64_t most = 0;
    while (regularised_beta(static_cast<double>(most + 1), static_cast<double>(trials - most), probability,
                            1 - probability) > 1e-4) {
        most += 1;
    }
    return most;
}

// ---- No false alarm ----

// Counts what fails at the family error of the report, at one of 5 %, and each statistic's own p-values below 5 %.
void expect_few_alarms(const SyntheticImage& tested, const SyntheticImage& baseline) {
    constexpr std::uint64_t pairs = 100;
    std::uint64_t alarms = 0, alarms_at_5_percent = 0;
    std::array<std::uint64_t, 6> below_5_percent{};
    for (std::uint64_t pair = 0; pair < pairs; ++pair) {
        const SameMeanReport report = compare(tested, baseline, 1000 + pair);
        alarms += report.same() ? 0 : 1;
        alarms_at_5_percent += report.strongest().p < report.level * (0.05 / 1e-3) ? 1 : 0;
        for (std::size_t i = 0; i < below_5_percent.size(); ++i) {
            below_5_percent[i] += report.statistics[i].p < 0.05 ? 1 : 0;
        }
    }
    EXPECT_LE(alarms, most_by_chance(pairs, 1e-3));
    EXPECT_LE(alarms_at_5_percent, most_by_chance(pairs, 0.05));
    for (std::size_t i = 0; i < below_5_percent.size(); ++i) {
        EXPECT_LE(below_5_percent[i], most_by_chance(pairs, 0.05)) << "statistic " << i;
    }
}

TEST(SameMeanTest, TheBoundIsThatOfTheBinomialDistribution) {
    EXPECT_EQ(most_by_chance(100, 1e-3), 3u);   // scipy.stats.binom.sf(2, 100, 1e-3) = 1.50e-4, sf(3, ..) = 3.63e-6
    EXPECT_EQ(most_by_chance(100, 0.05), 15u);  // sf(14, 100, 0.05) = 1.36e-4, sf(15, ..) = 3.71e-5
}

TEST(SameMeanTest, EqualVariantsAreNotRejected) { expect_few_alarms({}, {}); }

TEST(SameMeanTest, EqualVariantsOfFewSamplesAreNotRejected) { expect_few_alarms({.spp = 4}, {.spp = 4}); }

// The dense estimator lights each pixel in each sample, the sparse one waits for rare bright hits.
TEST(SameMeanTest, ADenseEstimatorAndASparseOneOfTheSameMeanAreNotRejected) {
    expect_few_alarms({.dense = true}, {});
    expect_few_alarms({}, {.dense = true});
}

// ---- Defects ----

TEST(SameMeanTest, AUniformBiasOfOnePercentIsFound) {
    const SameMeanReport report =
        compare({.spp = 256, .factor = [](std::uint32_t, std::uint32_t) { return 1.01; }}, {.spp = 256});
    EXPECT_LT(p_of(report, image), report.level);
    EXPECT_FALSE(report.same());
    EXPECT_LT(report.image.interval.low, 0.01);
    EXPECT_GT(report.image.interval.high, 0.01);
    EXPECT_GT(report.image.interval.low, 0);
}

TEST(SameMeanTest, ABiasInOneBlockIsFoundThere) {
    const auto factor = [](std::uint32_t x, std::uint32_t y) { return x >= 16 && y < 16 ? 1.04 : 1; };
    const SameMeanReport report = compare({.spp = 64, .factor = factor}, {.spp = 64});
    EXPECT_LT(p_of(report, blocks), report.level);
    EXPECT_EQ(report.worst_block_x, 16u);
    EXPECT_EQ(report.worst_block_y, 0u);
    EXPECT_LT(report.worst_block.interval.low, 0.04);
    EXPECT_GT(report.worst_block.interval.high, 0.04);
}

// Neither the image's mean nor a block's knows of it.
TEST(SameMeanTest, ABiasThatChangesItsSignFromPixelToPixelIsFound) {
    const auto factor = [](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 == 0 ? 0.9 : 1.1; };
    const SameMeanReport report = compare({.spp = 64, .factor = factor}, {.spp = 64});
    EXPECT_GT(p_of(report, image), report.level);
    EXPECT_GT(p_of(report, blocks), report.level);
    EXPECT_LT(p_of(report, squares), report.level);
    EXPECT_LT(report.root_mean_square_interval.low, 0.1);
    EXPECT_GT(report.root_mean_square_interval.high, 0.1);
    EXPECT_GT(report.root_mean_square_interval.low, 0.05);
}

TEST(SameMeanTest, AWrongPixelIsFoundThere) {
    const auto factor = [](std::uint32_t x, std::uint32_t y) { return x == 20 && y == 9 ? 2 : 1; };
    const SameMeanReport report = compare({.spp = 256, .factor = factor}, {.spp = 256});
    EXPECT_LT(p_of(report, pixel), report.level);
    EXPECT_EQ(report.statistics[pixel].where.find("pixel 20,9 "), 0u) << report.statistics[pixel].where;
    EXPECT_GT(p_of(report, image), report.level);
}

TEST(SameMeanTest, PixelsThatStayBlackAreFoundAndCounted) {
    const auto factor = [](std::uint32_t x, std::uint32_t y) { return x == 1 && y % 2 == 0 ? 0 : 1; };
    const SameMeanReport report = compare({.spp = 64, .factor = factor}, {.spp = 64});
    EXPECT_LT(p_of(report, support), report.level);
    EXPECT_EQ(report.lit_in_tested_only, 0u);
    EXPECT_EQ(report.lit_in_baseline_only, 16u);
    // Where one variant samples lights, black pixels say nothing.
    const SameMeanReport dense = compare({.spp = 64, .dense = true, .factor = factor}, {.spp = 64});
    EXPECT_FALSE(dense.statistics[support].applies);
    EXPECT_EQ(p_of(dense, support), 1);
}

// A light of area 1.1 is seen by three fifths of the light in the brightest place, and by less with distance.
TEST(SameMeanTest, ALightSampledWithoutItsAreaIsFound) {
    const auto factor = [](std::uint32_t x, std::uint32_t) { return 1 + 0.6 * (1.1 - 1) * (1 - x / 32.0); };
    const SameMeanReport report = compare({.spp = 64, .dense = true, .factor = factor}, {.spp = 64});
    EXPECT_FALSE(report.same());
    EXPECT_LT(p_of(report, image), report.level);
}

// One path in fifty is exhausted, and adds what its throughput is.
TEST(SameMeanTest, EnergyOfExhaustedPathsIsFound) {
    const SameMeanReport report = compare({.spp = 64, .extra = 0.2, .extra_probability = 0.02}, {.spp = 64});
    EXPECT_FALSE(report.same());
    EXPECT_GT(report.image.interval.low, 0);
}

ImageRuns rendered_runs(const Scene& scene, std::uint32_t depth, std::uint64_t seed) {
    constexpr std::uint32_t parts = 4, spp = 16;
    ImageRuns runs(scene.camera.width, scene.camera.height);
    for (std::uint64_t run = 0; run < 16; ++run) {
        std::vector<Radiance> images;
        for (std::uint32_t part = 0; part < parts; ++part) {
            const Film film = test::render<float>(
                scene,
                {.samples = spp / parts, .first_sample = part * spp / parts, .depth = depth, .seed = seed + run});
            const std::vector<float> radiance = film.radiance();
            images.emplace_back(radiance.begin(), radiance.end());
        }
        runs.add(images);
    }
    return runs;
}

Scene lit_room() {
    test::SceneBuilder builder;
    builder.room(builder.diffuse({0.8, 0.7, 0.6}), {0, 0, 0}, {2, 2, 2});
    builder.sphere(builder.emitter({4, 4, 4}), {0.3, 1, 1}, 1.8);
    builder.image(24, 16, 70, true).depth(6);
    return builder.scene;
}

TEST(SameMeanTest, AMissingBounceIsFound) {
    const Scene scene = lit_room();
    const ImageRuns complete = rendered_runs(scene, 6, 1);
    const SameMeanReport report = test_same_mean(rendered_runs(scene, 5, 101), complete);
    EXPECT_LT(p_of(report, image), report.level) << report.text();
    EXPECT_LT(report.image.interval.high, 0);
    const SameMeanReport same = test_same_mean(rendered_runs(scene, 6, 201), complete);
    EXPECT_TRUE(same.same()) << same.text();
}

// ---- Edges ----

// Runs of one image, each value of which is multiplied by `factor`.
ImageRuns constant_runs(double factor) {
    ImageRuns runs(20, 3);
    Radiance radiance(std::size_t{3} * 20 * 3);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        radiance[i] = factor * static_cast<double>(i % 7);
    }
    for (int run = 0; run < 4; ++run) {
        runs.add({radiance, radiance});
    }
    return runs;
}

TEST(SameMeanTest, WhereNothingIsRandomOnlyRoundingsAreAllowed) {
    EXPECT_TRUE(test_same_mean(constant_runs(1 + 1e-7), constant_runs(1)).same());
    EXPECT_FALSE(test_same_mean(constant_runs(1 + 1e-5), constant_runs(1)).same());
    EXPECT_TRUE(test_same_mean(constant_runs(0), constant_runs(0)).same());
    EXPECT_FALSE(test_same_mean(constant_runs(0), constant_runs(1)).same());
}

TEST(SameMeanTest, WhatCannotBeTestedIsRefused) {
    ImageRuns runs(1, 1);
    EXPECT_THROW(runs.add({}), std::logic_error);
    EXPECT_THROW(runs.add({{1, 1, 1}, {1, 1}}), std::logic_error);
    EXPECT_THROW(runs.add({{1, 1, NAN}}), std::logic_error);
    ImageRuns more(1, 1);
    for (int run = 0; run < 3; ++run) {
        more.add({{1, 1, 1}, {1, 1, 1}});
    }
    EXPECT_THROW(more.add({{1, 1, 1}}), std::logic_error);
    EXPECT_THROW(test_same_mean(runs, more), std::logic_error);
    EXPECT_THROW(test_same_mean(more, constant_runs(1)), std::logic_error);
}

// ---- Position-keyed minstd ----

std::uint32_t wang_hash(std::uint32_t a) {
    a = (a + 0x7ed55d16u) + (a << 12);
    a = (a ^ 0xc761c23cu) ^ (a >> 19);
    a = (a + 0x165667b1u) + (a << 5);
    a = (a + 0xd3a2646cu) ^ (a << 9);
    a = (a + 0xfd7046c5u) + (a << 3);
    return (a ^ 0xb55a4f09u) ^ (a >> 16);
}

// CIS 565's generator, for a path by its place in the compacted queue; `seed` is what runs differ by.
std::minstd_rand engine_at(std::uint32_t iteration, std::uint32_t place, std::uint32_t bounce, std::uint32_t seed) {
    return std::minstd_rand(wang_hash((1u << 31) | (bounce << 22) | iteration) ^ wang_hash(place) ^ seed);
}

double unit(std::minstd_rand& engine) { return static_cast<double>(engine() - 1) / 2147483646.0; }

// Paths of up to four bounces: at each a path meets light, or leaves, or goes on, and those that go on close ranks.
Radiance minstd_sample(std::uint32_t iteration, std::uint32_t seed) {
    constexpr std::uint32_t width = 32, height = 32;
    Radiance radiance(std::size_t{3} * width * height);
    std::vector<std::uint32_t> alive(radiance.size() / 3);
    std::iota(alive.begin(), alive.end(), 0u);
    for (std::uint32_t bounce = 0; bounce < 4; ++bounce) {
        std::vector<std::uint32_t> next;
        for (std::uint32_t place = 0; place < alive.size(); ++place) {
            const std::uint32_t index = alive[place], x = index % width, y = index / width;
            std::minstd_rand engine = engine_at(iteration, place, bounce, seed);
            const double lobe = unit(engine), brightness = unit(engine);
            if (lobe < test::hit_probability(x, y) / 3) {
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    radiance[3 * index + channel] += test::hit_mean(x, y) * (0.5 + brightness);
                }
            } else if (unit(engine) < 0.75) {
                next.push_back(index);
            }
        }
        alive = next;
    }
    return radiance;
}

ImageRuns minstd_runs(std::uint32_t spp, const std::function<std::uint32_t(std::uint32_t run)>& seed) {
    ImageRuns runs(32, 32);
    for (std::uint32_t run = 0; run < 16; ++run) {
        std::vector<Radiance> parts;
        for (std::uint32_t iteration = 0; iteration < spp; ++iteration) {
            parts.push_back(minstd_sample(iteration, seed(run)));
        }
        runs.add(parts);
    }
    return runs;
}

// Runs of the walk with independent numbers: every iteration of every run has a seed of its own.
ImageRuns independent_runs(std::uint32_t spp, std::uint64_t seed) {
    test::Random random(seed);
    ImageRuns runs(32, 32);
    for (std::uint32_t run = 0; run < 16; ++run) {
        std::vector<Radiance> parts;
        for (std::uint32_t iteration = 0; iteration < spp; ++iteration) {
            parts.push_back(minstd_sample(random.word() >> 11, random.word()));
        }
        runs.add(parts);
    }
    return runs;
}

// The programs of cis565 have no seed: every run is the same image. One that is added in the same way (exclusive or)
// barely moves the generator's first numbers. Either way the runs share their errors, which their spread does not show.
TEST(SameMeanTest, ErrorsThatTheRunsOfAGeneratorShareAreFound) {
    const ImageRuns baseline = independent_runs(16, 1);
    const SameMeanReport equal = test_same_mean(minstd_runs(16, [](std::uint32_t) { return 0; }), baseline);
    EXPECT_LT(p_of(equal, squares), 1e-12) << equal.text();
    const SameMeanReport seeded = test_same_mean(minstd_runs(16, [](std::uint32_t run) { return run; }), baseline);
    EXPECT_LT(p_of(seeded, squares), 1e-12) << seeded.text();
    EXPECT_GT(p_of(seeded, image), seeded.level) << seeded.text();
    const SameMeanReport same = test_same_mean(independent_runs(16, 2), baseline);
    EXPECT_TRUE(same.same()) << same.text();
}

}  // namespace
}  // namespace pt
