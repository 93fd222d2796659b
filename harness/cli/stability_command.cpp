// `ptbench stability`: cases with exact answers, over precision, arithmetic, robustness, integrators and backend.
#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "harness/bench/compile_ahead.h"
#include "harness/cli/commands.h"
#include "harness/cli/stability_tasks.h"
#include "harness/cuda/backend.h"
#include "harness/files_beside.h"
#include "harness/interrupt.h"
#include "harness/locked_file.h"
#include "harness/say.h"
#include "harness/stability/evaluate.h"
#include "harness/stability/report.h"
#include "harness/workers.h"
#include "harness/write_file.h"

namespace pt {

namespace {

using stability::Case;
using stability::Row;
using stability::Status;
using stability::Task;

struct StabilityArguments : StabilityRequest {
    std::string backend;
    std::size_t jobs = 0;
    bool list = false;
    bool quiet = false;
    bool resume = false;
    bool overwrite = false;
    std::string out;
    std::string write_scenes;
    CompileOnly compile_only;
    std::string command_line;
};

void list_cases(const std::vector<const Case*>& cases) {
    for (const Case* stiff_case : cases) {
        fmt::print("{:<4} {:<24} {:<11} {}\n", stiff_case->catalogue, stiff_case->name, stiff_case->family,
                   stiff_case->title);
        fmt::print("       {}\n",
                   stiff_case->missing_feature.empty() ? stiff_case->stiff : stiff_case->missing_feature);
        for (const stability::Parameter& parameter : stiff_case->parameters) {
            fmt::print("       --set {}={:g}  {} ({:g} to {:g})\n", parameter.name, parameter.default_value,
                       parameter.summary, parameter.lowest, parameter.highest);
        }
    }
}

void write_scenes(const std::vector<const Case*>& cases, const std::string& folder, bool overwrite) {
    std::vector<std::pair<std::string, std::string>> files;  // names and contents of the scene files to write
    for (const Case* stiff_case : cases) {
        for (const auto& [name, text] : stability::scene_files(*stiff_case)) {
            files.emplace_back(folder + "/" + name + ".json", text);
            check_replacement(files.back().first, text, overwrite, "--write-scenes");
        }
    }
    for (const auto& [file, text] : files) {
        write_file(file, text);
        fmt::print("{}\n", file);
    }
}

// The programs to compile for tasks of a stability run. A kernel that is specialised for its scene needs the scene of
// every parameter point; `scenes` owns these.
std::vector<CompileTask> compilations_of(const std::vector<Task>& tasks, std::deque<Scene>& scenes) {
    std::vector<CompileTask> compilations;
    std::map<std::string, const Scene*> known;
    for (const Task& task : tasks) {
        for (const auto& [text, variant] : stability::renders_of(task)) {
            const Scene*& scene = known[text];
            if (scene == nullptr) {
                scene = &scenes.emplace_back(parse_scene(text, "stability case " + task.stiff_case->name));
            }
            compilations.push_back({.scene = scene, .variant = variant, .is_alone = true});
        }
    }
    return compilations;
}

// Evaluates a task and returns its rows, and the text to print, as a line of JSON.
std::string evaluated(const Task& task, bool quiet) {
    const std::vector<Row> rows = evaluate(task);
    std::string text;
    const Variant plainest = stability::plainest_variant(task.backend);
    for (const Row& row : rows) {
        const bool worth_a_line = row.status == Status::failed || row.status == Status::broken;
        if (!quiet || (worth_a_line && stability::must_pass(task.variant, task.backend))) {
            text += fmt::format("{:<11} {:<4} {}  {}\n", to_string(row.status), task.stiff_case->catalogue,
                                stability::label(task, plainest), stability::in_words(row));
        }
    }
    return stability::Json{{"rows", to_json(task, rows)}, {"text", std::move(text)}}.dump();
}

// The function with which a worker answers a question such as "cuda 17": evaluate task 17 on that backend.
Answer worker_of(const StabilityArguments& arguments) {
    auto tasks = std::make_shared<std::vector<Task>>();
    return [&arguments, tasks](const std::string& question) {
        const std::size_t space = question.find(' ');
        if (tasks->empty()) {
            *tasks = all_tasks(arguments, parse_backend(question.substr(0, space)));
        }
        return evaluated(tasks->at(std::stoul(question.substr(space + 1))), arguments.quiet);
    };
}

// The number of worker processes; 1 on a CPU, where every render uses all processors already.
std::size_t worker_count(const StabilityArguments& arguments) {
    if (arguments.jobs != 0) {
        return arguments.jobs;
    }
    return arguments.backend == "cpu" ? 1 : std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 16);
}

// The lock of a report is a file beside the report, since saving replaces the report's own file after every case.
class ReportLock {
public:
    explicit ReportLock(const std::string& file) : file_(file) {}
    ~ReportLock() { file_.remove(); }
    ReportLock(const ReportLock&) = delete;
    ReportLock& operator=(const ReportLock&) = delete;

private:
    LockedFile file_;
};

// Evaluates those tasks of a `ptbench stability` command that its report lacks, and adds the results to the report.
class StabilityRun {
public:
    StabilityRun(const StabilityArguments& arguments, Backend backend)
        : arguments_(arguments),
          backend_(backend),
          lock_(arguments.out.empty() ? nullptr : std::make_unique<ReportLock>(arguments.out + ".lock")),
          report_(arguments.out, {arguments.command_line, backend, arguments.quick, arguments.seed, arguments.paths},
                  arguments.resume && arguments.overwrite ? stability::Report::IfThere::resume_or_overwrite
                  : arguments.resume                      ? stability::Report::IfThere::resume
                  : arguments.overwrite                   ? stability::Report::IfThere::overwrite
                                                          : stability::Report::IfThere::refuse),
          tasks_(all_tasks(arguments, backend)) {
        for (std::size_t i = 0; i < tasks_.size(); ++i) {
            if (!report_.has(tasks_[i])) {
                missing_.push_back(i);
            }
        }
        interrupt_.when_overdue([this] { return abandon(); });
    }
    ~StabilityRun() { interrupt_.begin_end(); }
    StabilityRun(const StabilityRun&) = delete;
    StabilityRun& operator=(const StabilityRun&) = delete;

