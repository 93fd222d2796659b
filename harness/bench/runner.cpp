#include "harness/bench/runner.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <regex>
#include <utility>

#include <unistd.h>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "harness/bench/compile_ahead.h"
#include "harness/bench/cpu_clock.h"
#include "harness/bench/error_book.h"
#include "harness/bench/instrumented.h"
#include "harness/bench/journal.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/machine.h"
#include "harness/bench/progress.h"
#include "harness/bench/result_file.h"
#include "harness/bench/run_identity.h"
#include "harness/bench/verify.h"
#include "harness/cuda/backend.h"
#include "harness/interrupt.h"
#include "harness/write_file.h"

namespace pt {

namespace {

// The size at which a cell is verified before it is timed: enough pixels to meet every object, few enough to be quick.
RenderSettings verification_settings(RenderSettings settings) {
    const double shrink = std::min(1.0, 48.0 / std::max(settings.width, settings.height));
    settings.width = std::max(1u, static_cast<std::uint32_t>(std::lround(settings.width * shrink)));
    settings.height = std::max(1u, static_cast<std::uint32_t>(std::lround(settings.height * shrink)));
    return settings;
}

constexpr std::uint32_t verification_spp = 2;

// All cells whose films must be equal bit for bit.
std::string bitwise_group(const Cell& cell) {
    std::string name = cell.name;
    // Stopping at checkpoints changes no bit, but where numbers follow the order of a queue, whose batches end there.
    if (cell.convergence && !depends_on_order(cell.variant, cell.backend)) {
        name.erase(name.rfind('/'));
    }
    // Two kernels that round freely need not agree: each is a group of its own.
    const Variant variant = fp_relaxed(cell.variant, cell.backend)
                                ? cell.variant
                                : Registry::instance().reference(cell.variant, cell.backend);
    return variant.name() + name.substr(name.find('/'));
}

// Google Benchmark's own table is as wide as our names are long, and under interleaving in the order in which cells
// happen to end: the runner prints its own from the journal.
class QuietReporter : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>&) override {}
};

// Nothing where it cannot be known.
std::optional<double> clock_mhz(Backend backend) {
    return backend == Backend::cuda ? cuda::measure_clock_mhz() : clock_of(measure_clock_evidence());
}

std::string journal_of(const RunOptions& options) { return options.out + ".journal.jsonl"; }

void say(const std::string& line) { fmt::print(stderr, "\n{}\n", line); }

// Of one sample of a cell, or its preparation, beside those of other cells.
double size_of(const Cell& cell, std::uint32_t spp) {
    return static_cast<double>(cell.settings.width) * cell.settings.height * spp;
}

class Runner {
public:
    // `part` is what is run of the whole plan of `identity`: the cells at `positions`.
    Runner(const Suite& suite, Plan part, std::vector<std::size_t> positions, const RunOptions& options,
           int repetitions, const Json& identity, Interrupt& interrupt)
        : suite_(suite),
          plan_(std::move(part)),
          positions_(std::move(positions)),
          options_(options),
          repetitions_(repetitions),
          identity_(identity),
          interrupt_(interrupt),
          earlier_(earlier_result(options.out, run_json(identity))),
          journal_(journal_of(options), identity, options.resume, that_may_differ(options)),
          errors_(plan_, ReferenceMaker(options.reference_cache,
                                        {.is_stopped = [this] { return interrupt_.requested(); }, .says = say})) {
        check_journal(plan_, suite_, journal_);
        for (const Cell& cell : plan_.cells) {
            const std::vector<Json>& samples = journal_.samples(cell.name);
            for (std::size_t index = 0; index < samples.size(); ++index) {
                hashes_.try_emplace({bitwise_group(cell), index}, samples[index].at("film_hash"), cell.name);
                order_ = std::max(order_, samples[index].value("pt_order", std::uint64_t{0}) + 1);
            }
        }
    }

