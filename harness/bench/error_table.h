// The table of a convergence study (error against time) at the end of a run: each cell's error at its last checkpoint,
// and its efficiency. The numbers are those of analysis/ptbench/convergence/last_errors.py, so the table agrees with
// the pages drawn from the result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bench/bootstrap.h"
#include "harness/bench/comparisons.h"

namespace pt {

// The efficiency of a cell relative to its baseline: the baseline's error x time over the cell's.
struct ErrorEfficiency {
    double value = 1;
    std::optional<RatioInterval> interval = {};  // 95 % confidence interval of `value`, by a bootstrap over seeds
};

// The errors of a cell's samples at the last checkpoint, one value for each seed.
struct LastErrors {
    const Cell* cell = nullptr;
    std::vector<double> mse = {}, rel_mse = {};  // mse_dual and rel_mse_dual of each seed; may be below 0
    std::vector<double> ms_per_spp = {};         // times of renders without checkpoints, if measured
    bool is_contended = false;                   // whether other processes disturbed too many renders

    // The efficiency relative to a baseline. None where the mean error of either side is not above 0, or where the two
    // have different numbers of seeds.
    std::optional<ErrorEfficiency> efficiency_by_mse(const LastErrors& baseline) const;
    std::optional<ErrorEfficiency> efficiency_by_rel_mse(const LastErrors& baseline) const;
};

// The last errors of a study's cells, for cells with errors from at least two seeds. If each of these cells has a
// counterpart without checkpoints in the plan, times are those of the counterparts.
std::vector<LastErrors> last_errors(const Plan& plan, const Cells& cells, const Journal& journal);
// Picks the baseline cell of a group: the plainest estimator, of several the one most like the group; null if empty.
const LastErrors* baseline_of(const std::vector<LastErrors>& group, const Journal& journal);
// Groups cells that render the same image (scene and depth of the reference, resolution, backend), in cell order.
std::vector<Cells> by_image(const Cells& cells);

// The table of errors, one line per cell, grouped by image; cells that failed are marked as FAILED.
std::string error_table(const Plan& plan, const Cells& cells, const Journal& journal);

}  // namespace pt
