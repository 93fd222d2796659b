// ptbench stability: cases with exact answers, over precision, arithmetic, robustness, integrators and backend.
#include <algorithm>
#include <charconv>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/compile_ahead.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/interrupt.h"
#include "harness/locked_file.h"
#include "harness/nearest_name.h"
#include "harness/stability/evaluate.h"
#include "harness/stability/report.h"
#include "harness/stability/workers.h"
#include "harness/write_file.h"

namespace pt {

namespace {

using stability::Case;
using stability::Row;
using stability::Status;
using stability::Task;

struct StabilityArguments {
    std::vector<std::string> cases;
    std::vector<std::string> families;
    std::vector<std::string> values;
    std::vector<std::string> axes;
    std::string backend;
    std::uint64_t seed = 1;
    std::uint64_t paths = 0;
    std::size_t jobs = 0;
    bool quick = false;
    bool list = false;
    bool quiet = false;
    bool resume = false;
    bool overwrite = false;
    std::string out;
    std::string write_scenes;
    std::string command_line;
};

const Case& find_case(const std::string& name) {
    std::vector<std::string> names;
    for (const Case& stiff_case : stability::catalogue()) {
        if (stiff_case.name == name || stiff_case.catalogue == name) {
            return stiff_case;
        }
        names.push_back(stiff_case.name);
    }
    throw InputError("--case", "name", "\"" + name + "\"",
                     fmt::format("{}{}", fmt::join(names, ", "), did_you_mean(name, names)));
}

std::vector<const Case*> chosen_cases(const StabilityArguments& arguments) {
    std::vector<const Case*> cases;
    std::vector<std::string> names;  // "lamp" and its number in the catalogue are one
    for (const std::string& argument : arguments.cases) {
        for (const std::string& name : split_names(argument, "--case")) {
            cases.push_back(&find_case(name));
            names.push_back(cases.back()->name);
            check_once(names, "--case", "argument");
        }
    }
    std::vector<std::string> families;
    for (const std::string& family : arguments.families) {
        families.push_back(family);
        check_once(families, "--family", "argument");
        if (std::find(std::begin(stability::families), std::end(stability::families), family) ==
            std::end(stability::families)) {
            throw InputError("--family", "name", "\"" + family + "\"",
                             fmt::format("{}", fmt::join(stability::families, ", ")));
        }
    }
    for (const Case& stiff_case : stability::catalogue()) {
        const bool by_family = std::find(arguments.families.begin(), arguments.families.end(), stiff_case.family) !=
                               arguments.families.end();
        const bool all = arguments.cases.empty() && arguments.families.empty();
        if ((all || by_family) && std::find(cases.begin(), cases.end(), &stiff_case) == cases.end()) {
            cases.push_back(&stiff_case);
        }
    }
    return cases;
}

// "NAME=VALUE".
std::map<std::string, double> parse_values(const std::vector<std::string>& arguments) {
    std::map<std::string, double> values;
    for (const std::string& argument : arguments) {
        const std::size_t equals = argument.find('=');
        double value = 0;
        const char* const end = argument.data() + argument.size();
        const char* const start = argument.data() + std::min(equals, argument.size() - 1) + 1;
        const auto parsed = std::from_chars(start, end, value);
        if (equals == std::string::npos || equals == 0 || start == end || parsed.ec != std::errc() ||
            parsed.ptr != end) {
            throw InputError("--set", "argument", "\"" + argument + "\"", "NAME=NUMBER");
        }
        if (!values.try_emplace(argument.substr(0, equals), value).second) {
            throw InputError("--set", "argument", argument.substr(0, equals) + " twice", "once");
        }
    }
    return values;
}

// What is compared where nothing is asked for: every precision, arithmetic and robustness with the plainest integrator,
// and the other integrators in single precision.
std::vector<Variant> standard_variants(Backend backend, bool quick) {
    const Registry& registry = Registry::instance();
    const Variant plainest = stability::plainest_variant(backend);
    AxisChoices axes{{"robustness", {"robust", "naive"}}};
    for (const char* axis : {"precision", "arithmetic"}) {
        for (const Choice* choice : registry.choices(axis, backend)) {
            axes[axis].emplace_back(choice->descriptor.name);
        }
    }
    const auto with_plainest = [&](AxisChoices choices) {
        for (const std::string_view axis : axis_names) {
            choices.try_emplace(std::string(axis), std::vector<std::string>{plainest[axis]});
        }
        return expand(choices, backend);
    };
    std::vector<Variant> variants = with_plainest(axes);
    std::erase_if(variants, [&](const Variant& variant) {
        const auto is_changed = [&](const auto& axis) { return variant[axis.first] != plainest[axis.first]; };
        return quick && std::count_if(axes.begin(), axes.end(), is_changed) > 1;
    });
    for (const Choice* integrator : registry.choices("integrator", backend)) {
        Variant variant = plainest;
        variant.set("integrator", std::string(integrator->descriptor.name));
        if (std::find(variants.begin(), variants.end(), variant) == variants.end()) {
            variants.push_back(variant);
        }
    }
    return variants;
}

std::vector<Variant> asked_variants(const StabilityArguments& arguments, Backend backend) {
    if (arguments.axes.empty()) {
        return standard_variants(backend, arguments.quick);
    }
    const Variant plainest = stability::plainest_variant(backend);
    AxisChoices axes = parse_axis_arguments(arguments.axes, backend);
    for (const std::string_view axis : axis_names) {
        axes.try_emplace(std::string(axis), std::vector<std::string>{plainest[axis]});
    }
    return expand(axes, backend);
}

bool is_named(const std::string& axis, const StabilityArguments& arguments) {
    return std::any_of(arguments.axes.begin(), arguments.axes.end(),
                       [&](const std::string& argument) { return argument.starts_with(axis + "="); });
}

// The plainest variant with every accelerator, and with every builder under a tree that needs one: whatever is met must
// be met through all of them.
std::vector<Variant> accelerated_variants(Backend backend) {
    const Registry& registry = Registry::instance();
    const Variant plainest = stability::plainest_variant(backend);
    std::vector<Variant> variants;
    const auto add = [&](const std::string& accelerator, const std::string& builder) {
        Variant variant = plainest;
        variant.set("accelerator", accelerator);
        variant.set("builder", builder);
        if (variant != plainest && std::find(variants.begin(), variants.end(), variant) == variants.end()) {
            variants.push_back(variant);
        }
    };
    std::string with_tree;
    for (const Choice* accelerator : registry.choices("accelerator", backend)) {
        const std::string name(accelerator->descriptor.name);
        add(name, plainest["builder"]);
        with_tree = accelerator->hook.accelerator.encode != nullptr ? name : with_tree;
    }
    for (const Choice* builder : registry.choices("builder", backend)) {
        add(with_tree, std::string(builder->descriptor.name));
    }
    return variants;
}

// The variants, and each with the estimators that the case asks for unless the call named their axis; likewise the
// plainest one with accelerators and builders.
std::vector<Variant> with_estimators(const std::vector<Variant>& variants, const Case& stiff_case,
                                     const StabilityArguments& arguments, Backend backend) {
    std::vector<Variant> all = variants;
    if (stiff_case.over_accelerators && !is_named("accelerator", arguments) && !is_named("builder", arguments)) {
        for (const Variant& variant : accelerated_variants(backend)) {
            all.push_back(variant);
        }
    }
    for (const auto& [axis, choices] : stiff_case.estimators) {
        for (const std::string& choice : choices) {
            for (const Variant& variant : variants) {
                if (!is_named(axis, arguments)) {
                    all.push_back(variant);
                    all.back().set(axis, choice);
                }
            }
        }
    }
    return all;
}

std::vector<stability::Values> points_of(const Case& stiff_case, const StabilityArguments& arguments) {
    const std::map<std::string, double> set = parse_values(arguments.values);
    if (!set.empty()) {
        return {values_of(stiff_case, set)};
    }
    std::vector<stability::Values> points;
    if (arguments.quick && (!stiff_case.quick_points.empty() || stiff_case.points.empty())) {
        for (const auto& point : stiff_case.quick_points) {
            points.push_back(values_of(stiff_case, point));
        }
    } else {
        for (const auto& point : stiff_case.points) {
            points.push_back(values_of(stiff_case, point));
            if (arguments.quick) {
                break;
            }
        }
    }
    if (points.empty()) {
        points.push_back(values_of(stiff_case, {}));
    }
    return points;
}

std::vector<Task> tasks_of(const Case& stiff_case, const StabilityArguments& arguments, Backend backend,
                           const std::vector<Variant>& variants) {
    std::vector<Task> tasks;
    for (const stability::Values& values : points_of(stiff_case, arguments)) {
        for (const Variant& variant : with_estimators(variants, stiff_case, arguments, backend)) {
            tasks.push_back({&stiff_case, values, backend, variant, arguments.seed, arguments.quick, arguments.paths});
        }
    }
    return tasks;
}

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

void write_scenes(const std::vector<const Case*>& cases, const std::string& folder) {
    for (const Case* stiff_case : cases) {
        for (const auto& [name, text] : stability::scene_files(*stiff_case)) {
            write_file(folder + "/" + name + ".json", text);
            fmt::print("{}/{}.json\n", folder, name);
        }
    }
}

void compile(const std::vector<const Case*>& cases, const StabilityArguments& arguments,
             const std::vector<Variant>& variants, Backend backend) {
    std::vector<Scene> scenes;
    std::vector<std::pair<std::size_t, Variant>> wanted;
    for (const Case* stiff_case : cases) {
        const auto scene = stability::a_scene_of(*stiff_case);
        if (scene && stiff_case->missing_feature.empty()) {
            scenes.push_back(*scene);
            for (const Variant& variant : with_estimators(variants, *stiff_case, arguments, backend)) {
                wanted.emplace_back(scenes.size() - 1, variant);
            }
        }
    }
    std::vector<CompileTask> compilations;
    for (const auto& [index, variant] : wanted) {
        compilations.push_back({&scenes[index], variant});
    }
    compile_ahead(compilations);
}

// The tasks of a call, case after case.
std::vector<Task> all_tasks(const StabilityArguments& arguments, Backend backend) {
    const std::vector<Variant> variants = asked_variants(arguments, backend);
    std::vector<Task> tasks;
    for (const Case* stiff_case : chosen_cases(arguments)) {
        for (Task& task : tasks_of(*stiff_case, arguments, backend, variants)) {
            tasks.push_back(std::move(task));
        }
    }
    return tasks;
}

// A task's rows, and what is printed of them, as a line of JSON.
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

// "cuda 17": the call's 17th task on that backend.
stability::Answer worker_of(const StabilityArguments& arguments) {
    auto tasks = std::make_shared<std::vector<Task>>();
    return [&arguments, tasks](const std::string& question) {
        const std::size_t space = question.find(' ');
        if (tasks->empty()) {
            *tasks = all_tasks(arguments, parse_backend(question.substr(0, space)));
        }
        return evaluated(tasks->at(std::stoul(question.substr(space + 1))), arguments.quiet);
    };
}

// On a CPU every render has all processors already.
std::size_t worker_count(const StabilityArguments& arguments) {
    if (arguments.jobs != 0) {
        return arguments.jobs;
    }
    return arguments.backend == "cpu" ? 1 : std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 16);
}

// The report itself is another file after every case: what is locked lies beside it.
class ReportLock {
public:
    explicit ReportLock(const std::string& file) : file_(file) {}
    ~ReportLock() { file_.remove(); }
    ReportLock(const ReportLock&) = delete;
    ReportLock& operator=(const ReportLock&) = delete;

private:
    LockedFile file_;
};

// The tasks of a call whose rows the report has not yet, one answer after the other into it.
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