    std::vector<Task> missing_tasks() const {
        std::vector<Task> tasks;
        for (const std::size_t i : missing_) {
            tasks.push_back(tasks_[i]);
        }
        return tasks;
    }

    // Evaluates the missing tasks by the workers or, without workers, by calling `answer` in this process.
    int run(Workers* workers, const Answer& answer) {
        std::vector<std::string> questions;
        for (const std::size_t task : missing_) {
            questions.push_back(fmt::format("{} {}", to_string(backend_), task));
        }
        if (workers != nullptr) {  // workers do not see an interrupt: the tasks in flight are lost
            workers->ask(questions, [this](std::size_t i, const std::string& line) { answered(i, line); });
        }
        for (std::size_t i = 0; i < questions.size() && workers == nullptr; ++i) {
            if (interrupt_.requested()) {
                interrupt_.begin_end();
                return end_interrupted();
            }
            answered(i, answer(questions[i]));
        }
        interrupt_.begin_end();
        report_.finish();
        fmt::print("{}\n", report_.summary());
        return report_.must_pass_failures() == 0 && report_.passed() > 0 ? exit_good : exit_check_failed;
    }

private:
    void answered(std::size_t question, const std::string& line) {
        const stability::Json rows = stability::Json::parse(line);
        const Task& task = tasks_[missing_[question]];
        const std::lock_guard lock(mutex_);
        report_.add(task, rows["rows"]);
        fmt::print("{}", rows["text"].get<std::string>());
        std::fflush(stdout);
        const bool ends_case =
            question + 1 == missing_.size() || tasks_[missing_[question + 1]].stiff_case != task.stiff_case;
        if (ends_case) {
            report_.save();
        }
    }

    // Saves the report and ends the process from another thread, without cleaning up anything else.
    int abandon() {
        mutex_.lock();
        const int exit_code = end_interrupted();
        lock_.reset();
        return exit_code;
    }

    int end_interrupted() const {
        report_.save();
        fmt::print("interrupted: {}\n", report_.summary());
        if (!arguments_.out.empty()) {
            fmt::print("go on with: {}{}\n", arguments_.command_line, arguments_.resume ? "" : " --resume");
        }
        return exit_interrupted;
    }

