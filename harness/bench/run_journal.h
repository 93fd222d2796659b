// The journal while a run goes on: one thread adds what it finds, and another may end the run meanwhile.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"
#include "harness/crash.h"

namespace pt {

class RunJournal {
public:
    // Opens the journal of a run, as Journal's constructor does. `go_on`: the command that goes on with the run, for
    // what a crash says.
    RunJournal(std::string file, const RunIdentity& identity, bool resume,
               const std::vector<std::string>& that_may_differ, std::string go_on);

    const Journal& known() const { return journal_; }
    // Whether the cell is prepared and may be timed.
    bool is_ok(const Cell& cell) const;
    // Why the cell, which must be known, has failed; empty: it has not.
    std::string failure(const Cell& cell) const;

    void set_cell(const Cell& cell, const CellFacts& facts);
    // Notes a failure of a cell that is known.
    void set_failed(const Cell& cell, const std::string& reason);
    // Notes a failure of a cell that has not failed yet, and says so on stderr.
    void fail(const Cell& cell, const std::string& reason);
    void add_sample(const Cell& cell, const Sample& sample);
    void retake_sample(const Cell& cell, const Sample& sample);
    // While what this returns lives, a crash leaves the cell as failed ("crashed in PLACE: SIGNAL") and says how to go
    // on.
    LastLine fails_if_crashed(const Cell& cell, const std::string& place) const;

    // Ends all changes: a thread that adds to the journal from now on waits until the process ends.
    void close() { mutex_.lock(); }
    // Removes the journal's file, once the result file is in place.
    void finish() { journal_.finish(); }

private:
    void begin_session();
    SessionFacts session_facts() const;

    Journal journal_;
    std::string host_name_;
    std::string go_on_;
    std::mutex mutex_;  // held while the journal changes
    bool has_session_ = false;
};

}  // namespace pt
