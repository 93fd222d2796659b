#include "harness/bench/run_journal.h"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/bench/progress.h"
#include "harness/machine/machine.h"

namespace pt {

RunJournal::RunJournal(std::string file, const RunIdentity& identity, bool resume,
                       const std::vector<std::string>& that_may_differ, std::string go_on)
    : journal_(std::move(file), identity, resume, that_may_differ),
      host_name_(identity.host_name),
      go_on_(std::move(go_on)) {}

bool RunJournal::is_ok(const Cell& cell) const { return journal_.is_ok(cell.name); }

std::string RunJournal::failure(const Cell& cell) const {
    const CellFacts& facts = *journal_.cell(cell.name);
    return facts.status == CellStatus::failed ? facts.reason : "";
}

void RunJournal::set_cell(const Cell& cell, const CellFacts& facts) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.set_cell(cell.name, facts);
}

void RunJournal::set_failed(const Cell& cell, const std::string& reason) {
    CellFacts facts = *journal_.cell(cell.name);
    facts.fail(reason);
    set_cell(cell, facts);
}

void RunJournal::fail(const Cell& cell, const std::string& reason) {
    if (failure(cell).empty()) {
        set_failed(cell, reason);
        say_below_progress(fmt::format("failed: {}: {}", cell.name, reason));
    }
}

void RunJournal::add_sample(const Cell& cell, const Sample& sample) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.add_sample(cell.name, sample);
}

void RunJournal::retake_sample(const Cell& cell, const Sample& sample) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.retake_sample(cell.name, sample);
}

LastLine RunJournal::fails_if_crashed(const Cell& cell, const std::string& place) const {
    const CellFacts* known = journal_.cell(cell.name);
    CellFacts facts = known != nullptr ? *known : CellFacts{};
    const auto line = [&](const std::string& signal) {
        facts.fail(fmt::format("crashed in {}: {}", place, signal));
        std::vector<Json> lines;
        if (!has_session_) {
            lines.push_back(Journal::session_line(session_facts()));
        }
        lines.push_back(Journal::cell_line(cell.name, facts));
        return journal_.next_lines(lines);
    };
    return {journal_.descriptor(), line,
            fmt::format("ptbench: {} keeps what was measured, and {} as failed\ngo on with: {}\n", journal_.file(),
                        cell.name, go_on_)};
}

SessionFacts RunJournal::session_facts() const {
    return {.date = iso_date(), .host_name = host_name_, .process = ::getpid()};
}

// Begins a session before this process's first entry, so that a refused or complete run leaves the journal as it is.
void RunJournal::begin_session() {
    if (!std::exchange(has_session_, true)) {
        journal_.add_session(session_facts());
    }
}

}  // namespace pt
