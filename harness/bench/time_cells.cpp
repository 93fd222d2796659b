#include "harness/bench/time_cells.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "harness/bench/decide.h"
#include "harness/bench/retakes.h"
#include "harness/bench/short_names.h"

namespace pt {

namespace {

// Suppresses Google Benchmark's table, which long cell names make too wide and interleaving leaves unsorted. A run
// prints a table of its own from the journal.
class QuietReporter : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>&) override {}
};

// The expected duration of a sample in milliseconds, from the instrumented pass.
double pass_ms(const Cell& cell, const Journal& journal) {
    const std::optional<InstrumentedFacts>& pass = journal.cell(cell.name)->instrumented;
    const double wall = pass ? pass->wall_ms : 0;
    return std::max(1e-6, wall * cell.spp / cell.samples_to_prepare());
}

struct Ahead {
    std::size_t samples = 0;
    TimeLeft time = {};
};

Ahead ahead_of(const std::vector<const Cell*>& cells, const Journal& journal, int repetitions) {
    Ahead ahead;
    const auto wanted = static_cast<std::size_t>(repetitions);
    for (const Cell* const cell : cells) {
        const std::vector<Sample>& taken = journal.samples(cell->name);
        const std::size_t left = wanted - std::min(taken.size(), wanted);
        ahead.samples += left;
        ahead.time.expect(cell->name, left, pass_ms(*cell, journal));
        for (const Sample& sample : taken) {
            ahead.time.took(cell->name, 1e-3 * sample.end_to_end_ms.value_or(0), false);
        }
    }
    return ahead;
}

// Takes the samples for which Google Benchmark calls, and appends them to the journal.
class CellTimer {
public:
    CellTimer(Ahead ahead, ShortNames names, const TimingOptions& options, RunJournal& journal, SampleTaker& taker,
              const ErrorBook& errors, const Interrupt& interrupt)
        : time_left_(std::move(ahead.time)),
          names_(names),
          progress_("time", std::max<std::size_t>(1, ahead.samples), options.lines),
          lines_(options.lines),
          images_folder_(options.images_folder),
          journal_(journal),
          taker_(taker),
          errors_(errors),
          interrupt_(interrupt) {}

    // The loop over `state` must begin even after an error, and all later repetitions must report the error too,
    // because Google Benchmark 1.7.1 aborts the process otherwise (google/benchmark#2206).
    void benchmark_cell(benchmark::State& state, const Cell& cell, std::size_t index) {
        for (auto iteration : state) {
            (void)iteration;
            std::string error = interrupt_.requested() ? "interrupted" : journal_.failure(cell);
            if (error.empty() && index >= journal_.known().samples(cell.name).size()) {
                error = take_sample(cell, index);
            }
            if (!error.empty()) {
                state.SkipWithError(error.c_str());
                break;
            }
            const Sample& sample = journal_.known().samples(cell.name)[index];
            state.SetIterationTime(1e-3 * sample.wall_ms);
            state.counters[Sample::rays_per_second_key] = sample.rays_per_second;
        }
    }

    // Retakes each disturbed sample once, in random order over all cells, as long as its cell has retakes left. Returns
    // whether there was any.
    bool retake_round(const std::vector<const Cell*>& cells, int most, std::mt19937& random) {
        std::vector<std::pair<const Cell*, std::size_t>> again;
        for (const Cell* const cell : cells) {
            const std::vector<std::size_t> indices = to_retake(*cell, journal_.known(), most);
            std::transform(indices.begin(), indices.end(), std::back_inserter(again),
                           [&](std::size_t index) { return std::pair(cell, index); });
        }
        std::shuffle(again.begin(), again.end(), random);
        Progress progress("retake", std::max<std::size_t>(1, again.size()), lines_);
        for (const auto& [cell, index] : again) {
            if (interrupt_.requested()) {
                return false;
            }
            progress.begin(names_.of(*cell));
            if (journal_.failure(*cell).empty()) {
                if (const TakenSample sample = taken(*cell, index); sample.error.empty()) {
                    journal_.retake_sample(*cell, sample.facts);
                }
            }
            progress.step(names_.of(*cell));
        }
        return !again.empty();
    }

