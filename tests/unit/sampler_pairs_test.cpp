// Dependence between the numbers of a sampler, which no test of single numbers sees: two numbers from one hash are
// each uniform, and estimates that use both are wrong.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/rng.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using Words = std::array<std::uint32_t, 4>;

Words words_of(FeatureSet sampler, const RandomKey& key) {
    RandomSeed seed = RandomSeed::from(21);
    seed.sampler = sampler;
    const RandomWords words = random_words<Config<float, samplers>>(seed, key);
    return {words.x, words.y, words.z, words.w};
}

// The places in paths whose numbers are compared: the camera, first and later hits, the last that Halton's table has.
constexpr std::uint32_t bounces[] = {0, 1, 2, 7, 15};
constexpr std::size_t numbers = std::size(bounces) * 2 * 4;
constexpr std::size_t pairs_of_numbers = numbers * (numbers - 1) / 2;
constexpr std::uint32_t pixels = 1u << 17;

std::string name_of(std::size_t number) {
    return "bounce " + std::to_string(bounces[number / 8]) + " block " + std::to_string(number / 4 % 2) + " word " +
           std::to_string(number % 4);
}

// In which sixteenth of the unit interval a number lies, for every pixel.
using Sixteenths = std::vector<std::uint8_t>;

std::vector<Sixteenths> sixteenths_of(FeatureSet sampler, std::uint32_t sample) {
    std::vector<Sixteenths> all(numbers, Sixteenths(pixels));
    for (std::size_t block = 0; block < numbers / 4; ++block) {
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
            const RandomKey key{pixel, sample, bounces[block / 2], static_cast<std::uint32_t>(block % 2)};
            const Words words = words_of(sampler, key);
            for (std::size_t d = 0; d < 4; ++d) {
                all[4 * block + d][pixel] = static_cast<std::uint8_t>(words[d] >> 28);
            }
        }
    }
    return all;
}

double p_value_of_independence(const Sixteenths& a, const Sixteenths& b) {
    std::vector<std::uint64_t> counts(256);
    for (std::size_t pixel = 0; pixel < a.size(); ++pixel) {
        ++counts[std::size_t{16} * a[pixel] + b[pixel]];
    }
    return test::chi_square_test(counts);
}

// The smallest p-value of all pairs is held to Bonferroni's bound, alpha divided by their number: it is below that by
// chance with a probability of alpha at most, however the pairs depend on each other.
void expect_independent_pairs(FeatureSet sampler, std::uint32_t sample) {
    const std::vector<Sixteenths> all = sixteenths_of(sampler, sample);
    double least = 1;
    std::string worst;
    for (std::size_t a = 0; a < numbers; ++a) {
        for (std::size_t b = a + 1; b < numbers; ++b) {
            const double p_value = p_value_of_independence(all[a], all[b]);
            if (p_value < least) {
                least = p_value;
                worst = name_of(a) + " and " + name_of(b);
            }
        }
    }
    EXPECT_GT(least, test::chi_square_alpha / pairs_of_numbers) << worst << ", sample " << sample;
}

struct Sampler {
    const char* name;
    FeatureSet feature;
};

class IndependentPairsTest : public testing::TestWithParam<Sampler> {};

// Any two numbers of a path, seen over the pixels. Of sample 0 Halton's digits are scrambling alone. cis565's generator
// is no part of this: its numbers depend on each other (MinstdTest in sampler_test.cpp).
TEST_P(IndependentPairsTest, OverPixels) {
    expect_independent_pairs(GetParam().feature, 0);
    expect_independent_pairs(GetParam().feature, 5);
}

constexpr Sampler independent_samplers[] = {{"pcg4d", no_features},
                                            {"philox", set_of(Feature::philox)},
                                            {"sobol_owen", set_of(Feature::sobol_owen)},
                                            {"sobol_rotated", set_of(Feature::sobol_rotated)},
                                            {"pmj02", set_of(Feature::pmj02)},
                                            {"halton", set_of(Feature::halton)}};

INSTANTIATE_TEST_SUITE_P(Samplers, IndependentPairsTest, testing::ValuesIn(independent_samplers),
                         [](const auto& sampler) { return sampler.param.name; });

// A pixel shuffles the order of its samples, so one of them is uniform in two dimensions even where both are scrambled
// alike: that shows in several samples of a pixel only. Of Sobol's points four in a row lie one in each quarter of
// every dimension. For the eight numbers of a surface hit, the quarters of those four:
using Quarters = std::array<std::uint32_t, 4>;

std::array<Quarters, 8> quarters_of_four_samples(FeatureSet sampler, std::uint32_t pixel, std::uint32_t first) {
    std::array<Quarters, 8> quarters;
    for (std::uint32_t i = 0; i < 4; ++i) {
        for (std::uint32_t block = 0; block < 2; ++block) {
            const Words words = words_of(sampler, {pixel, first + i, 2, block});
            for (std::size_t d = 0; d < 4; ++d) {
                quarters[std::size_t{4} * block + d][i] = words[d] >> 30;
            }
        }
    }
    return quarters;
}

