// Takes more samples for cells whose verdict is UNSURE only because its confidence interval is too wide. The number of
// samples is decided once, from the widths; stopping as soon as a verdict appears would report differences that do not
// exist.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// The most samples that a cell may get while its verdict is open, as a multiple of the run's repetitions.
inline constexpr int most_times_repetitions = 4;

struct WantedSamples {
    const Cell* cell = nullptr;
    std::size_t samples = 0;  // number of samples that the cell shall reach, those in the journal included
};

// How many samples cells with an open verdict, and their baselines, need until their confidence intervals are narrow
// enough to lie within the limits of SAME: at most `most` per cell, and proportionally fewer if all would take longer
// than `seconds`. In the order of the plan.
std::vector<WantedSamples> samples_to_decide(const Plan& plan, const Suite& suite, const Journal& journal,
                                             std::size_t most, double seconds);

// Says how many cells got more samples, as "more samples: 12 cells have 10 to 36, for verdicts that were open by the
// width of their interval"; empty if no cell has more than `repetitions`.
std::string decided_in_words(const Plan& plan, const Journal& journal, int repetitions);

}  // namespace pt
