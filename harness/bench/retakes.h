// Samples that other processes disturbed (is_disturbed) are taken again, each with its seed, so many times a cell at
// most: on a shared machine a run gets an answer, and on one that is never quiet it ends. What was taken before stays
// in the journal and in the result file, apart from the samples that count.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// The indices of the cell's samples that are to be taken again now: the disturbed ones of a cell that has not failed,
// as many as it may still be given of `most`.
std::vector<std::size_t> to_retake(const Cell& cell, const Journal& journal, int most);

// The retakes in words: "retaken: 5 disturbed samples, at most 9 a cell; 1 cell came to that limit", or why none was;
// empty: none was disturbed.
std::string retakes_in_words(const Plan& plan, const Journal& journal, int most);

// The result's ptbench.retakes: the limit and the samples whose places others took.
nlohmann::ordered_json retakes_json(const Plan& plan, const Journal& journal, int most);

}  // namespace pt
