#include <charconv>

#include <fmt/format.h>

#include "harness/bench/machine.h"
#include "harness/bench/runner.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/places.h"

namespace pt {

namespace {

struct RunArguments {
    std::string suite;
    std::string scenes;
    std::vector<std::string> axes;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolution;
    std::uint32_t depth = 0;
    std::uint32_t spp = 0;
    int repetitions = 0;
    std::uint64_t seed = 1;
    std::string out;
    bool resume = false;
    bool other_host = false;
    bool quiet = false;
    std::string shard;
    bool untuned = false;
    bool dry_run = false;
    std::string reference_cache;
};

// The study that --scene and --axis describe.
Suite suite_from_arguments(const RunArguments& arguments) {
    Study study;
    study.name = "adhoc";
    study.title = "From the command line";
    study.scenes = split_names(arguments.scenes);
    study.spp = 4;
    return {.name = "adhoc", .description = "", .studies = {study}};
}

void override_study(Study& study, const RunArguments& arguments, Backend backend) {
    for (const std::string& argument : arguments.axes) {
        add_axis_argument(study.axes, argument, backend);
        for (VariantSet& set : study.variants) {
            add_axis_argument(set.axes, argument, backend);
        }
    }
    for (const std::string& argument : arguments.tunables) {
        add_tunable_argument(study.tunables, argument);
        for (VariantSet& set : study.variants) {
            add_tunable_argument(set.tunables, argument);
        }
    }
    if (!arguments.resolution.empty()) {
        std::tie(study.width, study.height) = parse_resolution(arguments.resolution);
        study.more_sizes.clear();
        study.sizes_on.clear();
    }
    if (arguments.depth != 0) {
        study.depths = {arguments.depth};
    }
    if (arguments.spp != 0) {
        study.spp = arguments.spp;
        study.spp_on.clear();
    }
}

// The axis that was given choices to compare: the first with more than one, or else the integrator.
std::string compared_axis(const AxisChoices& axes) {
    for (const std::string_view axis : axis_names) {
        const auto choices = axes.find(std::string(axis));
        if (choices != axes.end() && choices->second.size() > 1) {
            return choices->first;
        }
    }
    return "integrator";
}

// Splits Google Benchmark's flags into those that ptbench owns and those that are passed on.
RunOptions make_options(const RunArguments& arguments, const std::vector<std::string>& extras,
                        const std::string& command_line) {
    RunOptions options{
        .out = arguments.out,
        .command_line = command_line,
        .repetitions = arguments.repetitions,
        .resume = arguments.resume,
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
            if (parsed.ec != std::errc() || parsed.ptr != end || options.repetitions < 1) {
                throw InputError("--benchmark_repetitions", "argument", "\"" + extra + "\"", "a whole number from 1");
            }
        } else if (extra.starts_with("--benchmark_list_tests")) {
            throw InputError("command line", "flag", "\"" + extra + "\"", "--dry-run, which lists the cells");
        } else if (extra.starts_with("--benchmark_")) {
            options.benchmark_flags.push_back(extra);
        } else {
            throw InputError("command line", "argument", "\"" + extra + "\"",
                             "the options of `ptbench run --help` and --benchmark_* flags");
        }
    }
    return options;
}

int run(const RunArguments& arguments, const std::vector<std::string>& extras, const std::string& command_line) {
    if (arguments.suite.empty() == arguments.scenes.empty()) {
        throw InputError("command line", "options",
                         arguments.suite.empty() ? "neither --suite nor --scene" : "both --suite and --scene",
                         "one of them");
    }
    const Backend backend = parse_backend(arguments.backend);
    Suite suite =
        arguments.suite.empty() ? suite_from_arguments(arguments) : load_suite(find_suite_file(arguments.suite));
    for (Study& study : suite.studies) {
        override_study(study, arguments, backend);
        if (arguments.suite.empty()) {
            study.figure = compared_axis(study.axes);
        }
    }
    RunOptions options = make_options(arguments, extras, command_line);
    options.backend = backend;
    if (arguments.dry_run) {
        const Plan whole = plan_run(suite, options);
        fmt::print("{}", describe_plan(part_of(whole, positions_of(whole, options.shard)),
                                       options.repetitions > 0 ? options.repetitions : suite.repetitions));
        return exit_good;
    }
    require_backend(backend);
    if (options.out.empty()) {
        const Shard& shard = options.shard;
        options.out =
            fmt::format("results/{}/{}{}.json", backend == Backend::cuda ? cuda::machine_name() : machine_name(),
                        suite.name, shard.is_whole() ? "" : fmt::format(".shard-{}-of-{}", shard.index, shard.count));
    }
    return run_suite(suite, options);
}

}  // namespace

Command add_run_command(CLI::App& app, const std::string& command_line) {
    auto arguments = std::make_shared<RunArguments>();
    CLI::App* command = app.add_subcommand("run", "Verify and time variants; write a result file");
    command->add_option("--suite", arguments->suite, "Suite by name or .json file");
    command->add_option("--scene", arguments->scenes, "Scenes by name or .json file, comma-separated");
    command->add_option("--axis", arguments->axes, "AXIS=CHOICE,CHOICE or AXIS=all, repeatable")
        ->allow_extra_args(false);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE,VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolution, "WxH (default: the suite's or the scene's)");
    command->add_option("--depth", arguments->depth, "Ray segments in a path")->check(CLI::Range(1u, 1000000u));
    command->add_option("--spp", arguments->spp, "Samples per pixel and timed sample")->check(CLI::Range(1u, 1000000u));
    command->add_option("--repetitions", arguments->repetitions, "Timed samples a cell (default: the suite's, or 9)")
        ->check(CLI::Range(1, 10000));
    command->add_option("--seed", arguments->seed, "Seed of the first sample (default 1)")->check(check_seed);
    command->add_option("--out", arguments->out, "Result file (default results/MACHINE/SUITE.json)");
    CLI::Option* resume = command->add_flag("--resume", arguments->resume, "Go on with an unfinished run");
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
    command->allow_extras();
    return [arguments, command, command_line] { return run(*arguments, command->remaining(), command_line); };
}

}  // namespace pt
