// Runs a plan through Google Benchmark: verifies every cell, takes its instrumented pass, then its timed samples,
// interleaved; every fact goes to the journal at once, and the result file is made from the journal.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "harness/bench/shard.h"
#include "harness/bench/suite.h"

namespace pt {

struct RunOptions {
    Backend backend = Backend::cpu;
    std::string out;           // result file
    std::string command_line;  // for the record, and to go on with
    int repetitions = 0;       // 0: the suite's
    int retakes = -1;          // of disturbed samples, at most so many a cell; -1: as many as it has repetitions
    int decide_seconds = -1;   // more samples for open verdicts, for so long; -1: the suite's
    bool resume = false;
    // A result that is there may be replaced, when the new one is complete; without `resume` the journal of an
    // unfinished run makes room for a new run, and is kept under another name.
    bool overwrite = false;
    bool other_host = false;  // resume although the host has another name
    bool quiet = false;       // no progress on stderr
    Shard shard = {};
    std::string reference_cache = {};  // folder that keeps references; empty: none are kept
    bool untuned = false;              // leave tunables at their standards, whatever was found on this machine
    std::uint64_t seed = 1;            // of sample 0; sample i has seed + i
    std::string filter = {};           // regular expression on cell names; empty: all
    std::vector<std::string> benchmark_flags = {};  // --benchmark_*, passed on
    // Time that a sample in flight has to end after an interrupt.
    std::chrono::milliseconds grace = std::chrono::seconds(1);
};

// Returns an exit code: 0, 1 if a cell failed, exit_interrupted. Throws InputError, MachineError.
int run_suite(const Suite& suite, const RunOptions& options);

// The cells that run_suite would run in all its shards. Throws InputError, also where no cell is left.
Plan plan_run(const Suite& suite, const RunOptions& options);
// The cells and what does not apply, as text.
std::string describe_plan(const Plan& plan, int repetitions);

}  // namespace pt
