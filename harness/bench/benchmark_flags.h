// Google Benchmark's flags, as `ptbench run` takes them. The library ends the program with exit code 0 for a value that
// it does not know, so they are checked here, before anything is run.
#pragma once

#include <string>
#include <vector>

namespace pt {

// Checks flags of the form "--benchmark_NAME=VALUE", or "--benchmark_NAME" for a boolean. Throws InputError for a flag
// that Google Benchmark does not have, a value that a flag cannot have, and a flag that would change what is measured.
void check_benchmark_flags(const std::vector<std::string>& flags);

// The environment variables that Google Benchmark takes for its flags: "BENCHMARK_FILTER" and so on.
std::vector<std::string> benchmark_variables();

}  // namespace pt
