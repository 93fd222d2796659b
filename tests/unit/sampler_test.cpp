// The sources of random numbers: published test vectors, the evenness that each promises, and what is wrong with
// that of cis565.
#include <algorithm>
#include <array>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "kernels/rng.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

// Random123's known-answer vectors for philox4x32-10 (kat_vectors).
TEST(PhiloxTest, GivesTheKnownAnswers) {
    const auto expect = [](const RandomWords& counter, std::uint32_t key_0, std::uint32_t key_1,
                           const std::array<std::uint32_t, 4>& answer) {
        const RandomWords words = philox4x32_10(counter, key_0, key_1);
        EXPECT_EQ((std::array{words.x, words.y, words.z, words.w}), answer);
    };
    expect({0, 0, 0, 0}, 0, 0, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
    expect({~0u, ~0u, ~0u, ~0u}, ~0u, ~0u, {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    expect({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0xa4093822, 0x299f31d0,
           {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST(MinstdTest, IsTheStandardLibrarysEngine) {
    std::minstd_rand engine(1);
    std::uint32_t state = 1;
    for (int i = 0; i < 1000; ++i) {
        state = minstd_product(state, minstd_multiplier);
        ASSERT_EQ(state, engine());
    }
    std::minstd_rand far(1);
    far.discard(123455);
    EXPECT_EQ(minstd_power(123456), far());
    EXPECT_EQ(minstd_power(0), 1u);
}

// Joe and Kuo's first points.
TEST(SobolTest, PointsAreTheKnownOnes) {
    const double exact[8][4] = {{0, 0, 0, 0},
                                {0.5, 0.5, 0.5, 0.5},
                                {0.25, 0.75, 0.75, 0.75},
                                {0.75, 0.25, 0.25, 0.25},
                                {0.125, 0.625, 0.375, 0.125},
                                {0.625, 0.125, 0.875, 0.625},
                                {0.375, 0.375, 0.625, 0.875},
                                {0.875, 0.875, 0.125, 0.375}};
    for (std::uint32_t i = 0; i < 8; ++i) {
        const RandomWords p = sobol_point(i);
        const double got[4] = {p.x * 0x1p-32, p.y * 0x1p-32, p.z * 0x1p-32, p.w * 0x1p-32};
        for (int d = 0; d < 4; ++d) {
            EXPECT_EQ(got[d], exact[i][d]) << i << " " << d;
        }
    }
}

// Scrambled or not, and in whatever order: of every 2^k samples one lies in each of 2^k intervals of every dimension,
// and in each elementary rectangle of the first two.
TEST(SobolTest, SamplesFillEveryDimensionEvenly) {
    const RandomSeed seed = RandomSeed::from(7);
    for (const std::uint32_t pixel : {0u, 1u, 77u}) {
        for (const std::uint32_t bounce : {0u, 3u}) {
            for (const std::uint32_t k : {1u, 4u, 8u}) {
                const std::uint32_t count = 1u << k;
                for (const std::uint32_t first : {0u, 5u * count}) {
                    std::array<std::set<std::uint32_t>, 4> cells;
                    std::set<std::uint32_t> rectangles;
                    for (std::uint32_t sample = first; sample < first + count; ++sample) {
                        const RandomWords words = sobol_owen_words(seed.words, {pixel, sample, bounce, 0});
                        const std::uint32_t word[] = {words.x, words.y, words.z, words.w};
                        for (int d = 0; d < 4; ++d) {
                            cells[d].insert(word[d] >> (32 - k));
                        }
                        const std::uint32_t half = k / 2;
                        rectangles.insert(((words.x >> (31 - half) >> 1) << 16) | (words.y >> (31 - (k - half)) >> 1));
                    }
                    for (int d = 0; d < 4; ++d) {
                        EXPECT_EQ(cells[d].size(), count) << d;
                    }
                    EXPECT_EQ(rectangles.size(), count);
                }
            }
        }
    }
}

// Two pixels, two bounces, two seeds: unrelated points.
TEST(SobolTest, OtherKeysGiveOtherPoints) {
    const RandomSeed seed = RandomSeed::from(7);
    test::Mean product[3];
    for (std::uint32_t sample = 0; sample < 4096; ++sample) {
        const auto number = [&](const RandomSeed& s, std::uint32_t pixel, std::uint32_t bounce) {
            return unit_interval<double>(sobol_owen_words(s.words, {pixel, sample, bounce, 0}).x) - 0.5;
        };
        const double base = number(seed, 3, 1);
        product[0].add(base * number(seed, 4, 1));
        product[1].add(base * number(seed, 3, 2));
        product[2].add(base * number(RandomSeed::from(8), 3, 1));
    }
    for (const test::Mean& mean : product) {
        EXPECT_NEAR(mean.value(), 0, test::tolerated_errors * mean.standard_error());
    }
}

// Of an integrand that is smooth the error falls as n^-1.5 in one dimension where that of random numbers falls as
// n^-0.5: at 1024 samples it is far below a tenth.
TEST(SobolTest, IntegratesSmoothFunctionsFarBetterThanRandomNumbers) {
    double of_sobol = 0, of_hash = 0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        const RandomSeed seed = RandomSeed::from(9);
        double sums[2] = {0, 0};
        for (std::uint32_t sample = 0; sample < 1024; ++sample) {
            const RandomKey key{pixel, sample, 2, 1};
            int i = 0;
            for (const RandomWords& words : {sobol_owen_words(seed.words, key), pcg4d_words(seed.words, key)}) {
                sums[i++] += std::exp(-unit_interval<double>(words.x) * unit_interval<double>(words.z)) / 1024;
            }
        }
        const double exact = 0.7965995992970531;  // Ein(1), the integral of (1 - e^-t) / t from 0 to 1
        of_sobol += (sums[0] - exact) * (sums[0] - exact);
        of_hash += (sums[1] - exact) * (sums[1] - exact);
    }
    EXPECT_LT(of_sobol, 0.01 * of_hash);
}

template <Feature sampler>
void expect_chosen_alike() {
    RandomSeed seed = RandomSeed::from(11);
    seed.sampler = no_features | sampler;
    for (std::uint32_t i = 0; i < 64; ++i) {
        const RandomKey key{i * 977, i, i % 5, i % 3};
        const RandomWords alone = random_words<Config<float, no_features | sampler>>(seed, key);
        const RandomWords chosen = random_words<Config<float, samplers>>(seed, key);
        EXPECT_EQ((std::array{alone.x, alone.y, alone.z, alone.w}),
                  (std::array{chosen.x, chosen.y, chosen.z, chosen.w}));
    }
}

// A kernel with one sampler and a kernel with all of them draw the same numbers, and those of others differ.
TEST(SamplerTest, IsChosenAtRunTimeAsAtCompileTime) {
    expect_chosen_alike<Feature::philox>();
    expect_chosen_alike<Feature::sobol_owen>();
    expect_chosen_alike<Feature::minstd>();
    const RandomSeed plain = RandomSeed::from(11);
    const RandomKey key{5, 6, 7, 1};
    const RandomWords hash = pcg4d_words(plain.words, key);
    const RandomWords chosen = random_words<Config<float, samplers>>(plain, key);
    EXPECT_EQ((std::array{hash.x, hash.y, hash.z, hash.w}), (std::array{chosen.x, chosen.y, chosen.z, chosen.w}));
    std::set<std::uint32_t> first{hash.x};
    for (const Feature sampler : {Feature::philox, Feature::sobol_owen, Feature::minstd}) {
        RandomSeed seed = plain;
        seed.sampler = no_features | sampler;
        first.insert(random_words<Config<float, samplers>>(seed, key).x);
    }
    EXPECT_EQ(first.size(), 4u);
}

// The defect of cis565's generator, so that it is not lost: numbers of neighbouring blocks of one vertex are one
// stream, so the last number of a block decides the first of the next.
TEST(MinstdTest, BlocksOfAVertexAreOneStream) {
    const RandomSeed seed = RandomSeed::from(3);
    for (std::uint32_t sample = 0; sample < 16; ++sample) {
        const RandomWords a = minstd_words(seed.words, {5, sample, 2, 0});
        const RandomWords b = minstd_words(seed.words, {5, sample, 2, 1});
        EXPECT_EQ((b.x >> 1) + 1, minstd_product((a.w >> 1) + 1, minstd_multiplier));
    }
}

}  // namespace
}  // namespace pt
