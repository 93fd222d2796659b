// The verdicts on the cells that are held against each other, which a result file holds, and the table of these that
// stands at a run's end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bench/compared_run.h"
#include "harness/bench/facts/comparison.h"

namespace pt {

using Cells = std::vector<const Cell*>;

// The plan's cells of a study.
Cells cells_of_study(const Plan& plan, const std::string& study);
// The times of a cell's samples. Precondition: it has some.
Times times_of(const Cell& cell, const Journal& journal);

// A cell held against its study's baseline.
struct Comparison {
    std::string study;
    std::string cell;
    std::optional<std::string> baseline = {};  // its cell; nothing: there is none
    std::optional<RatioEstimate> ratio = {};
    TimeVerdict verdict = {};

    ComparisonFacts facts() const;
};
// Every measured cell of each study that compares choices but for its baselines, in the order of the studies and the
// run's cells.
std::vector<Comparison> comparisons_of(const ComparedRun& run, const std::vector<Study>& studies);
std::vector<Comparison> comparisons_of(const Plan& plan, const Suite& suite, const Journal& journal);

// A line a cell, by study and scene: median, ratio to the baseline, interval and verdict; below it why verdicts are
// unsure. Cells without samples are left out, but for those that failed. `comparisons` are the run's.
std::string verdict_table(const Plan& plan, const Suite& suite, const Journal& journal,
                          const std::vector<Comparison>& comparisons);

}  // namespace pt
