#include "harness/bench/runner.h"
#include "harness/bench/decide.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <regex>
#include <utility>

#include <fmt/format.h>

#include "harness/bench/error_book.h"
#include "harness/bench/film_ledger.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/prepare_cells.h"
#include "harness/bench/result_file.h"
#include "harness/bench/run_ending.h"
#include "harness/bench/run_identity.h"
#include "harness/bench/run_journal.h"
#include "harness/bench/settle_references.h"
#include "harness/bench/time_cells.h"
#include "harness/counted.h"
#include "harness/cuda/backend.h"
#include "harness/files_read.h"
#include "harness/interrupt.h"
#include "harness/machine/cpu_quota.h"
#include "harness/ranks/ranks.h"
#include "harness/ranks/render_on_ranks.h"
#include "harness/say.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt {

std::string journal_of(const std::string& out) { return out + ".journal.jsonl"; }

namespace {

void apply_filter(Plan& plan, const std::string& filter) {
    if (filter.empty()) {
        return;
    }
    const bool negated = filter.front() == '-';
    try {
        const std::regex expression(negated ? filter.substr(1) : filter);
        std::erase_if(plan.cells,
                      [&](const Cell& cell) { return std::regex_search(cell.name, expression) == negated; });
    } catch (const std::regex_error&) {
        throw InputError("--benchmark_filter", "argument", "\"" + filter + "\"", "a regular expression");
    }
}

// Checks that no sample has a seed of a reference image, whose halves must be independent of the measured images.
void check_seeds(const Plan& plan, std::uint64_t first, int repetitions) {
    const bool has_errors = std::any_of(plan.cells.begin(), plan.cells.end(),
                                        [](const Cell& cell) { return cell.convergence.has_value(); });
    for (const std::uint64_t seed : reference_seeds) {
        if (has_errors && seed - first < static_cast<std::uint64_t>(repetitions)) {
            throw InputError("--seed", "argument", fmt::format("{}", first),
                             fmt::format("seeds that do not reach {}, the reference's", seed));
        }
    }
}

// Whether --resume finds nothing to do: the complete result of this very run exists, and its journal is removed.
bool is_done(const RunOptions& options, const EarlierResult& earlier) {
    return options.resume && !std::filesystem::exists(journal_of(options.out)) && earlier.is_of_this_run &&
           earlier.is_complete;
}

// Whether an unfinished run's journal is set aside for a new run: --overwrite without --resume asks for that.
bool starts_over(const RunOptions& options) {
    return options.overwrite && !options.resume && std::filesystem::exists(journal_of(options.out));
}

// Throws InputError if an existing result may not be replaced: --overwrite must be given, or the result must be this
// run's own. (A journal without --resume or --overwrite is refused when it is opened.)
void check_result_file(const RunOptions& options, const EarlierResult& earlier) {
    const bool has_journal = std::filesystem::exists(journal_of(options.out)) && !starts_over(options);
    if (has_journal && !options.resume && earlier.is_kept() && !earlier.is_of_this_run) {
        throw InputError(journal_of(options.out), "journal", "an unfinished run that is to replace " + options.out,
                         "--overwrite --resume, which goes on, or --overwrite, which starts over");
    }
    const bool goes_on = has_journal && (!options.resume || earlier.is_of_this_run || !earlier.is_complete);
    if (!goes_on) {
        check_overwrite(options.out, earlier, options.overwrite);
    }
}

// Refuses an existing file for --benchmark_out, because Google Benchmark truncates it at once.
void check_benchmark_out(const std::vector<std::string>& flags) {
    constexpr std::string_view flag = "--benchmark_out=";
    for (const std::string& argument : flags) {
        if (!argument.starts_with(flag)) {
            continue;
        }
        const std::string file = argument.substr(flag.size());
        check_output_file(file, "--benchmark_out");
        const std::filesystem::path folder = std::filesystem::path(file).parent_path();
        if (std::filesystem::exists(file) || (!folder.empty() && !std::filesystem::is_directory(folder))) {
            throw InputError("--benchmark_out", "file name", "\"" + file + "\", which is there or whose folder is not",
                             "a new file in a folder that is there");
        }
    }
}

// The run's identity for its result file, and for a shard the positions of its cells in the whole plan.
RunRecord record_of(const RunIdentity& identity, const Shard& shard, const std::vector<std::size_t>& positions) {
    RunRecord record = record_of(identity);
    if (!shard.is_whole()) {
        record.positions = positions;
    }
    return record;
}

// The keys of a run's identity that may differ on --resume: the host name, with --other-host (sessions record it).
std::vector<std::string> that_may_differ(const RunOptions& options) {
    return options.other_host ? std::vector<std::string>{RunIdentity::host_name_key} : std::vector<std::string>{};
}

// While this object lives, a run that is overdue after an interrupt is ended by `end`, which is called on another
// thread and ends the process; the render that is still in flight is abandoned.
class EndWhenOverdue {
public:
    EndWhenOverdue(Interrupt& interrupt, std::function<int()> end) : interrupt_(interrupt) {
        interrupt_.when_overdue(std::move(end));
    }
    ~EndWhenOverdue() { interrupt_.begin_end(); }
    EndWhenOverdue(const EndWhenOverdue&) = delete;
    EndWhenOverdue& operator=(const EndWhenOverdue&) = delete;

private:
    Interrupt& interrupt_;
};

int repetitions_of(const Suite& suite, const RunOptions& options) {
    return options.repetitions > 0 ? options.repetitions : suite.repetitions;
}

int decide_seconds_of(const Suite& suite, const RunOptions& options) {
    return options.decide_seconds >= 0 ? options.decide_seconds : suite.decide_seconds;
}

// The most samples that a cell may get, including those for open verdicts.
int most_repetitions(const Suite& suite, const RunOptions& options) {
    return repetitions_of(suite, options) * (decide_seconds_of(suite, options) > 0 ? most_times_repetitions : 1);
}

// Checks that sample i has the seed first_seed + i, which a lost or duplicate line of the journal would change.
void check_sample_seeds(const Plan& plan, const Journal& journal, std::uint64_t first_seed, int repetitions) {
    for (const Cell& cell : plan.cells) {
        const std::vector<Sample>& samples = journal.samples(cell.name);
        if (samples.size() > static_cast<std::size_t>(repetitions)) {
            throw InputError(journal.file(), cell.name, fmt::format("{} samples", samples.size()),
                             fmt::format("at most {}; remove the file to start over", repetitions));
        }
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (samples[i].seed != first_seed + i) {
                throw InputError(
                    journal.file(), cell.name, fmt::format("sample {} with seed {}", i, samples[i].seed),
                    fmt::format("seed {}, as ptbench wrote it; remove the file to start over", first_seed + i));
            }
        }
    }
}

