// What `ptbench run` would compare: said where the call names neither suite nor scene nor axis.
#pragma once

#include <string>

#include "harness/bench/suite.h"

namespace pt {

// The axes that have something to compare on the backend, the suites with their numbers of cells, and calls.
std::string what_run_compares(Backend backend);

// What is said after a run of one variant alone, which compares nothing; empty where the plan holds several.
std::string nothing_to_compare(const Plan& plan);

}  // namespace pt