    int run() {
        interrupt_.when_overdue([this] { return abandon(); });
        try {
            errors_.make_references();
            prepare();
            settle_references();
            time_samples();
        } catch (...) {
            interrupt_.begin_end();
            throw;
        }
        interrupt_.begin_end();
        return finish();
    }

private:
    // A host's name may differ where the call says so: the result keeps the names, session by session.
    static std::vector<std::string> that_may_differ(const RunOptions& options) {
        return options.other_host ? std::vector<std::string>{"host_name"} : std::vector<std::string>{};
    }

    // On another thread, while a render goes on that nobody waits for any more; for good.
    int abandon() {
        journal_mutex_.lock();
        return finish();
    }

    void record_cell(const Cell& cell, const Json& facts) {
        const std::lock_guard lock(journal_mutex_);
        begin_session();
        journal_.set_cell(cell.name, facts);
    }
    void record_sample(const Cell& cell, const Json& sample) {
        const std::lock_guard lock(journal_mutex_);
        begin_session();
        journal_.add_sample(cell.name, sample);
    }
    // Before the first fact that this process finds: one that is refused, or has nothing to do, leaves no trace.
    void begin_session() {
        if (!std::exchange(has_session_, true)) {
            journal_.add_session(
                {{"date", iso_date()}, {"host_name", identity_.at("host_name")}, {"process", ::getpid()}});
        }
    }

    bool is_ok(const Cell& cell) const {
        const Json* facts = journal_.cell(cell.name);
        return facts != nullptr && facts->at("status") == "ok";
    }

    // Verification and the instrumented pass, for the cells that the journal does not know yet.
    void prepare() {
        compile_kernels();
        std::vector<const Cell*> unknown;
        TimeLeft time_left;
        for (const Cell& cell : plan_.cells) {
            if (journal_.cell(cell.name) == nullptr) {
                unknown.push_back(&cell);
                time_left.expect(cell.name, 1, size_of(cell, cell.samples_to_prepare()));
            }
        }
        Progress progress("verify", unknown.size(), lines());
        std::map<std::string, Verifier> verifiers;
        for (const Cell* const position : unknown) {
            const Cell& cell = *position;
            if (interrupt_.requested()) {
                return;
            }
            const double start = seconds_now();
            const RenderSettings small = verification_settings(cell.settings);
            const std::string key =
                fmt::format("{}/{}x{}/{}", cell.scene->name, small.width, small.height, small.depth);
            Verifier& verifier =
                verifiers.try_emplace(key, *cell.scene, small, verification_spp, cell.backend).first->second;
            record_cell(cell, prepare_or_fail(cell, verifier));
            time_left.took(cell.name, seconds_now() - start);
            progress.step(cell.name, [&] { return time_left.seconds(); });
        }
    }

    Progress::Lines lines() const { return options_.quiet ? Progress::Lines::hidden : Progress::Lines::shown; }

    // References become as accurate as the cells' expected errors ask for; cells that ask for more than most_spp allows
    // are refused.
    void settle_references() {
        std::map<std::string, double> smallest;
        for (const Cell& cell : plan_.cells) {
            if (cell.convergence && is_ok(cell)) {
                const double expected = expected_mse(cell);
                const auto [known, is_new] = smallest.try_emplace(errors_.reference(cell).name, expected);
                known->second = std::min(known->second, expected);
            }
        }
        for (const auto& [name, mse] : smallest) {
            errors_.improve(name, allowed_reference_error * mse);
        }
        for (const Cell& cell : plan_.cells) {
            if (cell.convergence && is_ok(cell) && !interrupt_.requested()) {
                settle_reference(cell);
            }
        }
    }

    double expected_mse(const Cell& cell) const {
        return journal_.cell(cell.name)->at("convergence").at("expected_mse");
    }

