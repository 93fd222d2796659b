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

// The error of a smooth integrand falls as n^-1.5 in one dimension where that of random numbers falls as n^-0.5: at
// 1024 samples it is far below a tenth.
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

// The first 2^k of Sobol's numbers are the multiples of 2^-k in every dimension, and a rotation keeps their distances.
TEST(SobolRotatedTest, ARotationKeepsTheDistancesOfSobolsNumbers) {
    const RandomSeed seed = RandomSeed::from(7);
    for (const std::uint32_t pixel : {0u, 77u}) {
        for (const std::uint32_t first : {0u, 3u * 256}) {
            std::array<std::vector<std::uint32_t>, 4> words;
            for (std::uint32_t sample = first; sample < first + 256; ++sample) {
                const RandomWords of = sobol_rotated_words(seed.words, {pixel, sample, 2, 1});
                const std::uint32_t word[] = {of.x, of.y, of.z, of.w};
                for (int d = 0; d < 4; ++d) {
                    words[d].push_back(word[d]);
                }
            }
            for (std::vector<std::uint32_t>& of : words) {
                std::sort(of.begin(), of.end());
                for (std::size_t i = 1; i < of.size(); ++i) {
                    ASSERT_EQ(of[i] - of[i - 1], 1u << 24) << i;
                }
            }
        }
    }
}

// (0, 2): of every 2^k samples one lies in each elementary rectangle of area 2^-k, whatever its sides, in both pairs.
TEST(Pmj02Test, EverySquareAndSliverHasOneSample) {
    const RandomSeed seed = RandomSeed::from(7);
    for (const std::uint32_t pixel : {0u, 77u}) {
        for (const std::uint32_t k : {1u, 4u, 7u}) {
            for (const std::uint32_t first : {0u, 5u << k}) {
                for (std::uint32_t of_x = 0; of_x <= k; ++of_x) {
                    std::set<std::uint64_t> rectangles[2];
                    for (std::uint32_t sample = first; sample < first + (1u << k); ++sample) {
                        const RandomWords words = pmj02_words(seed.words, {pixel, sample, 3, 0});
                        const auto place = [&](std::uint64_t x, std::uint64_t y) {
                            return (x >> (32 - of_x) << 32) | (y >> (32 - (k - of_x)));
                        };
                        rectangles[0].insert(place(words.x, words.y));
                        rectangles[1].insert(place(words.z, words.w));
                    }
                    EXPECT_EQ(rectangles[0].size(), 1u << k) << of_x;
                    EXPECT_EQ(rectangles[1].size(), 1u << k) << of_x;
                }
            }
        }
    }
}

// The two pairs of a block are unrelated: the second is not the first in another scrambling of the same order.
TEST(Pmj02Test, PairsAreShuffledApart) {
    const RandomSeed seed = RandomSeed::from(7);
    test::Mean product;
    for (std::uint32_t pixel = 0; pixel < 4096; ++pixel) {
        const RandomWords a = pmj02_words(seed.words, {pixel, 0, 1, 0});
        const RandomWords b = pmj02_words(seed.words, {pixel, 1, 1, 0});
        // Samples 0 and 1 lie in two halves, in x as in z: whether in the same order is even odds.
        product.add((a.x < b.x) == (a.z < b.z) ? 1.0 : -1.0);
    }
    EXPECT_NEAR(product.value(), 0, test::tolerated_errors * product.standard_error());
}

// The oracle is the Chinese remainder theorem: of 2^2 x 3^2 samples one lies in each box of a quarter by a ninth, and
// of every p^k one in each interval of length p^-k of the dimension with that base.
TEST(HaltonTest, FillsTheIntervalsOfItsBases) {
    const RandomSeed seed = RandomSeed::from(7);
    const auto interval = [](std::uint32_t word, std::uint64_t count) { return (word * count) >> 32; };
    for (const std::uint32_t pixel : {0u, 1u, 77u}) {
        for (const std::uint32_t first : {0u, 36u * 1000003u}) {
            std::set<std::uint64_t> boxes;
            for (std::uint32_t sample = first; sample < first + 36; ++sample) {
                const RandomWords words = halton_words(seed.words, {pixel, sample, 0, 0});
                boxes.insert(interval(words.x, 4) * 9 + interval(words.y, 9));
            }
            EXPECT_EQ(boxes.size(), 36u);
        }
        for (std::uint32_t block = 0; block < 2; ++block) {
            for (const std::uint32_t bounce : {0u, 1u, 7u, 15u}) {
                for (std::uint32_t d = 0; d < 4; ++d) {
                    const std::uint32_t base = prime_number(8 * bounce + 4 * block + d);
                    for (std::uint32_t count = base; count < 5000; count *= base) {
                        std::set<std::uint64_t> intervals;
                        for (std::uint32_t sample = 7 * count; sample < 8 * count; ++sample) {
                            const RandomWords words = halton_words(seed.words, {pixel, sample, bounce, block});
                            const std::uint32_t word[] = {words.x, words.y, words.z, words.w};
                            intervals.insert(interval(word[d], count));
                        }
                        EXPECT_EQ(intervals.size(), count) << base;
                    }
                }
            }
        }
    }
}

