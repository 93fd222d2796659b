// The end of a run, complete or interrupted: writes the result file, and prints the table of verdicts, what was
// disturbed, and how to continue.
#pragma once

#include <string>

#include "harness/bench/kept_result.h"
#include "harness/bench/result_file.h"
#include "harness/bench/run_journal.h"

namespace pt {

struct RunEnding {
    const Plan& plan;  // cells that the run measures
    const Suite& suite;
    EarlierResult earlier;
    std::string out;   // name of the result file to write
    RunFacts facts;    // facts about the run; `date` and `completed` are set at its end
    bool was_resumed;  // whether the command line has --resume already
};

// The command line that continues an interrupted run.
std::string command_to_go_on(const RunEnding& ending);

// Writes and prints the result and returns the exit code. The journal of a complete run is removed only after the
// result was read back from disk and does not contradict itself (exit_check_failed otherwise). An incomplete run leaves
// an earlier result as it is. Throws MachineError if the result cannot be written.
int end_run(const RunEnding& ending, RunJournal& journal);

}  // namespace pt
