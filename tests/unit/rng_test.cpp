// The keyed random numbers: a bijection, in range, and without the dependence between keys that an image would show.
#include "kernels/rng.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::chi_square_alpha;
using test::chi_square_test;

bool operator==(const RandomWords& a, const RandomWords& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

// pcg4d backwards, step by step: that it exists is what makes the keys distinct.
RandomWords inverse_pcg4d(RandomWords v) {
    const auto unmix = [&] {
        v.w -= v.y * v.z;
        v.z -= v.x * v.y;
        v.y -= v.z * v.x;
        v.x -= v.y * v.w;
    };
    unmix();
    v.x ^= v.x >> 16;
    v.y ^= v.y >> 16;
    v.z ^= v.z >> 16;
    v.w ^= v.w >> 16;
    unmix();
    std::uint32_t inverse = 1664525u;  // Newton's iteration doubles the correct bits
    for (int i = 0; i < 5; ++i) {
        inverse *= 2u - 1664525u * inverse;
    }
    for (std::uint32_t* word : {&v.x, &v.y, &v.z, &v.w}) {
        *word = (*word - 1013904223u) * inverse;
    }
    return v;
}

TEST(RngTest, Pcg4dIsABijection) {
    test::Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const RandomWords key{random.word(), random.word(), random.word(), random.word()};
        ASSERT_TRUE(inverse_pcg4d(pcg4d(key)) == key);
    }
    const RandomWords zero{0, 0, 0, 0};
    EXPECT_TRUE(inverse_pcg4d(pcg4d(zero)) == zero);
    EXPECT_FALSE(pcg4d(zero) == zero);
}

// From the definition in Jarzynski and Olano's paper, evaluated by hand in wide integers.
TEST(RngTest, Pcg4dMatchesItsDefinition) {
    const auto reference = [](std::array<std::uint64_t, 4> v) {
        constexpr std::uint64_t mask = 0xffffffffull;
        for (std::uint64_t& word : v) {
            word = (word * 1664525u + 1013904223u) & mask;
        }
        const auto round = [&] {
            v[0] = (v[0] + v[1] * v[3]) & mask;
            v[1] = (v[1] + v[2] * v[0]) & mask;
            v[2] = (v[2] + v[0] * v[1]) & mask;
            v[3] = (v[3] + v[1] * v[2]) & mask;
        };
        round();
        for (std::uint64_t& word : v) {
            word ^= word >> 16;
        }
        round();
        return v;
    };
    test::Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const RandomWords key{random.word(), random.word(), random.word(), random.word()};
        const auto expected = reference({key.x, key.y, key.z, key.w});
        const RandomWords words = pcg4d(key);
        ASSERT_EQ(words.x, expected[0]);
        ASSERT_EQ(words.y, expected[1]);
        ASSERT_EQ(words.z, expected[2]);
        ASSERT_EQ(words.w, expected[3]);
    }
}

TEST(RngTest, KeysOnAGridGiveDistinctWords) {
    const RandomSeed seed = RandomSeed::from(3);
    std::vector<std::array<std::uint32_t, 4>> all;
    for (std::uint32_t pixel = 0; pixel < 128; ++pixel) {
        for (std::uint32_t sample = 0; sample < 32; ++sample) {
            for (std::uint32_t bounce = 0; bounce < 16; ++bounce) {
                for (std::uint32_t block = 0; block < 8; ++block) {
                    const RandomWords words =
                        random_words<Config<float, no_features>>(seed, {pixel, sample, bounce, block});
                    all.push_back({words.x, words.y, words.z, words.w});
                }
            }
        }
    }
    std::sort(all.begin(), all.end());
    EXPECT_TRUE(std::adjacent_find(all.begin(), all.end()) == all.end());
}

