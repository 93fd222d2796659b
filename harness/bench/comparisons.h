// The verdicts of a run's comparisons, which the result file stores, and the table of verdicts that is printed at the
// end of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bench/compared_run.h"
#include "harness/bench/facts/comparison.h"

namespace pt {

using Cells = std::vector<const Cell*>;

Cells cells_of_study(const Plan& plan, const std::string& study);
// Collects the times of a cell's samples. Precondition: the journal has samples of the cell.
Times times_of(const Cell& cell, const Journal& journal);

// The comparison of a cell with the baseline of its study.
struct Comparison {
    std::string study;
    std::string cell;
    std::optional<std::string> baseline = {};  // name of the baseline cell, if there is one
    std::optional<RatioEstimate> ratio = {};
    TimeVerdict verdict = {};

    ComparisonFacts facts() const;
};
// Compares every measured cell of each study with its study's baseline cell, except the baselines themselves. The order
// is that of the studies and of the run's cells.
std::vector<Comparison> comparisons_of(const ComparedRun& run, const std::vector<Study>& studies);
std::vector<Comparison> comparisons_of(const Plan& plan, const Suite& suite, const Journal& journal);

// The table of verdicts, one line per cell, grouped by study and scene: median time, ratio to the baseline, confidence
// interval and verdict, and below it why verdicts are UNSURE. Cells without samples are left out unless they failed.
std::string verdict_table(const Plan& plan, const Suite& suite, const Journal& journal,
                          const std::vector<Comparison>& comparisons);

}  // namespace pt
