#include "harness/bench/run_journal.h"

#include <utility>

#include <unistd.h>

#include "harness/bench/machine.h"

namespace pt {

RunJournal::RunJournal(std::string file, const Json& identity, bool resume,
                       const std::vector<std::string>& that_may_differ)
    : journal_(std::move(file), identity, resume, that_may_differ), host_name_(identity.at("host_name")) {}

bool RunJournal::is_ok(const Cell& cell) const {
    const Json* facts = journal_.cell(cell.name);
    return facts != nullptr && facts->at("status") == "ok";
}

std::string RunJournal::failure(const Cell& cell) const {
    const Json& facts = *journal_.cell(cell.name);
    return facts.at("status") == "failed" ? facts.at("reason").get<std::string>() : "";
}

void RunJournal::set_cell(const Cell& cell, const Json& facts) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.set_cell(cell.name, facts);
}

void RunJournal::set_failed(const Cell& cell, const std::string& reason) {
    Json facts = *journal_.cell(cell.name);
    facts["status"] = "failed";
    facts["reason"] = reason;
    set_cell(cell, facts);
}

void RunJournal::add_sample(const Cell& cell, const Json& sample) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.add_sample(cell.name, sample);
}

void RunJournal::retake_sample(const Cell& cell, const Json& sample) {
    const std::lock_guard lock(mutex_);
    begin_session();
    journal_.retake_sample(cell.name, sample);
}

// Before the first fact that this process finds: one that is refused, or has nothing to do, leaves no trace.
void RunJournal::begin_session() {
    if (!std::exchange(has_session_, true)) {
        journal_.add_session({{"date", iso_date()}, {"host_name", host_name_}, {"process", ::getpid()}});
    }
}

}  // namespace pt
