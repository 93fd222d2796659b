// Completion of command lines: commands, options, axes and choices, tunables, scenes, suites. The shell script
// (`ptbench completion bash`) calls ptbench at every key, so that completions are always up to date.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pt {

// Completions of the last word of `line`, the command line up to the cursor: "ptbench run --ax". In a list,
// "layout=aos,s", a completion is the whole word: "layout=aos,soa". Empty where a file name may be meant.
std::vector<std::string> completions(const CLI::App& app, const std::string& line);

}  // namespace pt