    void settle_reference(const Cell& cell) {
        Json facts = *journal_.cell(cell.name);
        Json& known = facts["convergence"]["reference"];
        const Json now = errors_.reference(cell).provenance();
        if (!journal_.samples(cell.name).empty() && known.at("hash") != now.at("hash")) {
            throw InputError(fmt::format(
                "{}: the samples of {} were compared with another reference than {} of {} spp "
                "a half; remove the journal and start again",
                options_.out, cell.name, errors_.reference(cell).name, errors_.reference(cell).spp_per_half));
        }
        const std::string refusal = errors_.refusal(cell, expected_mse(cell));
        if (known == now && refusal.empty()) {
            return;
        }
        known = now;
        if (!refusal.empty()) {
            facts["status"] = "failed";
            facts["reason"] = refusal;
            say(fmt::format("failed: {}: {}", cell.name, refusal));
        }
        record_cell(cell, facts);
    }

    void compile_kernels() const {
        std::vector<CompileTask> tasks;
        for (const Cell& cell : plan_.cells) {
            if (cell.backend == Backend::cuda && journal_.cell(cell.name) == nullptr) {
                tasks.push_back({cell.scene.get(), cell.variant});
            }
        }
        compile_ahead(tasks);
    }

    // A choice that throws fails its cell, not the run.
    Json prepare_or_fail(const Cell& cell, Verifier& verifier) {
        Json facts;
        try {
            facts = prepare_cell(cell, verifier);
        } catch (const std::exception& exception) {
            facts = {{"status", "failed"}, {"reason", exception.what()}};
        }
        if (facts.at("status") == "failed") {
            fmt::print(stderr, "failed: {}: {}\n", cell.name, facts.at("reason").get<std::string>());
        }
        return facts;
    }

    Json prepare_cell(const Cell& cell, Verifier& verifier) {
        const Verdict verdict = verifier.check(cell.variant);
        const KernelChoice kernel = choose_kernel(*cell.scene, cell.variant, cell.backend);
        Json facts{{"claim_check", verdict.message},
                   {"kernel_features", feature_names(kernel.compiled)},
                   {"specialisation_note", kernel.note()},
                   {"status", verdict.holds ? "ok" : "failed"},
                   {"reason", verdict.holds ? "" : verdict.message}};
        if (!verdict.holds) {
            return facts;
        }
        RenderSettings settings = cell.settings;
        settings.seed = options_.seed;
        // Queues grow and pages are touched in a first render: not in one whose stages are looked at.
        (void)render(*cell.scene,
                     {.variant = cell.variant, .backend = cell.backend, .settings = settings, .samples = 1});
        const RenderResult result = render(*cell.scene, {.variant = cell.variant,
                                                         .backend = cell.backend,
                                                         .settings = settings,
                                                         .samples = cell.samples_to_prepare(),
                                                         .instrument = true});
        if (const std::string& expected = full_size_hash(cell); result.film.hash() != expected) {
            facts["status"] = "failed";
            facts["reason"] = fmt::format("at full size the film {} differs from {} of {}", result.film.hash(),
                                          expected, full_size_reference(cell).name());
            return facts;
        }
        facts.update(facts_of(cell, result));
        if (cell.convergence) {
            facts["convergence"] = errors_.cell_facts(cell);
            facts["convergence"]["expected_mse"] = errors_.expected_mse(cell, result.film);
        }
        return facts;
    }

    // A variant that rounds freely is held to itself: its film must be the same every time.
    static Variant full_size_reference(const Cell& cell) {
        return fp_relaxed(cell.variant, cell.backend) ? cell.variant
                                                      : Registry::instance().reference(cell.variant, cell.backend);
    }

