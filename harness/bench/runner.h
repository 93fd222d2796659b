// Runs a plan: verifies every cell, runs its instrumented pass, then has Google Benchmark take the timed samples of all
// cells interleaved. Every fact is appended to the journal at once, and the result file is made from the journal.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "harness/bench/shard.h"
#include "harness/bench/suite.h"

namespace pt {

struct RunOptions {
    Backend backend = Backend::cpu;
    std::string out;           // name of the result file
    std::string command_line;  // command line, for the result and to continue the run
    int repetitions = 0;       // samples per cell; 0: the suite's number
    int retakes = -1;          // retakes of disturbed samples per cell; -1: as many as repetitions
    int decide_seconds = -1;   // time limit for samples that settle open verdicts; -1: the suite's
    bool resume = false;
    // Allows an existing result to be replaced once the new one is complete, and, without `resume`, a new run beside an
    // unfinished one, whose journal is kept under another name.
    bool overwrite = false;
    bool other_host = false;  // allow --resume although the host name differs
    bool quiet = false;       // show no progress on stderr
    Shard shard = {};
    std::string reference_cache = {};               // folder of cached reference images; empty: no cache
    bool untuned = false;                           // keep tunables at their standards, ignoring tuned values
    std::uint64_t seed = 1;                         // seed of sample 0; sample i has `seed` + i
    std::string filter = {};                        // regular expression on cell names; empty: all
    std::vector<std::string> benchmark_flags = {};  // --benchmark_* flags for Google Benchmark
    // How long a sample in flight may continue after an interrupt.
    std::chrono::milliseconds grace = std::chrono::seconds(1);
};

// Runs a suite and returns an exit code: 0, 1 if a cell failed, or exit_interrupted. Throws InputError, MachineError.
int run_suite(const Suite& suite, const RunOptions& options);

// The name of the journal of a run whose result file is `out`. A run that ends with a good result removes its journal.
std::string journal_of(const std::string& out);

// The plan of a whole run, in all shards. Throws InputError, also if the plan has no cells.
Plan plan_run(const Suite& suite, const RunOptions& options);
std::string describe_plan(const Plan& plan, int repetitions);

}  // namespace pt
