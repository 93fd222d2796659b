// Which cells of a run are held against which, the verdicts on them, which its result file holds, and the table of
// these that stands at the run's end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bench/bootstrap.h"
#include "harness/bench/facts/comparison.h"
#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// What a study varies, and the choice that all others are held against.
struct Question {
    std::string axis;  // or a tunable
    std::string baseline;
    bool is_tunable = false;
};

using Cells = std::vector<const Cell*>;

// The plan's cells of a study.
Cells cells_of_study(const Plan& plan, const std::string& study);
// The question that a study asks; nothing where it compares no choices. `cells` are the study's.
std::optional<Question> question_of(const Study& study, const Cells& cells);
// The cell that differs in what the question is about only: equal samples per pixel are preferred, and tunables that
// both cells have are equal, or both at their standards. Null if there is none.
const Cell* baseline_of(const Cell& cell, const Cells& cells, const Question& question);
bool is_baseline(const Cell& cell, const Question& question);

// The times of a cell's samples. Precondition: it has some.
Times times_of(const Cell& cell, const Journal& journal);

// A cell held against its study's baseline.
struct Comparison {
    std::string study;
    const Cell* cell = nullptr;
    const Cell* baseline = nullptr;  // null: there is none
    std::optional<RatioEstimate> ratio = {};
    TimeVerdict verdict = {};

    ComparisonFacts facts() const;
};
// Every measured cell of each study that compares choices but for its baselines, in the order of the studies and the
// plan.
std::vector<Comparison> comparisons_of(const Plan& plan, const Suite& suite, const Journal& journal);

// A line a cell, by study and scene: median, ratio to the baseline, interval and verdict; below it why verdicts are
// unsure. Cells without samples are left out, but for those that failed. `comparisons` are the run's.
std::string verdict_table(const Plan& plan, const Suite& suite, const Journal& journal,
                          const std::vector<Comparison>& comparisons);

}  // namespace pt
