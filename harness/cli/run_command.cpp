#include <charconv>
#include <set>

#include <fmt/format.h>

#include "harness/bench/benchmark_flags.h"
#include "harness/bench/convergence_study.h"
#include "harness/bench/prepare_cells.h"
#include "harness/bench/runner.h"
#include "harness/cli/commands.h"
#include "harness/cli/run_preview.h"
#include "harness/cuda/backend.h"
#include "harness/error/reference.h"
#include "harness/machine/machine.h"
#include "harness/nearest_name.h"
#include "harness/ranks/ranks.h"
#include "harness/say.h"
#include "harness/scene/places.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

namespace {

struct RunArguments {
    std::string suite;
    std::string scenes;
    std::vector<std::string> axes;
    std::string devices;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolutions;
    std::string depths;
    std::string spps;
    int repetitions = 0;
    int retakes = -1;
    int decide_seconds = -1;
    std::uint64_t seed = 1;
    std::string out;
    bool resume = false;
    bool overwrite = false;
    bool other_host = false;
    bool quiet = false;
    std::string shard;
    bool untuned = false;
    bool dry_run = false;
    bool error_against_time = false;
    CompileOnly compile_only;
    std::string reference_cache;
};

// Turns a study into one of error against time (--error-against-time). The reference image is refined until it is good
// enough for the errors to be expected, so no target variance is needed.
constexpr std::uint64_t most_reference_spp = 1u << 20;

void ask_for_errors(Study& study) {
    study.convergence =
        ConvergenceSettings{.variance = any_variance, .most_spp = most_reference_spp, .without_checkpoints = true};
    study.spp_on = {{Backend::cpu, 256}, {Backend::cuda, 4096}};
}

// The study that the options --scene and --axis of `ptbench run` describe.
Suite suite_from_arguments(const RunArguments& arguments) {
    Study study;
    study.name = "adhoc";
    study.title = "From the command line";
    study.scenes = scenes_asked_for(arguments.scenes);
    study.spp = 4;
    study.is_of_a_call = true;
    if (arguments.error_against_time) {
        ask_for_errors(study);
    }
    return {.name = "adhoc", .description = "", .studies = {study}};
}

// Checks that --error-against-time has enough seeds for error bars, and no suite.
void check_error_against_time(const RunArguments& arguments, const RunOptions& options) {
    if (!arguments.error_against_time) {
        return;
    }
    if (!arguments.suite.empty()) {
        throw InputError("command line", "options", "--error-against-time beside --suite",
                         "--scene; a suite says of each study whether it is of type convergence");
    }
    if (options.repetitions > 0 && options.repetitions < limits::fewest_seeds) {
        throw InputError("command line", "--repetitions", std::to_string(options.repetitions),
                         fmt::format("{} or more with --error-against-time", limits::fewest_seeds));
    }
}

// Splits the values of an option such as --spp (one or more) into the first value and the others.
template <class T>
std::pair<T, std::vector<T>> first_and_others(const std::vector<T>& list) {
    return {list.front(), {list.begin() + 1, list.end()}};
}

// Options of the command line override the settings of a suite's study.
void override_study(Study& study, const RunArguments& arguments, Backend backend) {
    const AxisChoices axes = parse_axis_arguments(arguments.axes, arguments.devices, backend);
    const TunableValues tunables = parse_tunable_arguments(arguments.tunables);
    const auto override_set = [&](AxisChoices& set_axes, TunableValues& set_tunables) {
        for (const auto& [axis, choices] : axes) {
            set_axes[axis] = choices;
        }
        for (const auto& [name, values] : tunables) {
            set_tunables[name] = values;
        }
    };
    override_set(study.axes, study.tunables);
    for (VariantSet& set : study.variants) {
        override_set(set.axes, set.tunables);
    }
    if (!arguments.resolutions.empty()) {
        const auto [first, others] = first_and_others(parse_resolutions(arguments.resolutions));
        std::tie(study.width, study.height) = first;
        study.more_sizes = others;
        study.sizes_on.clear();
    }
    if (!arguments.depths.empty()) {
        study.depths = parse_whole_numbers(arguments.depths, "--depth", 1, 1000000);
    }
    if (!arguments.spps.empty()) {
        std::tie(study.spp, study.more_spp) =
            first_and_others(parse_whole_numbers(arguments.spps, "--spp", 1, 1000000));
        study.spp_on.clear();
    }
}

// The axis that a run compares: the first one in `axes` with several choices; if there is none, the integrator.
std::string compared_axis(const AxisChoices& axes) {
    for (const std::string_view axis : axis_names) {
        const auto choices = axes.find(std::string(axis));
        if (choices != axes.end() && choices->second.size() > 1) {
            return choices->first;
        }
    }
    return axes::integrator;
}

// Throws InputError if a Google Benchmark flag is given twice, of which the last would silently win.
void check_flags_once(const std::vector<std::string>& extras) {
    std::set<std::string> names;
    for (const std::string& extra : extras) {
        const std::string name = extra.substr(0, extra.find('='));
        if (!names.insert(name).second) {
            throw InputError("command line", "flag", name + " twice", "once");
        }
    }
}

// Splits Google Benchmark's flags into those that ptbench handles and those that are passed on.
RunOptions make_options(const RunArguments& arguments, const CLI::App& command, const std::string& command_line) {
    const std::vector<std::string> extras = command.remaining();
    check_flags_once(extras);
    std::vector<std::string> of_benchmark = extras;
    std::erase_if(of_benchmark, [](const std::string& extra) { return !extra.starts_with("--benchmark_"); });
    check_benchmark_flags(of_benchmark);
    RunOptions options{
        .out = arguments.out,
        .command_line = command_line,
        .repetitions = arguments.repetitions,
        .retakes = arguments.retakes,
        .decide_seconds = arguments.decide_seconds,
        .resume = arguments.resume,
        .overwrite = arguments.overwrite,
        .other_host = arguments.other_host,
        .quiet = arguments.quiet,
        .shard = arguments.shard.empty() ? Shard() : parse_shard(arguments.shard),
        .reference_cache = arguments.reference_cache.empty() ? default_reference_folder() : arguments.reference_cache,
        .untuned = arguments.untuned,
        .seed = arguments.seed};
    for (const std::string& extra : extras) {
        if (extra.starts_with("--benchmark_filter=")) {
            options.filter = extra.substr(extra.find('=') + 1);
        } else if (extra.starts_with("--benchmark_repetitions=")) {
            const char* const end = extra.data() + extra.size();
            const auto parsed = std::from_chars(extra.data() + extra.find('=') + 1, end, options.repetitions);
            if (arguments.repetitions > 0) {
                throw InputError("command line", "flags", "--repetitions and --benchmark_repetitions", "one of them");
            }
            if (parsed.ec != std::errc() || parsed.ptr != end || options.repetitions < 1) {
                throw InputError("--benchmark_repetitions", "argument", "\"" + extra + "\"", "a whole number from 1");
            }
        } else if (extra.starts_with("--benchmark_")) {
            options.benchmark_flags.push_back(extra);
        } else {
            throw InputError("command line", "argument", "\"" + extra + "\"",
                             "the options of `ptbench run --help` and --benchmark_* flags" +
                                 did_you_mean(extra.substr(0, extra.find('=')), option_names(command)));
        }
    }
    return options;
}

int run(const RunArguments& arguments, const CLI::App& command, const std::string& command_line) {
    RunOptions options = make_options(arguments, command, command_line);
    if (arguments.suite.empty() && arguments.scenes.empty() && arguments.axes.empty() && arguments.devices.empty()) {
        fmt::print("{}", what_run_compares(parse_backend(arguments.backend)));
        return exit_good;
    }
    if (arguments.suite.empty() == arguments.scenes.empty()) {
        throw InputError("command line", "options",
                         arguments.suite.empty() ? "neither --suite nor --scene" : "both --suite and --scene",
                         "one of them");
    }
    if (const std::string_view now = new_name_of_suite(arguments.suite); !now.empty()) {
        say("ptbench: the suite {} is called {} now\n", arguments.suite, now);
    }
    check_error_against_time(arguments, options);
    const Backend backend = arguments.compile_only.is_asked ? Backend::cuda : parse_backend(arguments.backend);
    Suite suite =
        arguments.suite.empty() ? suite_from_arguments(arguments) : load_suite(find_suite_file(arguments.suite));
    for (Study& study : suite.studies) {
        override_study(study, arguments, backend);
        if (arguments.suite.empty() && !study.convergence) {
            study.compares = compared_axis(study.axes);
        }
    }
    options.backend = backend;
    if (arguments.dry_run) {
        const Plan whole = plan_run(suite, options);
        fmt::print("{}", describe_plan(part_of(whole, positions_of(whole, options.shard)),
                                       options.repetitions > 0 ? options.repetitions : suite.repetitions));
        return exit_good;
    }
    if (arguments.compile_only.is_asked) {
        const Plan whole = plan_run(suite, options);
        const Plan part = part_of(whole, positions_of(whole, options.shard));
        compile_for(arguments.compile_only.architecture, compilations_of(part));
        return exit_good;
    }
    require_backend(backend);
    if (options.out.empty()) {
        const Shard& shard = options.shard;
        options.out = fmt::format(
            "results/{}/{}{}.json", on_ranks(backend == Backend::cuda ? cuda::machine_name() : machine_name()),
            suite.name, shard.is_whole() ? "" : fmt::format(".shard-{}-of-{}", shard.index, shard.count));
    }
    const int exit_code = run_suite(suite, options);
    if (arguments.error_against_time && exit_code <= exit_check_failed) {
        fmt::print("figures: python3 -m ptbench plots {}\n", options.out);
    }
    if (exit_code == exit_good && arguments.suite.empty() && arguments.axes.empty() && arguments.devices.empty() &&
        !arguments.quiet) {
        say("{}", nothing_to_compare(plan_run(suite, options)));
    }
    return exit_code;
}

}  // namespace

