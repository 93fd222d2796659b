#include "harness/bench/settle_references.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "harness/bench/progress.h"

namespace pt {

namespace {

double expected_mse(const Cell& cell, const Journal& journal) {
    return journal.cell(cell.name)->convergence.value().expected_mse;
}

void check_same_reference(const Cell& cell, const std::string& result_file, const Journal& journal,
                          const Reference& reference, const ConvergenceFacts& known) {
    if (!journal.samples(cell.name).empty() && known.reference_hash() != reference.hash) {
        throw InputError(
            fmt::format("{}: the samples of {} were compared with another reference than {} of {} spp "
                        "a half; remove the journal and start again",
                        result_file, cell.name, reference.name, reference.spp_per_half));
    }
}

void settle_reference(const Cell& cell, const std::string& result_file, RunJournal& journal, const ErrorBook& errors) {
    CellFacts facts = *journal.known().cell(cell.name);
    ConvergenceFacts& known = facts.convergence.value();
    const Reference& reference = errors.reference(cell);
    const Json now = reference.provenance();
    check_same_reference(cell, result_file, journal.known(), reference, known);
    const std::string refusal = errors.refusal(cell, expected_mse(cell, journal.known()));
    if (known.reference == now && refusal.empty()) {
        return;
    }
    known.reference = now;
    if (!refusal.empty()) {
        facts.fail(refusal);
        say_below_progress(fmt::format("failed: {}: {}", cell.name, refusal));
    }
    journal.set_cell(cell, facts);
}

// The smallest expected mse of the cells that are compared with a reference image, by the reference's name.
std::map<std::string, double> smallest_errors(const Plan& plan, const RunJournal& journal, const ErrorBook& errors) {
    std::map<std::string, double> smallest;
    for (const Cell& cell : plan.cells) {
        if (cell.convergence && journal.is_ok(cell)) {
            const double expected = expected_mse(cell, journal.known());
            const auto [known, is_new] = smallest.try_emplace(errors.reference(cell).name, expected);
            known->second = std::min(known->second, expected);
        }
    }
    return smallest;
}

}  // namespace

void settle_references(const Plan& plan, const std::string& result_file, RunJournal& journal, ErrorBook& errors,
                       const Interrupt& interrupt) {
    for (const auto& [name, mse] : smallest_errors(plan, journal, errors)) {
        errors.improve(name, allowed_reference_error * mse);
    }
    for (const Cell& cell : plan.cells) {
        if (cell.convergence && journal.is_ok(cell) && !interrupt.requested()) {
            settle_reference(cell, result_file, journal, errors);
        }
    }
}

}  // namespace pt
