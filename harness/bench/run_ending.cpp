#include "harness/bench/run_ending.h"

#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/bench/comparisons.h"
#include "harness/bench/decide.h"
#include "harness/bench/error_book.h"
#include "harness/bench/result_check.h"
#include "harness/bench/retakes.h"
#include "harness/counted.h"
#include "harness/files_read.h"
#include "harness/interrupt.h"
#include "harness/machine/machine.h"
#include "harness/say.h"
#include "harness/write_file.h"

namespace pt {

namespace {

struct Outcome {
    std::size_t failed = 0;
    std::size_t unfinished = 0;  // number of cells that have not failed but lack samples
};

Outcome outcome_of(const RunEnding& ending, const Journal& journal) {
    Outcome outcome;
    for (const Cell& cell : ending.plan.cells) {
        const bool has_failed = journal.has_failed(cell.name);
        const bool is_finished = static_cast<int>(journal.samples(cell.name).size()) >= ending.facts.repetitions;
        outcome.failed += has_failed ? 1u : 0u;
        outcome.unfinished += !has_failed && !is_finished ? 1u : 0u;
    }
    return outcome;
}

int end_interrupted(const RunEnding& ending) {
    fmt::print("go on with: {}\n", command_to_go_on(ending));
    return exit_interrupted;
}

int end_without_result(const RunEnding& ending, const Journal& journal) {
    const std::size_t samples = journal.sample_count();
    fmt::print("{}\n", samples == 0 ? "interrupted before the first sample: no result written"
                                    : fmt::format("interrupted: {} stays as it was, {} holds {} of this run",
                                                  ending.out, journal.file(), counted(samples, "sample")));
    return end_interrupted(ending);
}

// Says why the journal must be kept; empty if the result file was read back unchanged and does not contradict itself.
std::string fault_of_result(const std::string& file, const std::string& text) {
    try {
        if (read_earlier_output(file, largest_result) != text) {
            return file + ": reads otherwise than it was written";
        }
        check_result(file, nlohmann::ordered_json::parse(text));
    } catch (const InputError& error) {
        return error.what();
    } catch (const nlohmann::detail::exception& error) {
        return fmt::format("{}: {}", file, error.what());
    }
    return "";
}

std::string write_result(const RunEnding& ending, const Journal& journal, const std::vector<Comparison>& comparisons,
                         bool completed) {
    RunFacts facts = ending.facts;
    facts.date = iso_date();
    facts.completed = completed;
    for (const Comparison& comparison : comparisons) {
        facts.comparisons.push_back(comparison.facts());
    }
    check_untouched(ending.out, ending.earlier.stamp,
                    fmt::format("{} holds the samples of this run: go on with --resume --overwrite", journal.file()));
    std::string text = result_json(ending.plan, ending.suite, journal, facts);
    write_file(ending.out, text);
    if (completed && ending.earlier.is_kept()) {
        replace_images(ending.out, ending.earlier.images);
    }
    return text;
}

void print_headline(const RunEnding& ending, const Journal& journal, const Outcome& outcome) {
    const std::string cut = outcome.unfinished == 0
                                ? ""
                                : fmt::format("; interrupted with {} unfinished", counted(outcome.unfinished, "cell"));
    const std::string retakes = retakes_in_words(ending.plan, journal, ending.facts.most_retakes);
    const std::string more = decided_in_words(ending.plan, journal, ending.facts.repetitions);
    fmt::print("{}{}", more, more.empty() ? "" : "\n");
    fmt::print("{}\n{}{}{}\n{}, {}, {} failed, {} not applicable{}\n", in_words(disturbance_of(ending.plan, journal)),
               retakes, retakes.empty() ? "" : "\n", ending.out, counted(ending.plan.cells.size(), "cell"),
               counted(journal.sample_count(), "sample"), outcome.failed, ending.plan.not_applicable.size(), cut);
}

}  // namespace

std::string command_to_go_on(const RunEnding& ending) {
    return ending.facts.command_line + (ending.was_resumed ? "" : " --resume");
}

int end_run(const RunEnding& ending, RunJournal& journal) {
    const Journal& known = journal.known();
    const Outcome outcome = outcome_of(ending, known);
    const bool completed = outcome.unfinished == 0;
    if (!completed && ::isatty(STDERR_FILENO) != 0) {
        say("\n");  // ends the progress bar's line, so that output begins on a line of its own
    }
    if (!completed && (known.sample_count() == 0 || ending.earlier.is_kept())) {
        return end_without_result(ending, known);
    }
    const std::vector<Comparison> comparisons = comparisons_of(ending.plan, ending.suite, known);
    const std::string text = write_result(ending, known, comparisons, completed);
    fmt::print("{}", verdict_table(ending.plan, ending.suite, known, comparisons));
    print_headline(ending, known, outcome);
    if (!completed) {
        return end_interrupted(ending);
    }
    remove_partial_files(ending.out);
    if (const std::string fault = fault_of_result(ending.out, text); !fault.empty()) {
        fmt::print("no good result: {}\n{} stays\n", fault, known.file());
        return exit_check_failed;
    }
    journal.finish();
    return outcome.failed == 0 ? exit_good : exit_check_failed;
}

}  // namespace pt
