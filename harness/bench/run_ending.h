// How a run ends, complete or interrupted: the result file, the table of verdicts, what can be trusted of it and how to
// go on.
#pragma once

#include <string>

#include "harness/bench/kept_result.h"
#include "harness/bench/result_file.h"
#include "harness/bench/run_journal.h"

namespace pt {

struct RunEnding {
    const Plan& plan;  // what was to be run
    const Suite& suite;
    EarlierResult earlier;
    std::string out;   // the result file
    RunFacts facts;    // `date` and `completed` are those of the end
    bool was_resumed;  // the command line says so already
};

// The call that goes on with the run.
std::string command_to_go_on(const RunEnding& ending);

// Writes and prints it; removes the journal of a run that is complete, once the result is read again from the disk and
// does not contradict itself (exit_check_failed otherwise). A run that is not complete leaves an earlier result as it
// is. Returns the exit code. Throws MachineError where the result cannot be written.
int end_run(const RunEnding& ending, RunJournal& journal);

}  // namespace pt
