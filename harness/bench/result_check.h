// What contradicts itself in samples and results: of the rules of `python3 -m ptbench validate` (analysis/ptbench/io/
// consistency.py) those that a run needs before it goes on with a journal, and before it removes one.
#pragma once

#include <string>

#include "harness/json_reader.h"

namespace pt {

// Throws InputError where a result of a run contradicts itself: each cell that is `ok` has every sample once, with
// times that can be, the cells that claim the reference's bits have one film a seed, and of the first seed the film
// that they were prepared with. Throws nlohmann's exceptions where a key is missing.
void check_result(const std::string& file, const nlohmann::ordered_json& result);

}  // namespace pt
