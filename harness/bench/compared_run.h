// Decides which cells are compared with which baseline cell, by one rule for runs in memory and in result files.
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

// What a study compares: an axis or a tunable, and the choice or value on it that is the baseline.
struct Question {
    std::string axis;  // name of the compared axis or tunable
    std::string baseline;
    bool is_tunable = false;
};

// The properties of a cell that decide what it is compared with, and its times.
struct ComparedCell {
    std::string name;
    std::vector<std::string> studies;
    std::string scene;
    Backend backend = Backend::cpu;
    std::string variant;                            // variant name as tables show it
    std::map<std::string, std::string> axes;        // choices of the cell's variant, by axis name
    std::map<std::string, std::uint32_t> tunables;  // values of all tunables of the variant, standard values too
    std::set<std::string> tuned;                    // names of tunables with a value other than the standard
    std::uint32_t width = 0, height = 0, depth = 0, spp = 1;
    bool has_failed = false;
    std::optional<Times> times = {};  // times of the cell's samples; none if the cell failed or has no samples
};

using ComparedCells = std::vector<const ComparedCell*>;

struct ComparedRun {
    std::vector<ComparedCell> cells;
    std::map<std::string, std::string> baselines;  // the backend's baseline choice on each axis

    ComparedCells of_study(const std::string& study) const;
};

// Collects the cells of a plan for comparison, without times or with the times in the journal.
ComparedRun compared_run(const Plan& plan);
ComparedRun compared_run(const Plan& plan, const Journal& journal);
// Collects the cells of a result file for comparison: `rows` is its `benchmarks`; `cells` and `baselines` are members
// of its `ptbench` object. Throws nlohmann::json's exceptions for malformed values.
ComparedRun compared_run(const nlohmann::ordered_json& rows, const nlohmann::ordered_json& cells,
                         const nlohmann::ordered_json& baselines);

// What a study compares, given its cells; none for a study that compares no choices.
std::optional<Question> question_of(const Study& study, const ComparedCells& cells,
                                    const std::map<std::string, std::string>& baselines);
// Returns the suite with `compares` filled in for studies that leave it open. The cells of the whole plan decide,
// because those of one shard might decide otherwise.
Suite with_questions(Suite suite, const Plan& plan);

// Finds the baseline cell of a cell: it differs in the compared axis or tunable only. Cells with the same samples per
// pixel are preferred; tunables that both cells have are equal, or both at their standards. Null if there is none.
const ComparedCell* baseline_of(const ComparedCell& cell, const ComparedCells& cells, const Question& question);
bool is_baseline(const ComparedCell& cell, const Question& question);

// Collects the times of a cell's samples. Precondition: `samples` is not empty.
Times times_of(const std::vector<Sample>& samples, std::uint32_t spp, Backend backend);

}  // namespace pt
