// What a result needs to say about the machine and the build that it came from.
#pragma once

#include <string>

#include "harness/machine/run_context.h"

namespace pt {

// A name for folders: the CPU model and the number of threads, e.g. "amd-epyc-9654-2-threads".
std::string machine_name();

// What the context of a file says of this machine and build.
MachineContext machine_context();

// The time now, as ISO 8601 in local time, and in seconds since 1970. The clock may be set: it is for dates, never for
// durations.
std::string iso_date();
double seconds_since_1970();

// The version and the commit, as "1.0.0 (commit 0123abc, with changes that are not committed)".
std::string version_text();
std::string git_sha();
bool git_dirty();
// The hash of the sources that decide what an image is (kernels, integrators, samplers, the reading of scenes): 16 hex
// digits.
std::string image_sources_hash();

// The hash (FNV-1a) of the running program's file, which tells two builds of one commit apart.
std::string program_hash();
// The OMP_* and GOMP_* variables of the environment that are set, as "NAME=value" with spaces between.
std::string openmp_environment();

// What else the machine did: CPU time of other processes (and time stolen by a hypervisor's), and how often this
// process had to give up a core. Sampled before and after a render, the difference says whether its time can be
// trusted.
struct ForeignLoad {
    double cpu_ms = 0;  // resolution 10 ms
    long involuntary_switches = 0;

    static ForeignLoad now();
    ForeignLoad operator-(const ForeignLoad& before) const {
        return {cpu_ms - before.cpu_ms, involuntary_switches - before.involuntary_switches};
    }
};

}  // namespace pt
