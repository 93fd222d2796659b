// Facts for results about the machine and the build that produced them.
#pragma once

#include <string>

#include "harness/machine/run_context.h"

namespace pt {

// A machine name for folders: CPU model and number of threads, e.g. "amd-epyc-9654-2-threads".
std::string machine_name();

// The facts about this machine and build for the context of a result file.
MachineContext machine_context();

// The current time, as ISO 8601 local time and in seconds since 1970, for dates only: the clock may be set at any time,
// so it must not measure durations.
std::string iso_date();
double seconds_since_1970();

// The version and the commit, as "1.0.0 (commit 0123abc, with changes that are not committed)".
std::string version_text();
std::string git_sha();
bool git_dirty();
// A hash (16 hex digits) of the sources that determine an image: kernels, integrators, samplers, the scene reader.
std::string image_sources_hash();

// FNV-1a hash of the running program's file, which distinguishes two builds of one commit.
std::string program_hash();
// The OMP_* and GOMP_* environment variables that are set, as "NAME=value" separated by spaces.
std::string openmp_environment();

// Load on the machine besides this process: CPU time of other processes (and time stolen by a hypervisor), and how
// often this process had to give up a core. The difference over a render tells whether its time can be trusted.
struct ForeignLoad {
    double cpu_ms = 0;  // CPU time of other processes in ms, in steps of 10 ms
    long involuntary_switches = 0;

    static ForeignLoad now();
    ForeignLoad operator-(const ForeignLoad& before) const {
        return {cpu_ms - before.cpu_ms, involuntary_switches - before.involuntary_switches};
    }
};

}  // namespace pt
