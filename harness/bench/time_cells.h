// Has Google Benchmark take the timed samples of a run, all cells interleaved: a cell is a benchmark, a sample is one
// of its repetitions.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/progress.h"
#include "harness/bench/run_journal.h"
#include "harness/bench/take_sample.h"
#include "harness/interrupt.h"

namespace pt {

struct TimingOptions {
    int repetitions = 1;
    int most_retakes = 0;                           // a cell
    int decide_seconds = 0;                         // more samples for open verdicts, for so long
    std::vector<std::string> benchmark_flags = {};  // --benchmark_*
    std::string images_folder = {};                 // of the cells whose images are kept
    Progress::Lines lines = Progress::Lines::shown;
};

// Sets Google Benchmark's flags; throws InputError for one that it does not know. Once in a process, before time_cells.
void initialize_benchmark(int repetitions, const std::vector<std::string>& flags);

// The samples that the journal lacks of cells that are good, until an interrupt; then those again that were disturbed
// (is_disturbed), round after round until none is, or the cell has been given most_retakes; then more of the cells
// whose verdicts are open (samples_to_decide), for decide_seconds, and of these the disturbed again. A cell that fails
// has its reason in the journal. Throws MachineError where a sample cannot be written.
void time_cells(const Plan& plan, const Suite& suite, const TimingOptions& options, RunJournal& journal,
                SampleTaker& taker, const ErrorBook& errors, const Interrupt& interrupt);

}  // namespace pt
