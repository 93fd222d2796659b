#include "harness/bench/run_ending.h"

#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/bench/error_book.h"
#include "harness/bench/machine.h"
#include "harness/interrupt.h"
#include "harness/write_file.h"

namespace pt {

namespace {

struct Outcome {
    std::size_t failed = 0;
    std::size_t unfinished = 0;  // cells that lack samples, and have not failed
};

Outcome outcome_of(const RunEnding& ending, const Journal& journal) {
    Outcome outcome;
    for (const Cell& cell : ending.plan.cells) {
        const Json* facts = journal.cell(cell.name);
        const bool has_failed = facts != nullptr && facts->at("status") == "failed";
        const bool is_finished = static_cast<int>(journal.samples(cell.name).size()) >= ending.facts.repetitions;
        outcome.failed += has_failed ? 1u : 0u;
        outcome.unfinished += !has_failed && !is_finished ? 1u : 0u;
    }
    return outcome;
}

int end_interrupted(const RunEnding& ending) {
    fmt::print("go on with: {}{}\n", ending.facts.command_line, ending.was_resumed ? "" : " --resume");
    return exit_interrupted;
}

int end_without_result(const RunEnding& ending, const Journal& journal) {
    const std::size_t samples = journal.sample_count();
    fmt::print("{}\n", samples == 0 ? "interrupted before the first sample: no result written"
                                    : fmt::format("interrupted: {} stays as it was, {} holds {} samples of this run",
                                                  ending.out, journal.file(), samples));
    return end_interrupted(ending);
}

void write_result(const RunEnding& ending, const Journal& journal, bool completed) {
    RunFacts facts = ending.facts;
    facts.date = iso_date();
    facts.completed = completed;
    check_untouched(ending.out, ending.earlier.stamp,
                    fmt::format("{} holds the samples of this run: go on with --resume --overwrite", journal.file()));
    write_file(ending.out, result_json(ending.plan, ending.suite, journal, facts));
    if (completed && ending.earlier.is_kept()) {
        replace_images(ending.out);
    }
}

void print_table(const Plan& plan, const Journal& journal) {
    fmt::print("{:>12} {:>7} {:>9}  cell (median of the samples)\n", "ms/spp", "cv", "Mrays/s");
    for (const Cell& cell : plan.cells) {
        std::vector<double> wall, rays;
        for (const Json& sample : journal.samples(cell.name)) {
            wall.push_back(sample.at("pt_wall_ms"));
            rays.push_back(sample.at("pt_rays_per_second"));
        }
        if (!wall.empty()) {
            const Aggregates time = aggregate(wall);
            fmt::print("{:12.4g} {:6.1f}% {:9.2f}  {}\n", time.median / cell.spp, 100 * time.cv,
                       1e-6 * aggregate(rays).median, cell.name);
        }
    }
}

void print_headline(const RunEnding& ending, const Journal& journal, const Outcome& outcome) {
    const std::string cut =
        outcome.unfinished == 0 ? "" : fmt::format("; interrupted with {} cells unfinished", outcome.unfinished);
    fmt::print("{}\n{}\n{} cells, {} samples, {} failed, {} not applicable{}\n",
               in_words(disturbance_of(ending.plan, journal)), ending.out, ending.plan.cells.size(),
               journal.sample_count(), outcome.failed, ending.plan.not_applicable.size(), cut);
}

}  // namespace

int end_run(const RunEnding& ending, RunJournal& journal) {
    const Journal& known = journal.known();
    const Outcome outcome = outcome_of(ending, known);
    const bool completed = outcome.unfinished == 0;
    if (!completed && ::isatty(STDERR_FILENO) != 0) {
        fmt::print(stderr, "\n");  // after the line of progress that stands there
    }
    if (!completed && (known.sample_count() == 0 || ending.earlier.is_kept())) {
        return end_without_result(ending, known);
    }
    write_result(ending, known, completed);
    print_table(ending.plan, known);
    print_headline(ending, known, outcome);
    if (!completed) {
        return end_interrupted(ending);
    }
    remove_partial_files(ending.out);
    journal.finish();
    return outcome.failed == 0 ? exit_good : exit_check_failed;
}

}  // namespace pt
