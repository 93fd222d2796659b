// Are the samples of a variant independent? An estimator with a bad generator may have the right mean over all seeds
// and still converge wrongly, or more slowly than its spread says, because errors repeat. What repeats correlates.
#pragma once

#include "harness/error/distributions.h"
#include "harness/error/image_runs.h"

namespace pt {

// A statistic that is 0 in the mean where samples are independent, pooled over the image.
struct Dependence {
    const char* name = "";
    double value = 0;
    double error = 0;  // standard error
    double p = 1;      // chance of a value as large; a negative one (stratified samples) is no fault
};

struct Independence {
    // Variance of a run in excess of what its parts' variance predicts; correlation of neighbouring pixels;
    // correlation of runs with successive seeds.
    std::array<Dependence, 3> dependences;
    double p = 1;  // of the smallest of theirs
    const Dependence& strongest() const;
};

// Tests whether samples are independent. Precondition: at least three runs of at least two parts, in the order of their
// seeds.
Independence test_independence(const ImageRuns& runs);

}  // namespace pt