    // Without workers `answer` is called here.
    int run(stability::Workers* workers, const stability::Answer& answer) {
        std::vector<std::string> questions;
        for (const std::size_t task : missing_) {
            questions.push_back(fmt::format("{} {}", to_string(backend_), task));
        }
        if (workers != nullptr) {  // of an interrupt they know nothing: what they are at is abandoned
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

    // On another thread, for good: nothing else of this process is put away.
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
    std::mutex mutex_;  // held while the report changes
    Interrupt interrupt_;
};

int run(const StabilityArguments& arguments) {
    const std::vector<const Case*> cases = chosen_cases(arguments);
    if (arguments.list) {
        list_cases(cases);
        return exit_good;
    }
    if (!arguments.write_scenes.empty()) {
        write_scenes(cases, arguments.write_scenes);
        return exit_good;
    }
    if (!arguments.values.empty() && cases.size() != 1) {
        throw InputError("--set", "argument", fmt::format("{} cases", cases.size()), "one case, by --case");
    }
    // Before the backend is looked at: a process that has started CUDA cannot be forked.
    const stability::Answer answer = worker_of(arguments);
    std::optional<stability::Workers> workers;
    if (const std::size_t count = worker_count(arguments); count > 1) {
        workers.emplace(count, answer);
    }
    const Backend backend = parse_backend(arguments.backend);
    require_backend(backend);
    StabilityRun stability_run(arguments, backend);
    if (backend == Backend::cuda) {
        compile(cases, arguments, asked_variants(arguments, backend), backend);
    }
    const bool uses_workers = workers && (arguments.jobs != 0 || backend == Backend::cuda);
    if (uses_workers && backend == Backend::cuda && !cuda::runs_processes_at_once()) {
        fmt::print(
            stderr,
            "note: {} processes take turns on the GPU; under NVIDIA's MPS (nvidia-cuda-mps-control -d) they run on "
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
                     "plainest integrator, and every integrator)")
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
    command->add_flag("--list", arguments->list, "Say what there is, and run nothing");
    command->add_flag("--quiet", arguments->quiet, "Print failures of what must pass, and the tally, only");
    CLI::Option* const out = command->add_option("--out", arguments->out, "Result file (JSON); none: print only");
    out->check(check_not_empty);
    command->add_flag("--resume", arguments->resume, "Keep the rows that --out has already")->needs(out);
    command
        ->add_flag("--overwrite", arguments->overwrite, "Replace a result that is there, when the new one is complete")
        ->needs(out);
    command->add_option("--write-scenes", arguments->write_scenes,
                        "Write the cases' scenes at their first point into this folder, and run nothing");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
