// Checks that the cells of a bitwise group have the same film, sample by sample: the first film of a sample is noted,
// and those of the other cells must equal it. Sample i has the same seed in all cells.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// The variant whose bits the cell's film must have. One that rounds freely is held to itself: its film must be the same
// every time.
Variant bitwise_reference(const Cell& cell);

class FilmLedger {
public:
    // Starts with the films of the samples that are in the journal.
    FilmLedger(const Plan& plan, const Journal& journal);

    // Notes the film of a cell's sample. Returns what is wrong where its group has another, or nothing.
    std::string note_sample(const Cell& cell, std::size_t index, const std::string& hash);
    // The film of bitwise_reference at the cell's own size, with the first sample's seed and samples_to_prepare();
    // `render` makes it where no cell of the group has.
    const std::string& film_to_prepare(const Cell& cell, const std::function<std::string()>& render);

private:
    struct Entry {
        std::string hash;
        std::string of;  // the cell or the variant that had it first
    };
    std::map<std::pair<std::string, std::size_t>, Entry> films_;  // by group and index of the sample
};

}  // namespace pt