    const StabilityArguments& arguments_;
    Backend backend_;
    std::unique_ptr<ReportLock> lock_;
    stability::Report report_;
    std::vector<Task> tasks_;
    std::vector<std::size_t> missing_;
    std::mutex mutex_;  // mutex held while the stability report changes
    Interrupt interrupt_;
};

int run(const StabilityArguments& arguments) {
    const std::vector<const Case*> cases = chosen_cases(arguments);
    if (arguments.list) {
        list_cases(cases);
        return exit_good;
    }
    if (arguments.overwrite && arguments.out.empty() && arguments.write_scenes.empty()) {
        throw InputError("--overwrite requires --out or --write-scenes");
    }
    if (!arguments.write_scenes.empty()) {
        write_scenes(cases, arguments.write_scenes, arguments.overwrite);
        return exit_good;
    }
    if (!arguments.values.empty() && cases.size() != 1) {
        throw InputError("--set", "argument", fmt::format("{} cases", cases.size()), "one case, by --case");
    }
    std::deque<Scene> scenes;
    if (arguments.compile_only.is_asked) {
        compile_for(arguments.compile_only.architecture, compilations_of(all_tasks(arguments, Backend::cuda), scenes));
        return exit_good;
    }
    // Workers are forked before the backend is initialised, since a process that has started CUDA cannot be forked.
    const Answer answer = worker_of(arguments);
    std::optional<Workers> workers;
    if (const std::size_t count = worker_count(arguments); count > 1) {
        workers.emplace(count, answer);
    }
    const Backend backend = parse_backend(arguments.backend);
    require_backend(backend);
    StabilityRun stability_run(arguments, backend);
    if (backend == Backend::cuda) {
        compile_ahead(compilations_of(stability_run.missing_tasks(), scenes));
    }
    const bool uses_workers = workers && (arguments.jobs != 0 || backend == Backend::cuda);
    if (uses_workers && backend == Backend::cuda && !cuda::runs_processes_at_once()) {
        say("note: {} processes take turns on the GPU; under NVIDIA's MPS (nvidia-cuda-mps-control -d) they run on "
            "it at once, in a part of the time\n",
            worker_count(arguments));
    }
    return stability_run.run(uses_workers ? &*workers : nullptr, answer);
}

}  // namespace

Command add_stability_command(CLI::App& app, const std::string& command_line) {
    auto arguments = std::make_shared<StabilityArguments>();
    arguments->command_line = command_line;
    CLI::App* command = app.add_subcommand(
        "stability", "Stiff and extreme cases with exact answers; exit code 1 if one fails that must pass");
    command->add_option("--case", arguments->cases, "Cases by name or number in the catalogue, comma-separated")
        ->allow_extra_args(false);
    command->add_option("--family", arguments->families, "Every case of a family, repeatable")->allow_extra_args(false);
    command->add_option("--set", arguments->values, "PARAMETER=NUMBER of the case, repeatable")
        ->allow_extra_args(false);
    command
        ->add_option("--axis", arguments->axes,
                     "AXIS=CHOICE,CHOICE, repeatable (default: every precision, arithmetic and robustness with the "
                     "plainest integrator, and every integrator; on cuda also the kernels that findings time: compiled "
                     "for the scene, by every scheduler, with every estimator and accelerator in turn)")
        ->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--seed", arguments->seed, "Seed (default 1)")->check(check_seed);
    command->add_option("--paths", arguments->paths, "Paths of each rendering, instead of as many as the case asks for")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 34));
    command
        ->add_option("--jobs", arguments->jobs,
                     "Processes that evaluate tasks at once (default: one for each processor, at most 16, on cuda; one "
                     "on cpu). Rows do not depend on it but for their seconds")
        ->check(CLI::Range(std::size_t{1}, std::size_t{256}));
    command->add_flag("--quick", arguments->quick, "Fewer points, samples and variants");
    add_compile_options(*command, arguments->compile_only);
    command->add_flag("--list", arguments->list, "Say what there is, and run nothing");
    command->add_flag("--quiet", arguments->quiet, "Print failures of what must pass, and the tally, only");
    CLI::Option* const out = command->add_option("--out", arguments->out, "Result file (JSON); none: print only");
    out->check(check_not_empty);
    command->add_flag("--resume", arguments->resume, "Keep the rows that --out has already")->needs(out);
    command->add_flag("--overwrite", arguments->overwrite,
                      "Replace a result that is there, when the new one is complete, or other scenes");
    command->add_option("--write-scenes", arguments->write_scenes,
                        "Write the cases' scenes at their first point into this folder, and run nothing");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
