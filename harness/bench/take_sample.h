// One timed sample of a cell: a render with what is measured around it, after a warm-up where it is the first of the
// cell in this process.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "harness/bench/error_book.h"
#include "harness/bench/film_ledger.h"

namespace pt {

struct TakenSample {
    std::string error = {};                // why the sample failed; empty: it did not
    Sample facts = {};                     // for the journal
    std::vector<Snapshot> snapshots = {};  // of a cell with checkpoints
    std::vector<FailedCell> others = {};   // cells whose earlier samples it shows to be wrong
};

class SampleTaker {
public:
    // Takes samples, which are numbered (pt_order) on from those that are in the journal.
    SampleTaker(const Plan& plan, const Journal& journal, std::uint64_t first_seed, FilmLedger& films,
                ErrorBook& errors);

    // The cell's sample `index`. What a render throws is its error.
    TakenSample take(const Cell& cell, std::size_t index);
    // The sample in words, as "sample 2 (seed 3)".
    std::string place_of(std::size_t index) const { return sample_in_words(index, first_seed_ + index); }

private:
    TakenSample render_sample(const Cell& cell, std::size_t index);
    void warm_up(const Cell& cell, RenderRequest request);
    std::string fault(const Cell& cell, std::size_t index, const RenderResult& result, std::vector<FailedCell>& others);

    std::uint64_t first_seed_;
    FilmLedger& films_;
    ErrorBook& errors_;
    std::set<std::string> warm_;  // cells
    std::uint64_t order_ = 0;     // of the next sample, among those of all cells
};

}  // namespace pt