    // The film of the cell's reference variant at the cell's own size, for the first sample's seed.
    const std::string& full_size_hash(const Cell& cell) {
        const std::uint32_t spp = cell.samples_to_prepare();
        const std::string part = spp != cell.spp ? fmt::format("/first:{}", spp) : "";
        const std::pair<std::string, std::size_t> key{bitwise_group(cell) + part, 0};
        const auto known = hashes_.find(key);
        if (known != hashes_.end()) {
            return known->second.first;
        }
        const Variant reference = full_size_reference(cell);
        RenderSettings settings = cell.settings;
        settings.seed = options_.seed;
        const RenderResult result =
            render(*cell.scene, {.variant = reference, .backend = cell.backend, .settings = settings, .samples = spp});
        return hashes_.try_emplace(key, result.film.hash(), reference.name()).first->second.first;
    }

    void time_samples() {
        std::size_t samples = 0;
        benchmark::ClearRegisteredBenchmarks();
        for (const Cell& cell : plan_.cells) {
            const std::vector<Json>& taken = journal_.samples(cell.name);
            if (is_ok(cell)) {
                const std::size_t left = static_cast<std::size_t>(repetitions_) -
                                         std::min(taken.size(), static_cast<std::size_t>(repetitions_));
                samples += left;
                time_left_.expect(cell.name, left, pass_ms(cell));
                for (const Json& sample : taken) {
                    time_left_.took(cell.name, 1e-3 * sample.value("pt_end_to_end_ms", 0.0), false);
                }
                register_cell(cell);
            }
        }
        progress_ = std::make_unique<Progress>("time", std::max<std::size_t>(1, samples), lines());
        if (interrupt_.requested()) {
            return;
        }
        QuietReporter reporter;
        const bool own_format =
            std::any_of(options_.benchmark_flags.begin(), options_.benchmark_flags.end(),
                        [](const std::string& flag) { return flag.starts_with("--benchmark_format"); });
        benchmark::RunSpecifiedBenchmarks(own_format ? nullptr : &reporter);
    }

    // What a sample may take, told from the instrumented pass.
    double pass_ms(const Cell& cell) const {
        const Json& facts = *journal_.cell(cell.name);
        const auto pass = facts.find("instrumented");
        const double wall = pass != facts.end() ? pass->value("wall_ms", 0.0) : 0.0;
        return std::max(1e-6, wall * cell.spp / cell.samples_to_prepare());
    }

    void register_cell(const Cell& cell) {
        // Google Benchmark enters the function once a repetition: the counter is the sample's index.
        benchmark::RegisterBenchmark(cell.name.c_str(),
                                     [this, &cell, next = std::make_shared<std::size_t>(0)](benchmark::State& state) {
                                         benchmark_cell(state, cell, (*next)++);
                                     })
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
    }

    // The loop is entered whatever happens, and a failure stays for all later repetitions: Google Benchmark 1.7.1
    // aborts the process otherwise (google/benchmark#2206).
    void benchmark_cell(benchmark::State& state, const Cell& cell, std::size_t index) {
        for (auto iteration : state) {
            (void)iteration;
            std::string error = interrupt_.requested() ? "interrupted" : failures_[cell.name];
            if (error.empty() && index >= journal_.samples(cell.name).size()) {
                error = take_sample(cell, index);
            }
            if (!error.empty()) {
                state.SkipWithError(error.c_str());
                break;
            }
            const Json& sample = journal_.samples(cell.name)[index];
            state.SetIterationTime(1e-3 * sample.at("pt_wall_ms").get<double>());
            state.counters["pt_rays_per_second"] = sample.at("pt_rays_per_second").get<double>();
        }
    }

    // Returns what went wrong, or nothing.
    std::string take_sample(const Cell& cell, std::size_t index) {
        std::string error;
        Json sample;
        std::vector<Snapshot> snapshots;
        const double start = seconds_now();
        try {
            error = render_sample(cell, index, sample, snapshots);
        } catch (const std::exception& exception) {
            error = exception.what();
        }
        if (!error.empty()) {
            failures_[cell.name] = error;
            Json facts = *journal_.cell(cell.name);
            facts["status"] = "failed";
            facts["reason"] = error;
            record_cell(cell, facts);
            fmt::print(stderr, "\nfailed: {}: {}\n", cell.name, error);
            time_left_.drop(cell.name);
        } else {  // a disk that is full ends the run, not the cell
            if (cell.convergence && cell.convergence->images && index == 0) {
                keep_images(cell, snapshots);
            }
            record_sample(cell, sample);
            order_ += 1;
            time_left_.took(cell.name, seconds_now() - start);
        }
        progress_->step(cell.name, [this] { return time_left_.seconds(); });
        return error;
    }

