// Which cells of a run are held against which: the same rule for a run that is here and for one of which only the file
// is.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "harness/bench/bootstrap.h"
#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// What a study varies, and the choice that all others are held against.
struct Question {
    std::string axis;  // or a tunable
    std::string baseline;
    bool is_tunable = false;
};

// What comparisons ask of a cell.
struct ComparedCell {
    std::string name;
    std::vector<std::string> studies;
    std::string scene;
    Backend backend = Backend::cpu;
    std::string variant;                            // its shown name
    std::map<std::string, std::string> axes;        // the choice on each
    std::map<std::string, std::uint32_t> tunables;  // all that the choices have, those at their standards too
    std::set<std::string> tuned;                    // the tunables that are not at their standards
    std::uint32_t width = 0, height = 0, depth = 0, spp = 1;
    bool has_failed = false;
    std::optional<Times> times = {};  // nothing: it has no samples, or failed, so that nobody knows what they timed
};

using ComparedCells = std::vector<const ComparedCell*>;

struct ComparedRun {
    std::vector<ComparedCell> cells;
    std::map<std::string, std::string> baselines;  // the choice on each axis where nothing else is asked for

    ComparedCells of_study(const std::string& study) const;
};

// The plan's cells, without times or with those of the journal.
ComparedRun compared_run(const Plan& plan);
ComparedRun compared_run(const Plan& plan, const Journal& journal);
// The cells of a result file: its `benchmarks`, and what its `ptbench` has as `cells` and `baselines`. Throws what
// nlohmann::json does of other values.
ComparedRun compared_run(const nlohmann::ordered_json& rows, const nlohmann::ordered_json& cells,
                         const nlohmann::ordered_json& baselines);

// The question that a study asks; nothing where it compares no choices. `cells` are the study's.
std::optional<Question> question_of(const Study& study, const ComparedCells& cells,
                                    const std::map<std::string, std::string>& baselines);
// The suite with what each study compares, told by the plan's cells where the suite leaves it open: a shard's cells
// might say something else than those of the whole run.
Suite with_questions(Suite suite, const Plan& plan);

// The cell that differs in what the question is about only: equal samples per pixel are preferred, and tunables that
// both cells have are equal, or both at their standards. Null if there is none.
const ComparedCell* baseline_of(const ComparedCell& cell, const ComparedCells& cells, const Question& question);
bool is_baseline(const ComparedCell& cell, const Question& question);

// The times of a cell's samples. Precondition: it has some.
Times times_of(const std::vector<Sample>& samples, std::uint32_t spp, Backend backend);

}  // namespace pt
