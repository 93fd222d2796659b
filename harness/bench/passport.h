// Makes the passport of a machine: what its chip can do at most, and the suite `passport` run twice, with its own seeds
// and sample orders in each run. A verdict counts only if both runs agree on it. Everything goes into one file
// (ptbench-passport.schema.json).
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"

namespace pt {

// Wanted time of a sample by the fastest integrator, in ms. On a GPU the slowest cells take 30 to 120 times as long: no
// launch may come near the watchdog's two seconds, and both runs have to fit into five minutes.
constexpr double sample_ms_on(Backend backend) { return backend == Backend::cuda ? 5 : 25; }

struct PassportOptions {
    Backend backend = Backend::cpu;
    std::string machine = {};  // name of the machine or of its GPU, as used for folders in results/
    // Measures the peak rates of the chip, for the file; called after everything else was checked.
    std::function<nlohmann::ordered_json()> chip = {};
    std::string out = {};           // file name of the passport
    std::string command_line = {};  // command line, for the file and to continue the run
    bool resume = false;            // go on with an unfinished passport, whose runs are kept in the folder OUT.parts
    bool overwrite = false;         // allow an existing passport to be replaced once the new one is complete
    bool quiet = false;             // show no progress on stderr
};

// The fewest samples per pixel that fill the queues of a plan's cells: their most samples in flight.
std::uint32_t least_samples(const Plan& plan);

// The suite with the numbers of samples per pixel for this machine: powers of two, with which a render of a study's
// first scene by the fastest integrator takes about `sample_ms`, but least_samples() at least; so equal in studies of
// one scene, resolution and queue length. Studies of error against run time are left as they are.
Suite scaled_to_machine(const Suite& suite, Backend backend, double sample_ms);

// Runs `suite` twice and writes the passport. Returns 0, or 1 if a cell of either run failed; any other exit code is
// that of a run which did not end, and OUT.parts is then kept for `resume`. Throws InputError, also if `resume` finds a
// passport that another program, machine or backend began, and MachineError.
int make_passport(const Suite& suite, const PassportOptions& options);

}  // namespace pt
