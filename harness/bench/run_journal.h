// The journal as a run uses it: one thread appends to it, and another thread may end the run at any time.
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
    // Opens the journal like Journal's constructor. `go_on` is the command that continues the run, for crash messages.
    RunJournal(std::string file, const RunIdentity& identity, bool resume,
               const std::vector<std::string>& that_may_differ, std::string go_on);

    const Journal& known() const { return journal_; }
    // Whether the journal says that a cell is prepared and has not failed, so that it may be timed.
    bool is_ok(const Cell& cell) const;
    // The reason why a cell failed; empty if it did not. Precondition: the journal knows the cell.
    std::string failure(const Cell& cell) const;

    void set_cell(const Cell& cell, const CellFacts& facts);
    // Marks a cell that the journal knows as failed.
    void set_failed(const Cell& cell, const std::string& reason);
    // Marks a cell that has not failed yet as failed, and reports the failure on stderr.
    void fail(const Cell& cell, const std::string& reason);
    void add_sample(const Cell& cell, const Sample& sample);
    void retake_sample(const Cell& cell, const Sample& sample);
    // While the returned object lives, a crash of the process marks the cell as failed ("crashed in PLACE: SIGNAL") and
    // prints how to continue.
    LastLine fails_if_crashed(const Cell& cell, const std::string& place) const;

    // Stops all changes to the journal: a thread that appends after this waits until the process ends.
    void close() { mutex_.lock(); }
    // Removes the journal file; to be called when the result file is complete.
    void finish() { journal_.finish(); }

private:
    void begin_session();
    SessionFacts session_facts() const;

    Journal journal_;
    std::string host_name_;
    std::string go_on_;
    std::mutex mutex_;  // a lock held while the journal changes
    bool has_session_ = false;
};

}  // namespace pt
