// Consistency checks of samples and results. They are those rules of `python3 -m ptbench validate`
// (analysis/ptbench/io/consistency.py) that a run needs before it continues with a journal, and before it removes one.
#pragma once

#include <string>

#include "harness/json_reader.h"

namespace pt {

// Throws InputError where a result contradicts itself. Every `ok` cell must have each sample once, with plausible
// times; cells that claim the reference's bits must have equal films for each seed, and for the first seed the film of
// their preparation. Throws nlohmann's exceptions if a key is missing.
void check_result(const std::string& file, const nlohmann::ordered_json& result);

}  // namespace pt