// In a base that has more digits than there are samples their first digits are no neighbours: the mean over the first
// 16 samples varies as little over pixels as that of independent ones.
TEST(HaltonTest, FewSamplesAreSpreadInALargeBase) {
    const RandomSeed seed = RandomSeed::from(7);
    test::Mean square;
    for (std::uint32_t pixel = 0; pixel < 1u << 14; ++pixel) {
        double sum = 0;
        for (std::uint32_t sample = 0; sample < 16; ++sample) {
            sum += unit_interval<double>(halton_words(seed.words, {pixel, sample, 15, 1}).w) - 0.5;
        }
        square.add(sum * sum / 16);
    }
    EXPECT_LT(square.value(), 1.0 / 12 + test::tolerated_errors * square.standard_error());
}

// Beyond the table, and within bodies, it is the hash.
TEST(HaltonTest, HasDimensionsUpToTheFifteenthHit) {
    const RandomSeed seed = RandomSeed::from(7);
    for (const RandomKey& key : {RandomKey{3, 5, 16, 0}, RandomKey{3, 5, 2, 2}, RandomKey{3, 5, 1, 9}}) {
        const RandomWords halton = halton_words(seed.words, key), hash = pcg4d_words(seed.words, key);
        EXPECT_EQ((std::array{halton.x, halton.y, halton.z, halton.w}), (std::array{hash.x, hash.y, hash.z, hash.w}));
    }
    EXPECT_NE(halton_words(seed.words, {3, 5, 15, 1}).w, pcg4d_words(seed.words, {3, 5, 15, 1}).w);
    EXPECT_EQ(prime_number(halton_dimensions - 1), 719u);
}

// One sample of many pixels is uniform, which makes every estimate unbiased: the mean, and that of a wave.
template <class Words>
void expect_uniform_over_pixels(const Words& words_of, std::uint32_t bounce) {
    std::array<test::Mean, 4> means;
    std::array<test::Mean, 4> waves;
    for (std::uint32_t pixel = 0; pixel < 1u << 16; ++pixel) {
        const RandomWords words = words_of(RandomKey{pixel, 5, bounce, 1});
        const std::uint32_t word[] = {words.x, words.y, words.z, words.w};
        for (int d = 0; d < 4; ++d) {
            means[d].add(unit_interval<double>(word[d]));
            waves[d].add(std::cos(2 * 3.14159265358979323846 * unit_interval<double>(word[d])));
        }
    }
    for (int d = 0; d < 4; ++d) {
        EXPECT_NEAR(means[d].value(), 0.5, test::tolerated_errors * means[d].standard_error()) << d;
        EXPECT_NEAR(waves[d].value(), 0, test::tolerated_errors * waves[d].standard_error()) << d;
    }
}

TEST(SamplerTest, OneSampleIsUniformOverPixels) {
    const RandomWords seed = RandomSeed::from(21).words;
    for (const std::uint32_t bounce : {1u, 8u, 15u}) {
        expect_uniform_over_pixels([&](const RandomKey& key) { return halton_words(seed, key); }, bounce);
        expect_uniform_over_pixels([&](const RandomKey& key) { return pmj02_words(seed, key); }, bounce);
        expect_uniform_over_pixels([&](const RandomKey& key) { return sobol_rotated_words(seed, key); }, bounce);
        expect_uniform_over_pixels([&](const RandomKey& key) { return sobol_owen_words(seed, key); }, bounce);
    }
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
    expect_chosen_alike<Feature::sobol_rotated>();
    expect_chosen_alike<Feature::pmj02>();
    expect_chosen_alike<Feature::halton>();
    const RandomSeed plain = RandomSeed::from(11);
    const RandomKey key{5, 6, 7, 1};
    const RandomWords hash = pcg4d_words(plain.words, key);
    const RandomWords chosen = random_words<Config<float, samplers>>(plain, key);
    EXPECT_EQ((std::array{hash.x, hash.y, hash.z, hash.w}), (std::array{chosen.x, chosen.y, chosen.z, chosen.w}));
    std::set<std::uint32_t> last{hash.w};
    for (const Feature sampler : {Feature::philox, Feature::sobol_owen, Feature::minstd, Feature::sobol_rotated,
                                  Feature::pmj02, Feature::halton}) {
        RandomSeed seed = plain;
        seed.sampler = no_features | sampler;
        last.insert(random_words<Config<float, samplers>>(seed, key).w);
    }
    EXPECT_EQ(last.size(), 7u);
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