void say_what_was_dropped(const Journal& journal) {
    if (journal.dropped_bytes() != 0) {
        say_below_progress(
            fmt::format("{}: its last line was cut off after {} bytes and is dropped; the run goes on from "
                        "the lines before it",
                        journal.file(), journal.dropped_bytes()));
    }
}

// Refuses variants that cannot be split over MPI ranks, before anything is run.
void check_ranks(const Plan& plan) {
    for (const Cell& cell : plan.cells) {
        const std::string reason = why_not_split(cell.variant, cell.backend);
        if (ranks().count > 1 && !reason.empty()) {
            throw InputError(cell.name, "ranks", fmt::format("{}", ranks().count), "one: " + reason);
        }
    }
    require_equal_machines(plan.cells.front().backend);
}

// Reports cells that failed or crashed in an earlier process of this run; they are not tried again.
void say_what_failed_before(const Plan& plan, const RunJournal& journal) {
    for (const Cell& cell : plan.cells) {
        const bool is_known = journal.known().cell(cell.name) != nullptr;
        if (const std::string reason = is_known ? journal.failure(cell) : ""; !reason.empty()) {
            say("ptbench: failed before and not tried again (--overwrite starts over): {}: {}\n", cell.name, reason);
        }
    }
}

// The time that a render may continue after Ctrl-C. MPI launchers kill processes after a second.
std::chrono::milliseconds grace_of(const RunOptions& options) {
    constexpr std::chrono::milliseconds most_under_a_launcher(200);
    return ranks().count > 1 ? std::min(options.grace, most_under_a_launcher) : options.grace;
}