TEST(RngTest, SeedsAreWhitened) {
    const RandomSeed zero = RandomSeed::from(0), one = RandomSeed::from(1),
                     high = RandomSeed::from(std::uint64_t{1} << 32);
    EXPECT_FALSE(zero.words == one.words);
    EXPECT_FALSE(zero.words == high.words);
    EXPECT_FALSE(one.words == high.words);
    // The words of neighbouring seeds differ by no simple shift of a key: some 64 of the 128 bits flip.
    const int flipped = __builtin_popcount(zero.words.x ^ one.words.x) +
                        __builtin_popcount(zero.words.y ^ one.words.y) +
                        __builtin_popcount(zero.words.z ^ one.words.z) + __builtin_popcount(zero.words.w ^ one.words.w);
    EXPECT_GT(flipped, 32);
    EXPECT_LT(flipped, 96);
}

TEST(RngTest, UnitIntervalIsInRangeAndExact) {
    EXPECT_EQ(unit_interval<float>(0), 0.0f);
    EXPECT_EQ(unit_interval<float>(0xffffffffu), 1.0f - 0x1p-24f);
    EXPECT_EQ(unit_interval<float>(0x80000000u), 0.5f);
    EXPECT_EQ(unit_interval<double>(0), 0.0);
    EXPECT_EQ(unit_interval<double>(0xffffffffu), 1.0 - 0x1p-32);
    EXPECT_EQ(unit_interval<double>(0x80000000u), 0.5);
    // Both precisions see the same number, up to its length.
    test::Random random(4);
    for (int i = 0; i < 10000; ++i) {
        const std::uint32_t bits = random.word();
        ASSERT_LE(std::abs(unit_interval<double>(bits) - static_cast<double>(unit_interval<float>(bits))), 0x1p-24);
    }
}

TEST(RngTest, PositiveUnitIntervalIsNeverZeroNorAboveOne) {
    EXPECT_EQ(positive_unit_interval<float>(0), 0x1p-33f);
    EXPECT_EQ(positive_unit_interval<double>(0), 0x1p-33);
    EXPECT_EQ(positive_unit_interval<float>(0xffffffffu), 1.0f);
    EXPECT_LT(positive_unit_interval<double>(0xffffffffu), 1.0);
    EXPECT_EQ(positive_unit_interval<double>(0x80000000u), 0.5 + 0x1p-33);
    test::Random random(5);
    for (int i = 0; i < 100000; ++i) {
        const std::uint32_t bits = random.word();
        ASSERT_GT(positive_unit_interval<float>(bits), 0.0f);
        ASSERT_LE(positive_unit_interval<float>(bits), 1.0f);
    }
    // The longest free path is 33 ln 2 = 22.87 mean free paths.
    EXPECT_NEAR(-logarithm(positive_unit_interval<float>(0)), 22.87f, 0.01f);
}

std::array<double, 4> numbers(const RandomSeed& seed, RandomKey key) {
    const RandomWords words = random_words<Config<float, no_features>>(seed, key);
    return {unit_interval<double>(words.x), unit_interval<double>(words.y), unit_interval<double>(words.z),
            unit_interval<double>(words.w)};
}

// numerics.md S44b: the variance over pixels of (mean - 1/2) sqrt(12 N) is 1 to 5 standard errors. A seed hashed from
// iteration XOR pixel gave 1.146.
TEST(RngTest, MeansOverSamplesDisperseLikeIndependentNumbers) {
    constexpr std::uint32_t pixels = 64 * 64, samples = 64;
    const RandomSeed seed = RandomSeed::from(6);
    for (const RandomKey base : {RandomKey{0, 0, 0, random_block::camera_position},
                                 RandomKey{0, 0, 1, random_block::scatter}, RandomKey{0, 0, 2, random_block::scatter},
                                 RandomKey{0, 0, 1, random_block::light}, RandomKey{0, 0, 7, random_block::walk + 5}}) {
        std::array<double, 4> squares{};
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
            std::array<double, 4> sum{};
            for (std::uint32_t sample = 0; sample < samples; ++sample) {
                const auto u = numbers(seed, {pixel, sample, base.bounce, base.block});
                for (std::size_t i = 0; i < 4; ++i) {
                    sum[i] += u[i] - 0.5;
                }
            }
            for (std::size_t i = 0; i < 4; ++i) {
                squares[i] += sum[i] * sum[i] * 12.0 / samples;
            }
        }
        for (const double square : squares) {
            EXPECT_NEAR(square / pixels, 1, 5 * std::sqrt(2.0 / pixels)) << base.bounce << " " << base.block;
        }
    }
}

