// Are the samples of a variant independent? An estimator with a bad generator may have the right mean over all seeds
// and still converge wrongly, or more slowly than its spread says, because errors repeat. What repeats correlates.
#pragma once

#include "harness/error/distributions.h"
#include "harness/error/image_runs.h"

namespace pt {

// A correlation of errors, pooled over the image.
struct Correlation {
    const char* between = "";
    double value = 0;
    double error = 0;  // standard error
    double p = 1;      // of one as large where there is none; a negative one (stratified samples) is no fault
};

struct Independence {
    // Between the halves of a run's samples, neighbouring pixels, and runs whose seeds follow each other.
    std::array<Correlation, 3> correlations;
    double p = 1;  // of the smallest of theirs
    const Correlation& strongest() const;
};

// Precondition: at least three runs, in the order of their seeds.
Independence test_independence(const ImageRuns& runs);

}  // namespace pt