// Runs the cells of `ending.plan`, which are all cells of the run or those of one shard.
int run_part(const RunEnding& ending, const RunIdentity& identity, const RunOptions& options) {
    const Plan& plan = ending.plan;
    const Progress::Lines lines = options.quiet ? Progress::Lines::hidden : Progress::Lines::shown;
    Interrupt interrupt(grace_of(options));
    say_cpu_warnings(options.backend);
    if (starts_over(options)) {
        say("ptbench: the unfinished run that was there is kept: {}\n", set_journal_aside(journal_of(options.out)));
    }
    RunJournal journal(journal_of(options.out), identity, options.resume, that_may_differ(options),
                       command_to_go_on(ending));
    ErrorBook errors(plan, ReferenceMaker(options.reference_cache, {.is_stopped = [&] { return interrupt.requested(); },
                                                                    .says = say_below_progress}));
    say_what_was_dropped(journal.known());
    check_journal(plan, journal.known());
    check_sample_seeds(plan, journal.known(), options.seed, most_repetitions(ending.suite, options));
    say_what_failed_before(plan, journal);
    FilmLedger films(plan, journal.known(), options.seed);
    SampleTaker taker(plan, journal.known(), options.seed, films, errors);
    {
        const EndWhenOverdue overdue(interrupt, [&] {
            journal.close();
            return end_run(ending, journal);
        });
        errors.make_references();
        prepare_cells(plan, options.seed, journal, films, errors, interrupt, lines);
        settle_references(plan, options.out, journal, errors, interrupt);
        if (const int seconds = decide_seconds_of(ending.suite, options); seconds > 0 && !options.quiet) {
            say_below_progress(fmt::format("{} samples a cell, then up to {} s of more where a verdict is open",
                                           ending.facts.repetitions, seconds));
        }
        time_cells(plan, ending.suite,
                   {.repetitions = ending.facts.repetitions,
                    .most_retakes = ending.facts.most_retakes,
                    .decide_seconds = decide_seconds_of(ending.suite, options),
                    .benchmark_flags = options.benchmark_flags,
                    .images_folder = images_folder(options.out, ending.earlier.is_kept()),
                    .lines = lines},
                   journal, taker, errors, interrupt);
    }
    return end_run(ending, journal);
}

}  // namespace

std::string describe_plan(const Plan& plan, int repetitions) {
    std::string text;
    for (const Cell& cell : plan.cells) {
        text += cell.name + "\n";
    }
    for (const NotApplicable& entry : plan.not_applicable) {
        text += fmt::format("n/a: {} on {}: {}\n", shown_name(entry.variant, entry.backend), entry.scene,
                            entry.reason.text);
    }
    return text + fmt::format("{}, {}, {} not applicable\n", counted(plan.cells.size(), "cell"),
                              counted(plan.cells.size() * static_cast<std::size_t>(repetitions), "sample"),
                              plan.not_applicable.size());
}

Plan plan_run(const Suite& suite, const RunOptions& options) {
    // Tuned values exist only for a machine that has the backend; without it, a plan can still be listed.
    const bool is_there = options.backend == Backend::cpu || cuda::not_available().empty();
    const Tuning tuning =
        options.untuned || !is_there ? Tuning() : Tuning::load(tuning_file(options.backend), options.backend);
    Plan plan = make_plan(suite, options.backend, tuning);
    apply_filter(plan, options.filter);
    if (plan.cells.empty()) {
        throw InputError("the run has no cell: " + (plan.not_applicable.empty()
                                                        ? std::string("the filter matches none")
                                                        : "n/a: " + plan.not_applicable.front().reason.text));
    }
    return plan;
}

int run_suite(const Suite& suite, const RunOptions& options) {
    const Plan whole = plan_run(suite, options);
    const std::vector<std::size_t> positions = positions_of(whole, options.shard);
    for (const std::string& chosen : whole.chosen) {
        say("{}\n", chosen);
    }
    check_output_file(options.out);
    check_output_file(journal_of(options.out));
    refuse_source(options.out);
    const int repetitions = repetitions_of(suite, options);
    check_seeds(whole, options.seed, most_repetitions(suite, options));
    check_ranks(whole);
    initialize_benchmark(repetitions, options.benchmark_flags);
    const RunIdentity identity = identity_of(whole, {.suite = suite.name,
                                                     .backend = options.backend,
                                                     .seed = options.seed,
                                                     .repetitions = repetitions,
                                                     .most_repetitions = most_repetitions(suite, options),
                                                     .shard = options.shard});
    const EarlierResult earlier = earlier_result(options.out, record_of(identity));
    if (is_done(options, earlier)) {
        fmt::print("{}\nnothing left to do: this run is complete\n", options.out);
        return earlier.failed_cells > 0 ? exit_check_failed : exit_good;
    }
    check_result_file(options, earlier);
    check_benchmark_out(options.benchmark_flags);
    if (options.resume && !std::filesystem::exists(journal_of(options.out))) {
        say("ptbench: --resume: there is no unfinished run ({}), so this one begins\n", journal_of(options.out));
    }
    const Plan part = part_of(whole, positions);
    const Suite asked = with_questions(suite, whole);
    return run_part({.plan = part,
                     .suite = asked,
                     .earlier = earlier,
                     .out = options.out,
                     .facts = {.command_line = options.command_line,
                               .suite = suite.name,
                               .date = {},
                               .backend = options.backend,
                               .repetitions = repetitions,
                               .most_retakes = options.retakes < 0 ? repetitions : options.retakes,
                               .run = record_of(identity, options.shard, positions)},
                     .was_resumed = options.resume},
                    identity, options);
}

}  // namespace pt
