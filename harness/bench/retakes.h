// Retakes: samples that other processes disturbed (is_disturbed) are taken again with the same seed, up to a limit per
// cell, so that a run on a busy machine gets usable samples and still ends. Replaced samples stay in the journal and in
// the result file, apart from the samples that count.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// The indices of a cell's samples that are to be retaken: the disturbed samples of a cell that has not failed, as many
// as its limit `most` still allows.
std::vector<std::size_t> to_retake(const Cell& cell, const Journal& journal, int most);

// The retakes of a run in words: "retaken: 5 disturbed samples, at most 9 a cell; 1 cell came to that limit", or why
// there were none; empty if no sample was disturbed.
std::string retakes_in_words(const Plan& plan, const Journal& journal, int most);

// The member ptbench.retakes of a result file: the limit per cell, and the samples that were replaced.
nlohmann::ordered_json retakes_json(const Plan& plan, const Journal& journal, int most);

}  // namespace pt
