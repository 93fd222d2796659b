// What may follow what was typed: commands, options, axes and their choices, tunables, scenes, suites. The shell's
// script
// (`ptbench completion bash`) asks at every key, so that it never goes stale.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pt {

// The words that begin as the last one of `line` does, which is a command line up to the cursor: "ptbench run --ax". Of
// a list, "layout=aos,s", the whole word: "layout=aos,soa". Empty where a file may be meant.
std::vector<std::string> completions(const CLI::App& app, const std::string& line);

}  // namespace pt
