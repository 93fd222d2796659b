// Tests whether two variants converge to the same image: a two-sample test between independent runs of each. Its
// statistics have different blind spots (docs/numerics.md 1.7) and tell which difference they would have seen.
//
//   image    mean of the image by channel, Welch's t: sees any global difference, however small
//   blocks   means of 16x16 blocks, Welch's t: sees local differences
//   squares  sum over pixels of the squared difference, against its expectation without a bias: sees biases that change
//            their sign from pixel to pixel, and errors that all runs of a variant share
//   pixel    the largest difference of a pixel, Welch's t: sees a wrong edge or a bright spot
//   support  pixels that are black in all runs of one variant only: sees light where none should be, or none where
//            some should be. Only for variants whose samples are black equally often
// The last test is of the tested variant alone: whether its samples are independent (independence.h). The tests share
// the family error equally (Bonferroni), and within a test its channels, blocks or pixels share it by Sidak's formula.
//
// No test can tell a lower mean from light so rare that no run has hit it. So blocks and pixels count only if both
// means (for variants that are black equally often, the larger one) have a relative standard error of 0.1 or less.
#pragma once

#include <string>

#include "harness/error/independence.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

struct SameMeanOptions {
    double family_error = limits::family_error;
    // Whether the variants draw samples in the same way, from other random numbers, and so are black equally often.
    bool same_sampling = true;
    double confidence = limits::confidence;  // confidence level of each reported interval, not of all together
};

struct Statistic {
    const char* name = "";
    double p = 1;
    bool applies = true;
    std::string where = {};  // pixel, block or channel with the smallest p-value
};

struct ConfidenceInterval {
    double low = 0, high = 0;
};

// The relative difference of two means, tested / baseline - 1, with an interval that includes the baseline's error.
struct RelativeDifference {
    double value = 0;
    ConfidenceInterval interval;
    std::string text() const;  // "+1.2 % [0.8, 1.6]"
};

struct SameMeanReport {
    std::array<Statistic, 6> statistics;  // p-values of six tests: image, blocks, squares, pixel, support, independence
    double level = 0;                     // significance level: a smaller p-value rejects equal means
    bool same() const;
    const Statistic& strongest() const;

    RelativeDifference image;        // difference of the image's mean over all channels
    RelativeDifference worst_block;  // relative difference in the block with the smallest p-value
    std::size_t worst_block_x = 0, worst_block_y = 0;
    std::size_t blocks_counted = 0, blocks = 0, pixels_counted = 0, pixels = 0;
    // The root mean square bias of the blocks that are tested, relative to their root mean square radiance. The square
    // is an unbiased estimate; where it is negative, 0 is reported.
    double root_mean_square = 0;
    ConfidenceInterval root_mean_square_interval;
    std::size_t lit_in_tested_only = 0, lit_in_baseline_only = 0;
    Dependence dependence;  // strongest dependence between samples of the tested variant
    // A line of text with every p-value, then every effect with its interval.
    std::string text() const;
};

// Tests whether two variants have the same mean image. Precondition: images of one size, equally many runs of each
// variant, at least three, with at least two parts each, and no seed in both.
SameMeanReport test_same_mean(const ImageRuns& tested, const ImageRuns& baseline, const SameMeanOptions& options = {});

}  // namespace pt
