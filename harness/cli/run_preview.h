// Describes what `ptbench run` can compare, for calls without suite, scene or axis.
#pragma once

#include <string>

#include "harness/bench/suite.h"

namespace pt {

// The axes with several choices on the backend, the suites with their numbers of cells, and example calls.
std::string what_run_compares(Backend backend);

// A hint after a run of a single variant, which compares nothing; empty if the plan has several variants.
std::string nothing_to_compare(const Plan& plan);

}  // namespace pt
