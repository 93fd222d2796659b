// Has Google Benchmark take the timed samples of a run, interleaved over all cells: a cell is a benchmark, and a sample
// is one of its repetitions.
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
    int most_retakes = 0;                           // largest number of retakes of disturbed samples per cell
    int decide_seconds = 0;                         // time limit for samples that settle open verdicts
    std::vector<std::string> benchmark_flags = {};  // --benchmark_* flags of the command line
    std::string images_folder = {};                 // folder for the images of cells whose study keeps images
    Progress::Lines lines = Progress::Lines::shown;
};

// Initialises Google Benchmark with flags, once in a process, before time_cells. Throws InputError for unknown flags.
void initialize_benchmark(int repetitions, const std::vector<std::string>& flags);

// Takes the samples that the journal lacks of good cells, then retakes disturbed samples (is_disturbed) until none is
// left or a cell reaches most_retakes, then takes further samples for open verdicts (samples_to_decide) within
// decide_seconds, and retakes those that were disturbed. An interrupt stops it. The reason of a cell's failure goes to
// the journal. Throws MachineError if a sample cannot be written.
void time_cells(const Plan& plan, const Suite& suite, const TimingOptions& options, RunJournal& journal,
                SampleTaker& taker, const ErrorBook& errors, const Interrupt& interrupt);

}  // namespace pt
