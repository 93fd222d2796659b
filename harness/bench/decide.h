// More samples for verdicts that nothing keeps open but the width of their interval. How many is decided once, by
// widths alone, and not by looking again after every sample until a verdict comes: that would find differences where
// there are none.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// Most samples that a cell may have where more are taken, as a multiple of the number that every cell has.
inline constexpr int most_times_repetitions = 4;

struct WantedSamples {
    const Cell* cell = nullptr;
    std::size_t samples = 0;  // in all, more than it has
};

// The samples, at most `most` for each cell, with which intervals would be narrow enough to lie within the limits of
// SAME, for the cells of such verdicts and their baselines; fewer in proportion where all of them would take longer
// than `seconds`. In the order of the plan.
std::vector<WantedSamples> samples_to_decide(const Plan& plan, const Suite& suite, const Journal& journal,
                                             std::size_t most, double seconds);

// "more samples: 12 cells have 10 to 36, for verdicts that were open by the width of their interval"; empty: no cell
// has more than `repetitions`.
std::string decided_in_words(const Plan& plan, const Journal& journal, int repetitions);

}  // namespace pt
