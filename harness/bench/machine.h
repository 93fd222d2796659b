// What a result needs to say about the machine and the build that it came from.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pt {

// A name for folders: the CPU model and the number of threads, e.g. "amd-epyc-9654-2-threads".
std::string machine_name();

// Keys ("ptbench." prefixed) and values for the context of a result file.
std::vector<std::pair<std::string, std::string>> machine_context();

std::string git_sha();
bool git_dirty();

// The clock of the core that this thread runs on, measured: a chain of additions, one a cycle, against the steady
// clock. Takes about half a millisecond.
double measure_clock_mhz();

}  // namespace pt