Command add_run_command(CLI::App& app, const std::string& command_line) {
    auto arguments = std::make_shared<RunArguments>();
    CLI::App* command = app.add_subcommand("run", "Verify and time variants; write a result file");
    command->add_option("--suite", arguments->suite, "Suite by name or .json file");
    command->add_option("--scene", arguments->scenes, "Scenes by name or .json file, comma-separated, or \"all\"");
    command->add_option("--axis", arguments->axes, "AXIS=CHOICE,CHOICE or AXIS=all, repeatable")
        ->allow_extra_args(false);
    command
        ->add_option("--devices", arguments->devices,
                     "Numbers of GPUs of this host: N,N, as --axis devices=N,N (default 1)")
        ->check(check_not_empty);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE,VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolutions, "WxH,WxH (default: the suite's or the scene's)");
    command->add_option("--depth", arguments->depths, "Ray segments in a path: D,D (1 to 1000000)");
    command->add_option("--spp", arguments->spps, "Samples per pixel and timed sample: N,N (1 to 1000000)");
    command->add_flag(
        "--error-against-time", arguments->error_against_time,
        "With --scene: errors against a reference at 1, 2, 4, .. samples a pixel, and what they are worth "
        "in time");
    command->add_option("--repetitions", arguments->repetitions, "Timed samples a cell (default: the suite's, or 9)")
        ->check(CLI::Range(1, 10000));
    command
        ->add_option("--retakes", arguments->retakes,
                     "Samples that other processes disturbed are taken again, at most N of a cell (default: as many as "
                     "it has samples; 0: none)")
        ->check(CLI::Range(0, 10000));
    command
        ->add_option("--decide", arguments->decide_seconds,
                     "More samples, for so many seconds, where a verdict is open by its interval's width (default: the "
                     "suite's, or 0: none); a cell comes to four times --repetitions at most")
        ->check(CLI::Range(0, 86400));
    command->add_option("--seed", arguments->seed, "Seed of the first sample (default 1)")->check(check_seed);
    command->add_option("--out", arguments->out, "Result file (default results/MACHINE/SUITE.json)")
        ->check(check_not_empty);
    CLI::Option* resume = command->add_flag("--resume", arguments->resume, "Go on with an unfinished run");
    command->add_flag("--overwrite", arguments->overwrite,
                      "Replace a result that is there, when the new one is complete; without --resume an unfinished "
                      "run starts over, and its journal is kept under another name");
    command
        ->add_flag("--other-host", arguments->other_host, "Go on although the host has another name (the result says)")
        ->needs(resume);
    command->add_option("--shard", arguments->shard,
                        "I/N: the I-th of N parts, for N equal machines; `ptbench merge` puts them together");
    command->add_flag("--quiet", arguments->quiet, "No progress on standard error");
    command->add_flag("--untuned", arguments->untuned,
                      "Leave tunables at their standards, whatever `ptbench autotune` found on this machine");
    command->add_option("--reference-cache", arguments->reference_cache,
                        "Folder that keeps references for studies of error (default: ptbench/references in "
                        "$XDG_CACHE_HOME or ~/.cache)");
    command->add_flag("--dry-run", arguments->dry_run, "List the cells, run nothing");
    add_compile_options(*command, arguments->compile_only);
    command->allow_extras();
    return [arguments, command, command_line] { return run(*arguments, *command, command_line); };
}

}  // namespace pt
