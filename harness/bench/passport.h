// Makes the passport of a machine: what its chip can do at most, and the suite `passport` run twice, with seeds and
// orders of their own. A verdict counts if both runs agree on it. One file holds everything
// (ptbench-passport.schema.json).
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"

namespace pt {

struct PassportOptions {
    Backend backend = Backend::cpu;
    nlohmann::ordered_json chip = {};  // what the machine's chip can do at most, to be stored in the passport
    std::string out = {};              // name of the passport's file
    std::string command_line = {};     // command line, for the results of both runs and for messages on how to continue
    double sample_ms = 25;             // wanted time of a sample by the fastest integrator, in ms
    bool resume = false;               // go on with an unfinished passport, whose runs are kept in the folder OUT.parts
    bool overwrite = false;            // allow an existing passport to be replaced once the new one is complete
    bool quiet = false;                // show no progress on stderr
};

// The suite with samples per pixel for this machine: powers of two, at which a render of a study's first scene by the
// fastest integrator takes about `sample_ms`. Studies of error against run time stay as they are.
Suite scaled_to_machine(const Suite& suite, Backend backend, double sample_ms);

// Runs `suite` twice and writes the passport; returns the exit code of the worse run. Interrupted, it leaves OUT.parts
// for `resume`. Throws InputError and MachineError.
int make_passport(const Suite& suite, const PassportOptions& options);

}  // namespace pt