    // Takes further samples for open verdicts, in random order over all cells, until the time for them is used up.
    void take_more(const std::vector<WantedSamples>& wanted, double seconds, std::mt19937& random) {
        std::vector<const Cell*> turns;
        for (const WantedSamples& one : wanted) {
            turns.insert(turns.end(), one.samples - journal_.known().samples(one.cell->name).size(), one.cell);
        }
        std::shuffle(turns.begin(), turns.end(), random);
        const double end = steady_seconds() + seconds;
        Progress progress("more", std::max<std::size_t>(1, turns.size()), lines_);
        for (const Cell* const cell : turns) {
            if (interrupt_.requested() || steady_seconds() > end) {
                return;
            }
            progress.begin(names_.of(*cell));
            if (journal_.failure(*cell).empty()) {
                const TakenSample sample = taken(*cell, journal_.known().samples(cell->name).size());
                if (sample.error.empty()) {
                    journal_.add_sample(*cell, sample.facts);
                }
            }
            progress.step(names_.of(*cell));
        }
    }

private:
    // Takes a sample. An error has been written to the journal already; a good sample is for the caller to append.
    TakenSample taken(const Cell& cell, std::size_t index) {
        TakenSample sample = [&] {
            const LastLine last_line = journal_.fails_if_crashed(cell, taker_.place_of(index));
            return taker_.take(cell, index);
        }();
        for (const FailedCell& other : sample.others) {
            journal_.fail(*other.cell, other.reason);
            time_left_.drop(other.cell->name);
        }
        if (sample.error.empty()) {
            sample.error = fault_of_sample(sample.facts);
        }
        if (!sample.error.empty()) {
            journal_.fail(cell, sample.error);
        }
        return sample;
    }

    // Takes a sample and appends it to the journal; returns the sample's error, or "" if there was none.
    std::string take_sample(const Cell& cell, std::size_t index) {
        progress_.begin(names_.of(cell));
        const double start = steady_seconds();
        const TakenSample sample = taken(cell, index);
        if (!sample.error.empty()) {
            time_left_.drop(cell.name);
        } else {  // a full disk ends the run, and is no failure of the cell
            if (cell.convergence && cell.convergence->images && index == 0) {
                keep_images(cell, sample.snapshots);
            }
            journal_.add_sample(cell, sample.facts);
            time_left_.took(cell.name, steady_seconds() - start);
        }
        progress_.step(names_.of(cell), [this] { return time_left_.seconds(); });
        return sample.error;
    }

    void keep_images(const Cell& cell, const std::vector<Snapshot>& snapshots) {
        CellFacts facts = *journal_.known().cell(cell.name);
        facts.convergence->images = write_images(images_folder_, cell, errors_.reference(cell), snapshots);
        journal_.set_cell(cell, facts);
    }

    TimeLeft time_left_;
    ShortNames names_;
    Progress progress_;
    Progress::Lines lines_;
    const std::string& images_folder_;
    RunJournal& journal_;
    SampleTaker& taker_;
    const ErrorBook& errors_;
    const Interrupt& interrupt_;
};

void register_cell(const Cell& cell, CellTimer& timer) {
    // Google Benchmark calls the lambda once per repetition; `next` counts the calls, which gives the sample's index.
    benchmark::RegisterBenchmark(cell.name.c_str(),
                                 [&timer, &cell, next = std::make_shared<std::size_t>(0)](benchmark::State& state) {
                                     timer.benchmark_cell(state, cell, (*next)++);
                                 })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

void initialize_benchmark(int repetitions, const std::vector<std::string>& flags) {
    // Google Benchmark keeps the pointer to the program's name.
    static std::vector<std::string> arguments;
    arguments = {"ptbench", fmt::format("--benchmark_repetitions={}", repetitions),
                 "--benchmark_enable_random_interleaving=true", "--benchmark_display_aggregates_only=true"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    std::vector<char*> argv;
    for (std::string& argument : arguments) {
        argv.push_back(argument.data());
    }
    int argc = static_cast<int>(argv.size());
    benchmark::Initialize(&argc, argv.data());
    if (argc > 1) {
        throw InputError("command line", "flag", "\"" + std::string(argv[1]) + "\"",
                         "Google Benchmark's --benchmark_* flags");
    }
}

void time_cells(const Plan& plan, const Suite& suite, const TimingOptions& options, RunJournal& journal,
                SampleTaker& taker, const ErrorBook& errors, const Interrupt& interrupt) {
    if (interrupt.requested()) {
        return;
    }
    std::vector<const Cell*> cells;
    for (const Cell& cell : plan.cells) {
        if (journal.is_ok(cell)) {
            cells.push_back(&cell);
        }
    }
    CellTimer timer(ahead_of(cells, journal.known(), options.repetitions), ShortNames(plan), options, journal, taker,
                    errors, interrupt);
    benchmark::ClearRegisteredBenchmarks();
    for (const Cell* const cell : cells) {
        register_cell(*cell, timer);
    }
    QuietReporter reporter;
    const bool own_format = std::any_of(options.benchmark_flags.begin(), options.benchmark_flags.end(),
                                        [](const std::string& flag) { return flag.starts_with("--benchmark_format"); });
    benchmark::RunSpecifiedBenchmarks(own_format ? nullptr : &reporter);
    std::mt19937 random;  // fixed seed, so that samples have the same order in every run
    const auto retake = [&] {
        while (timer.retake_round(cells, options.most_retakes, random)) {
        }
    };
    retake();
    const auto most = static_cast<std::size_t>(options.repetitions * most_times_repetitions);
    if (options.decide_seconds > 0 && !interrupt.requested()) {
        timer.take_more(samples_to_decide(plan, suite, journal.known(), most, options.decide_seconds),
                        options.decide_seconds, random);
        retake();
    }
}

}  // namespace pt
