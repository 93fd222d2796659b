// What a study of error against time says at the end of a run: each cell's error at its last checkpoint, and what that
// is worth in time. The numbers are those of analysis/ptbench/convergence/last_errors.py, so the table says what the
// pages drawn from the file will say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bench/bootstrap.h"
#include "harness/bench/comparisons.h"

namespace pt {

// Efficiency of a cell beside its baseline: the baseline's error times time over the cell's.
struct ErrorEfficiency {
    double value = 1;
    std::optional<RatioInterval> interval = {};  // 95 %, bootstrap over seeds
};

// The errors of a cell that has samples, at its last checkpoint, with one value for each seed.
struct LastErrors {
    const Cell* cell = nullptr;
    std::vector<double> mse = {}, rel_mse = {};  // against both halves of the reference; may be below 0
    std::vector<double> ms_per_spp = {};         // of the same renders without checkpoints where those were timed
    bool is_contended = false;                   // those times

    // The efficiency beside a baseline; nothing where either side's mean error is not above 0, or their seeds are not
    // the same.
    std::optional<ErrorEfficiency> efficiency_by_mse(const LastErrors& baseline) const;
    std::optional<ErrorEfficiency> efficiency_by_rel_mse(const LastErrors& baseline) const;
};

// The errors of those of a study's cells that have errors and at least two seeds, with the times of `plan`'s cells
// without checkpoints where every one of them has such.
std::vector<LastErrors> last_errors(const Plan& plan, const Cells& cells, const Journal& journal);
// The cell with the plain estimator that is most like the other cells of the group; null where there is none.
const LastErrors* baseline_of(const std::vector<LastErrors>& group, const Journal& journal);
// Groups cells of one image (the reference's scene and depth, resolution and backend), in the order of the cells.
std::vector<Cells> by_image(const Cells& cells);

// A line a cell, image by image; cells that failed say so.
std::string error_table(const Plan& plan, const Cells& cells, const Journal& journal);

}  // namespace pt
