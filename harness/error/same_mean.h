// Do two variants converge to the same image? A two-sample test between independent runs of each, by statistics that
// are blind in different places (docs/numerics.md 1.7), and how large a difference they saw or would have seen.
//
//   image    mean of the image by channel, Welch's t: sees what is everywhere, however small
//   blocks   means of 16x16 blocks, Welch's t: sees what is in one place
//   squares  sum over pixels of the squared difference, against its expectation without a bias: sees what changes its
//            sign from pixel to pixel, and errors that all runs of a variant share
//   pixel    the largest difference of a pixel, Welch's t: sees a wrong edge or a bright spot
//   support  pixels that are never black in one variant only: sees light from where none can come, or none where some
//            should. For variants that are black equally often only
// and of the tested variant alone: are its samples independent (independence.h)? Each has an equal share of the family
// error (Bonferroni); within one, its units share by Sidak's formula.
//
// No test can tell a lower mean from light so rare that no run has met it. So blocks and pixels count only where both
// means are known to a tenth of themselves, or, for variants that are black equally often, the larger of them.
#pragma once

#include <string>

#include "harness/error/independence.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

struct SameMeanOptions {
    double family_error = limits::family_error;
    // The variants' samples are black equally often: they are drawn in the same way, if with other numbers.
    bool same_sampling = true;
    double confidence = limits::confidence;  // of the intervals, each for itself
};

struct Statistic {
    const char* name = "";
    double p = 1;
    bool applies = true;
    std::string where = {};  // of the unit with the smallest p-value
};

struct ConfidenceInterval {
    double low = 0, high = 0;
};

// A relative difference, tested / baseline - 1; its interval knows the baseline's error too.
struct RelativeDifference {
    double value = 0;
    ConfidenceInterval interval;
    std::string text() const;  // "+1.2 % [0.8, 1.6]"
};

struct SameMeanReport {
    std::array<Statistic, 6> statistics;  // image, blocks, squares, pixel, support, independence
    double level = 0;                     // a p-value below it rejects
    bool same() const;
    const Statistic& strongest() const;

    RelativeDifference image;        // of the mean of the three channels
    RelativeDifference worst_block;  // of that in the block of the smallest p-value among those that count
    std::size_t worst_block_x = 0, worst_block_y = 0;
    std::size_t blocks_counted = 0, blocks = 0, pixels_counted = 0, pixels = 0;
    // Root of the mean squared bias of the blocks that count, relative to their root mean square: unbiased before the
    // root, 0 where that is negative.
    double root_mean_square = 0;
    ConfidenceInterval root_mean_square_interval;
    std::size_t lit_in_tested_only = 0, lit_in_baseline_only = 0;
    Dependence dependence;  // the strongest
    // One line: every p-value, then every effect with its interval.
    std::string text() const;
};

// Precondition: images of one size, as many runs of each, at least three of two parts or more, of seeds that no two
// share.
SameMeanReport test_same_mean(const ImageRuns& tested, const ImageRuns& baseline, const SameMeanOptions& options = {});

}  // namespace pt