// The quarter of b for each quarter of a: a permutation, whatever the samples' order.
using Pattern = std::array<std::uint32_t, 4>;

Pattern pattern_of(const Quarters& a, const Quarters& b) {
    Pattern pattern{};
    for (std::size_t i = 0; i < 4; ++i) {
        pattern[a[i]] = b[i];
    }
    return pattern;
}

// The probability of a pattern of numbers a and b.
using Probability = double (*)(std::size_t a, std::size_t b, const Pattern& pattern);

constexpr std::uint32_t pixels_with_patterns = 1u << 13;
constexpr double pairs_of_words = 28;  // of eight

// Patterns that cannot be are not, and the others are as often as they should.
double p_value_of_patterns(const std::map<Pattern, std::uint64_t>& found, std::size_t a, std::size_t b,
                           Probability probability) {
    std::vector<std::uint64_t> counts;
    std::vector<double> probabilities;
    Pattern pattern{0, 1, 2, 3};
    do {
        const double of_pattern = probability(a, b, pattern);
        if (of_pattern > 0) {
            const auto place = found.find(pattern);
            counts.push_back(place == found.end() ? 0 : place->second);
            probabilities.push_back(of_pattern);
        }
    } while (std::next_permutation(pattern.begin(), pattern.end()));
    const std::uint64_t possible = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    return possible == pixels_with_patterns ? test::chi_square_test(counts, probabilities) : 0;
}

void expect_patterns(FeatureSet sampler, std::uint32_t first, Probability probability) {
    std::vector<std::array<Quarters, 8>> of_pixels;
    for (std::uint32_t pixel = 0; pixel < pixels_with_patterns; ++pixel) {
        of_pixels.push_back(quarters_of_four_samples(sampler, pixel, first));
    }
    for (std::size_t a = 0; a < 8; ++a) {
        for (std::size_t b = a + 1; b < 8; ++b) {
            std::map<Pattern, std::uint64_t> found;
            for (const std::array<Quarters, 8>& quarters : of_pixels) {
                ++found[pattern_of(quarters[a], quarters[b])];
            }
            EXPECT_GT(p_value_of_patterns(found, a, b, probability), test::chi_square_alpha / pairs_of_words)
                << "words " << a << " and " << b << " from sample " << first;
        }
    }
}

// Whether the samples of a half of a lie in both halves of b.
bool splits_halves(const Pattern& pattern) { return ((pattern[0] ^ pattern[1]) & 2u) != 0; }

// Scrambling permutes halves, and the quarters of each, of a and of b by themselves, so whatever it can make of a
// pattern is equally often: with one sample in each square of halves, with the same samples in the halves of both, and
// of two blocks' orders that nothing connects, where both kinds are as often.
double probability_in_squares(const Pattern& pattern) { return splits_halves(pattern) ? 1.0 / 16 : 0.0; }
double probability_in_halves(const Pattern& pattern) { return splits_halves(pattern) ? 0.0 : 1.0 / 8; }
double probability_if_shuffled_apart(const Pattern& pattern) { return splits_halves(pattern) ? 1.0 / 32 : 1.0 / 16; }

// Four successive points of Sobol's first dimension and any other have one in each square of halves; the other pairs of
// dimensions have theirs in the same halves.
TEST(SobolTest, WordsAreScrambledApart) {
    const Probability probability = [](std::size_t a, std::size_t b, const Pattern& pattern) {
        if (a / 4 != b / 4) {
            return probability_if_shuffled_apart(pattern);
        }
        return a % 4 == 0 ? probability_in_squares(pattern) : probability_in_halves(pattern);
    };
    expect_patterns(set_of(Feature::sobol_owen), 0, probability);
    expect_patterns(set_of(Feature::sobol_owen), 20, probability);
}

// Four successive samples of a pair have one in each square of halves; another pair has another order.
TEST(Pmj02Test, WordsAreScrambledApart) {
    const Probability probability = [](std::size_t a, std::size_t b, const Pattern& pattern) {
        if (a / 2 != b / 2) {
            return probability_if_shuffled_apart(pattern);
        }
        return probability_in_squares(pattern);
    };
    expect_patterns(set_of(Feature::pmj02), 0, probability);
    expect_patterns(set_of(Feature::pmj02), 20, probability);
}

// Four of Sobol's points lie on a line modulo 1, b = c + a or b = c - a. Two offsets of their own make c any quarter;
// one offset for both would leave the c of a rising line as it is.
TEST(SobolRotatedTest, WordsAreRotatedApart) {
    const Probability probability = [](std::size_t, std::size_t, const Pattern& pattern) {
        const std::uint32_t step = pattern[1] - pattern[0];
        const bool is_line = (pattern[2] - pattern[1] - step) % 4 == 0 && (pattern[3] - pattern[2] - step) % 4 == 0;
        return is_line ? 1.0 / 8 : 0.0;
    };
    expect_patterns(set_of(Feature::sobol_rotated), 0, probability);
    expect_patterns(set_of(Feature::sobol_rotated), 20, probability);
}

}  // namespace
}  // namespace pt
