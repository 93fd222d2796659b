// Takes a timed sample of a cell: a render and what is measured around it. The first sample of a cell in a process
// follows a warm-up render.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "harness/bench/error_book.h"
#include "harness/bench/film_ledger.h"

namespace pt {

struct TakenSample {
    std::string error = {};                // why taking the sample failed; empty if it did not
    Sample facts = {};                     // times and counters of the sample, for the journal
    std::vector<Snapshot> snapshots = {};  // films at the checkpoints, if the cell has any
    std::vector<FailedCell> others = {};   // cells whose earlier samples this sample showed to be wrong
};

class SampleTaker {
public:
    // A sample taker that continues the numbering (pt_order) of the samples in the journal.
    SampleTaker(const Plan& plan, const Journal& journal, std::uint64_t first_seed, FilmLedger& films,
                ErrorBook& errors);

    // Takes the cell's sample `index`. An exception of the render becomes the sample's error.
    TakenSample take(const Cell& cell, std::size_t index);
    std::string place_of(std::size_t index) const { return sample_in_words(index, first_seed_ + index); }

private:
    TakenSample render_sample(const Cell& cell, std::size_t index);
    void warm_up(const Cell& cell, RenderRequest request);
    std::string fault(const Cell& cell, std::size_t index, const RenderResult& result, std::vector<FailedCell>& others);

    std::uint64_t first_seed_;
    FilmLedger& films_;
    ErrorBook& errors_;
    std::set<std::string> warm_;  // names of the cells that this process has warmed up
    std::uint64_t order_ = 0;     // position of the next sample among those of all cells
};

}  // namespace pt