    std::string render_sample(const Cell& cell, std::size_t index, Json& sample, std::vector<Snapshot>& snapshots) {
        RenderRequest request{
            .variant = cell.variant, .backend = cell.backend, .settings = cell.settings, .samples = cell.spp};
        request.settings.seed = options_.seed + index;
        if (warm_.insert(cell.name).second) {
            RenderRequest warm_up = request;
            warm_up.samples = 1;
            (void)render(*cell.scene, warm_up);
        }
        if (cell.convergence) {
            request.checkpoints = cell.convergence->checkpoints;
            request.on_checkpoint = [&](const Checkpoint& c) {
                snapshots.push_back({c.samples, c.wall_ms, c.device_ms, c.cpu_ms, c.film});
            };
        }
        const std::optional<double> clock_before = clock_mhz(cell.backend);
        const ForeignLoad load_before = ForeignLoad::now();
        const auto render_begin = std::chrono::steady_clock::now();
        const RenderResult result = render(*cell.scene, request);
        const double end_to_end =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - render_begin).count();
        const ForeignLoad foreign = ForeignLoad::now() - load_before;
        const std::optional<double> clock_after = clock_mhz(cell.backend);
        if (const std::string missing = check_counters(cell.variant, result.work, cell.spp, cell.backend);
            !missing.empty()) {
            return missing;
        }
        // At full size too, every film of a group has the same bits, seed by seed.
        const std::string hash = result.film.hash();
        const auto [position, is_first] = hashes_.try_emplace({bitwise_group(cell), index}, hash, cell.name);
        if (!is_first && position->second.first != hash) {
            return fmt::format("film {} of sample {} differs from {} of {}", hash, index, position->second.first,
                               position->second.second);
        }
        // Where errors are measured, a sample that is not finite makes them null, with a count.
        FilmFaults faults = result.film.faults();
        faults.nonfinite = cell.convergence ? 0 : faults.nonfinite;
        if (!faults.none()) {
            return faults_text(faults);
        }
        sample = {{"pt_wall_ms", result.wall_ms},
                  {"pt_device_ms", result.device_ms},
                  {"pt_end_to_end_ms", end_to_end},
                  {"cpu_ms", result.cpu_ms},
                  {"pt_seed", request.settings.seed},
                  {"pt_spp", cell.spp},
                  {"pt_paths", result.work.paths},
                  {"pt_rays", result.work.rays},
                  {"pt_rays_per_second", static_cast<double>(result.work.rays) / (1e-3 * result.wall_ms)},
                  {"pt_launches", result.work.launches},
                  {"pt_graph_nodes", result.work.graph_nodes},
                  {"pt_loop_rounds", result.work.loop_rounds},
                  {"pt_host_waits", result.work.host_waits},
                  {"pt_order", order_},
                  {"pt_timestamp", seconds_now()},
                  {"pt_clock_unknown", clock_before && clock_after ? 0 : 1},
                  {"pt_foreign_cpu_ms", foreign.cpu_ms},
                  {"pt_involuntary_switches", foreign.involuntary_switches},
                  {"film_hash", hash}};
        if (clock_before && clock_after) {
            sample["pt_clock_mhz_before"] = *clock_before;
            sample["pt_clock_mhz_after"] = *clock_after;
        }
        if (cell.convergence) {
            sample["pt_checkpoints"] = errors_.rows(cell, snapshots);
        }
        return "";
    }

    void keep_images(const Cell& cell, const std::vector<Snapshot>& snapshots) {
        Json facts = *journal_.cell(cell.name);
        facts["convergence"]["images"] =
            write_images(images_folder(options_.out, keeps_earlier()), cell, errors_.reference(cell), snapshots);
        record_cell(cell, facts);
    }

    void print_table() const {
        fmt::print("{:>12} {:>7} {:>9}  cell (median of the samples)\n", "ms/spp", "cv", "Mrays/s");
        for (const Cell& cell : plan_.cells) {
            std::vector<double> wall, rays;
            for (const Json& sample : journal_.samples(cell.name)) {
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

    int finish() {
        std::size_t failed = 0;
        std::size_t unfinished = 0;
        for (const Cell& cell : plan_.cells) {
            const Json* facts = journal_.cell(cell.name);
            const bool cell_failed = facts != nullptr && facts->at("status") == "failed";
            failed += cell_failed ? 1u : 0u;
            unfinished += !cell_failed && static_cast<int>(journal_.samples(cell.name).size()) < repetitions_ ? 1u : 0u;
        }
        const bool completed = unfinished == 0;
        if (!completed && ::isatty(STDERR_FILENO) != 0) {
            fmt::print(stderr, "\n");  // after the line of progress that stands there
        }
        if (!completed && (journal_.sample_count() == 0 || keeps_earlier())) {
            fmt::print("{}\n", journal_.sample_count() == 0
                                   ? "interrupted before the first sample: no result written"
                                   : fmt::format("interrupted: {} stays as it was, {} holds {} samples of this run",
                                                 options_.out, journal_.file(), journal_.sample_count()));
            say_how_to_go_on();
            return exit_interrupted;
        }
        write_file(options_.out, result_json(plan_, suite_, journal_,
                                             {.command_line = options_.command_line,
                                              .suite = suite_.name,
                                              .date = iso_date(),
                                              .backend = options_.backend,
                                              .completed = completed,
                                              .repetitions = repetitions_,
                                              .run = run_facts()}));
        if (completed && keeps_earlier()) {
            replace_images(options_.out);
        }
        print_table();
        fmt::print("{}\n{}\n{} cells, {} samples, {} failed, {} not applicable{}\n",
                   in_words(disturbance_of(plan_, journal_)), options_.out, plan_.cells.size(), journal_.sample_count(),
                   failed, plan_.not_applicable.size(),
                   completed ? "" : fmt::format("; interrupted with {} cells unfinished", unfinished));
        if (!completed) {
            say_how_to_go_on();
            return exit_interrupted;
        }
        remove_partial_files(options_.out);
        journal_.finish();
        return failed == 0 ? exit_good : exit_check_failed;
    }

    // An earlier result stays until this one is complete. What this very run left when it was interrupted is no such.
    bool keeps_earlier() const { return earlier_.is_there && !(earlier_.is_of_this_run && !earlier_.is_complete); }

    nlohmann::ordered_json run_facts() const {
        nlohmann::ordered_json facts = run_json(identity_);
        if (!options_.shard.is_whole()) {
            facts["positions"] = positions_;
        }
        return facts;
    }

    void say_how_to_go_on() const {
        fmt::print("go on with: {}{}\n", options_.command_line, options_.resume ? "" : " --resume");
    }

    const Suite& suite_;
    Plan plan_;
    std::vector<std::size_t> positions_;
    const RunOptions& options_;
    int repetitions_;
    const Json& identity_;
    Interrupt& interrupt_;
    EarlierResult earlier_;
    Journal journal_;
    std::mutex journal_mutex_;  // held while it changes
    bool has_session_ = false;
    ErrorBook errors_;
    std::unique_ptr<Progress> progress_;
    TimeLeft time_left_;
    std::map<std::string, std::string> failures_;
    std::set<std::string> warm_;
    std::map<std::pair<std::string, std::size_t>, std::pair<std::string, std::string>> hashes_;  // to hash and cell
    std::uint64_t order_ = 0;
};

// Sets Google Benchmark's flags; throws InputError for one that it does not know.
void initialize_benchmark(const RunOptions& options, int repetitions) {
    std::vector<std::string> arguments{"ptbench", fmt::format("--benchmark_repetitions={}", repetitions),
                                       "--benchmark_enable_random_interleaving=true",
                                       "--benchmark_display_aggregates_only=true"};
    arguments.insert(arguments.end(), options.benchmark_flags.begin(), options.benchmark_flags.end());
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

// Halves of a reference are independent of what is compared with them: no sample may have one's seed.
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

// Whether the result of this very run is there, and no journal: a run that was killed as it ended, or called again.
bool is_done(const RunOptions& options, const EarlierResult& earlier) {
    return options.resume && !std::filesystem::exists(journal_of(options)) && earlier.is_of_this_run &&
           earlier.is_complete;
}

// An earlier result may only be replaced where the call says so, or where it is this run's own. (A journal without
// --resume is refused when it is opened.)
void check_result_file(const RunOptions& options, const EarlierResult& earlier) {
    const bool has_journal = std::filesystem::exists(journal_of(options));
    const bool goes_on = has_journal && (!options.resume || earlier.is_of_this_run || !earlier.is_complete);
    if (!goes_on) {
        check_overwrite(options.out, options.overwrite);
    }
}

}  // namespace

std::string describe_plan(const Plan& plan, int repetitions) {
    std::string text;
    for (const Cell& cell : plan.cells) {
        text += cell.name + "\n";
    }
    for (const NotApplicable& entry : plan.not_applicable) {
        text += fmt::format("n/a: {} on {}: {}\n", entry.variant.name(), entry.scene, entry.reason);
    }
    return text + fmt::format("{} cells, {} samples, {} not applicable\n", plan.cells.size(),
                              plan.cells.size() * static_cast<std::size_t>(repetitions), plan.not_applicable.size());
}

Plan plan_run(const Suite& suite, const RunOptions& options) {
    // Without the backend there is no machine to have been tuned (a plan may be listed anywhere).
    const bool is_there = options.backend == Backend::cpu || cuda::not_available().empty();
    const Tuning tuning =
        options.untuned || !is_there ? Tuning() : Tuning::load(tuning_file(options.backend), options.backend);
    Plan plan = make_plan(suite, options.backend, tuning);
    apply_filter(plan, options.filter);
    if (plan.cells.empty()) {
        throw InputError("the run has no cell: " + (plan.not_applicable.empty()
                                                        ? std::string("the filter matches none")
                                                        : "n/a: " + plan.not_applicable.front().reason));
    }
    return plan;
}

int run_suite(const Suite& suite, const RunOptions& options) {
    const Plan whole = plan_run(suite, options);
    const std::vector<std::size_t> positions = positions_of(whole, options.shard);
    check_output_file(options.out);
    check_output_file(journal_of(options));
    const int repetitions = options.repetitions > 0 ? options.repetitions : suite.repetitions;
    check_seeds(whole, options.seed, repetitions);
    initialize_benchmark(options, repetitions);
    const Json identity = identity_of(whole, {.suite = suite.name,
                                              .backend = options.backend,
                                              .seed = options.seed,
                                              .repetitions = repetitions,
                                              .shard = options.shard});
    const EarlierResult earlier = earlier_result(options.out, run_json(identity));
    if (is_done(options, earlier)) {
        fmt::print("{}\nnothing left to do: this run is complete\n", options.out);
        return earlier.failed_cells > 0 ? exit_check_failed : exit_good;
    }
    check_result_file(options, earlier);
    Interrupt interrupt(options.grace);
    return Runner(suite, part_of(whole, positions), positions, options, repetitions, identity, interrupt).run();
}

}  // namespace pt
