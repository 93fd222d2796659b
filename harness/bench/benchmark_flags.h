// Google Benchmark's flags, as `ptbench run` takes them. The library ends the program with exit code 0 for a value that
// it does not know, so they are checked here, before anything is run.
#pragma once

#include <string>
#include <vector>

namespace pt {

// Throws InputError for a flag that is none of Google Benchmark's, for one that would change what is measured, and for
// a value that the flag cannot have. `flags`: "--benchmark_NAME=VALUE", or without a value where it is true or false.
void check_benchmark_flags(const std::vector<std::string>& flags);

// The environment variables that Google Benchmark takes for its flags: "BENCHMARK_FILTER" and so on.
std::vector<std::string> benchmark_variables();

}  // namespace pt
