// Tests whether the samples of a variant are independent. With a bad random number generator an estimator may have the
// right mean over all seeds and still converge too slowly, because errors repeat. Repeated errors are correlated.
#pragma once

#include "harness/error/distributions.h"
#include "harness/error/image_runs.h"

namespace pt {

// A statistic of dependence between samples, pooled over the image; its expectation is 0 for independent samples.
struct Dependence {
    const char* name = "";
    double value = 0;
    double error = 0;  // standard error of the statistic
    double p = 1;      // one-sided: negative dependence is no fault
};

struct Independence {
    // Excess variance of a run over the prediction from its parts; correlation between the errors of neighbouring
    // pixels; correlation between the errors of runs with successive seeds.
    std::array<Dependence, 3> dependences;
    double p = 1;  // p-value of the three tests of independence together, by Sidak's formula from the smallest
    const Dependence& strongest() const;
};

// Tests whether the samples of a variant are independent. Precondition: at least three runs of at least two parts,
// ordered by seed.
Independence test_independence(const ImageRuns& runs);

}  // namespace pt