// numerics.md S44e. Lags of one in each part of the key, and across an image row.
TEST(RngTest, NeighbouringKeysAreUncorrelated) {
    constexpr std::uint32_t count = 1 << 16;
    const RandomSeed seed = RandomSeed::from(7);
    for (const RandomKey lag : {RandomKey{1, 0, 0, 0}, RandomKey{256, 0, 0, 0}, RandomKey{0, 1, 0, 0},
                                RandomKey{0, 0, 1, 0}, RandomKey{0, 0, 0, 1}, RandomKey{1, 1, 0, 0}}) {
        std::array<double, 16> products{};
        for (std::uint32_t i = 0; i < count; ++i) {
            const RandomKey key{i, 3, 2, 0};
            const auto here = numbers(seed, key);
            const auto there = numbers(
                seed, {key.pixel + lag.pixel, key.sample + lag.sample, key.bounce + lag.bounce, key.block + lag.block});
            for (std::size_t a = 0; a < 4; ++a) {
                for (std::size_t b = 0; b < 4; ++b) {
                    products[4 * a + b] += 12 * (here[a] - 0.5) * (there[b] - 0.5);
                }
            }
        }
        for (const double product : products) {
            EXPECT_LT(std::abs(product / count), 5 / std::sqrt(static_cast<double>(count)));
        }
    }
}

TEST(RngTest, TheFourNumbersOfAKeyAreUncorrelated) {
    constexpr std::uint32_t count = 1 << 16;
    const RandomSeed seed = RandomSeed::from(8);
    for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < a; ++b) {
            double product = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto u = numbers(seed, {i, 0, 1, 0});
                product += 12 * (u[static_cast<std::size_t>(a)] - 0.5) * (u[static_cast<std::size_t>(b)] - 0.5);
            }
            EXPECT_LT(std::abs(product / count), 5 / std::sqrt(static_cast<double>(count))) << a << b;
        }
    }
}

TEST(RngTest, PairsFillTheSquare) {
    constexpr std::size_t side = 64;
    const RandomSeed seed = RandomSeed::from(9);
    // A pair within a key, and pairs of one word over neighbouring pixels and samples.
    std::vector<std::uint64_t> within(side * side), over_pixels(side * side), over_samples(side * side);
    const auto cell = [](double u, double v) {
        return static_cast<std::size_t>(u * side) * side + static_cast<std::size_t>(v * side);
    };
    for (std::uint32_t pixel = 0; pixel < 1024; ++pixel) {
        for (std::uint32_t sample = 0; sample < 128; ++sample) {
            const auto u = numbers(seed, {pixel, sample, 1, 0});
            within[cell(u[1], u[2])] += 1;
            if (pixel % 2 == 0) {
                over_pixels[cell(u[1], numbers(seed, {pixel + 1, sample, 1, 0})[1])] += 1;
            }
            if (sample % 2 == 0) {
                over_samples[cell(u[1], numbers(seed, {pixel, sample + 1, 1, 0})[1])] += 1;
            }
        }
    }
    EXPECT_GT(chi_square_test(within), chi_square_alpha);
    EXPECT_GT(chi_square_test(over_pixels), chi_square_alpha);
    EXPECT_GT(chi_square_test(over_samples), chi_square_alpha);
}

TEST(RngTest, SeedsGiveUncorrelatedNumbers) {
    constexpr std::uint32_t count = 1 << 16;
    const RandomSeed one = RandomSeed::from(1), two = RandomSeed::from(2);
    double product = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        product += 12 * (numbers(one, {i, 0, 1, 0})[1] - 0.5) * (numbers(two, {i, 0, 1, 0})[1] - 0.5);
    }
    EXPECT_LT(std::abs(product / count), 5 / std::sqrt(static_cast<double>(count)));
}

}  // namespace
}  // namespace pt
