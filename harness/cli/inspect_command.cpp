#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/bench/fastest.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/files_read.h"
#include "harness/say.h"
#include "harness/scene/places.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

struct InspectArguments {
    std::string scene;
    std::vector<std::string> axes;
    std::vector<std::string> tunables;
    std::string architectures;
    bool counters = false;
    std::uint32_t spp = 16;
    std::string out;
};

std::string text_of_library_calls(const nlohmann::ordered_json& report) {
    std::string text;
    for (const auto& call : report["library_calls"]) {
        text += fmt::format(
            "  {}: library calls (Thrust or CUB) that nvcc compiled with ptbench; ncu says on a GPU what they take\n",
            call.get<std::string>());
    }
    return text;
}

std::string text_of_report(const nlohmann::ordered_json& report) {
    std::string text = fmt::format("{} on {}, {}\n", report["variant"].get<std::string>(),
                                   report["scene"].get<std::string>(), report["architecture"].get<std::string>());
    for (const auto& kernel : report["kernels"]) {
        text += fmt::format(
            "  {} ({}): {} registers, {} + {} spill bytes, {} shared bytes; {} warps of {} threads' blocks "
            "({:.0f} %, limited by {}){}\n",
            kernel["name"].get<std::string>(), kernel["of"].get<std::string>(), kernel["registers"].get<int>(),
            kernel["spill_store_bytes"].get<int>(), kernel["spill_load_bytes"].get<int>(),
            kernel["shared_bytes"].get<int>(), kernel["warps_per_multiprocessor"].get<int>(),
            kernel["threads_per_block"].get<int>(), 100 * kernel["occupancy"].get<double>(),
            kernel["occupancy_limit"].get<std::string>(),
            kernel.value("launched", true) ? "" : "; not launched: the integrator's kernel does its work");
        for (const char* part : {"instructions", "instructions_in_loop"}) {
            if (kernel.contains(part)) {
                text += fmt::format("    {:<21}", part == std::string("instructions") ? "instructions" : "in its loop");
                for (const auto& [pipe, count] : kernel[part].items()) {
                    text += fmt::format(" {} {}", pipe, count.get<std::size_t>());
                }
                text += "\n";
            }
        }
        if (kernel.contains("counters")) {
            const auto& counters = kernel["counters"];
            text += fmt::format(
                "    {:.3f} ms, {:.1f} of 32 lanes active, {:.1f} instructions a ray and thread, {:.1f} bytes "
                "of memory a ray; {:.0f} % of the issue ceiling, {:.0f} % of the {} ceiling\n",
                counters["milliseconds"].get<double>(), counters["active_lanes"].get<double>(),
                counters["thread_instructions_per_ray"].get<double>(), counters["memory_bytes_per_ray"].get<double>(),
                100 * counters["of_ceiling"]["issue"].get<double>(),
                100 * counters["of_ceiling"][counters["bound"].get<std::string>()].get<double>(),
                counters["bound"].get<std::string>());
        }
    }
    return text + text_of_library_calls(report);
}

// A table of the kernels of one variant: one line per kernel and architecture. A kernel whose thread block is too large
// for a multiprocessor says so.
std::string table_of_reports(std::span<const nlohmann::ordered_json> reports) {
    const nlohmann::ordered_json& first = reports.front();
    std::string text =
        fmt::format("{} on {}\n  {:<44} {:<7} {:>9} {:>11} {:>12} {:>7}  {:<14} {}\n",
                    first["variant"].get<std::string>(), first["scene"].get<std::string>(), "kernel", "arch",
                    "registers", "spill bytes", "shared bytes", "threads", "warps an SM", "limited by");
    for (const auto& named : first["kernels"]) {
        std::string name = fmt::format("{} ({}){}", named["name"].get<std::string>(), named["of"].get<std::string>(),
                                       named.value("launched", true) ? "" : ", not launched");
        for (const nlohmann::ordered_json& report : reports) {
            // The compiler may list the kernels of another architecture in another order.
            const auto& kernel = *std::find_if(
                report["kernels"].begin(), report["kernels"].end(),
                [&](const auto& one) { return one["name"] == named["name"] && one["of"] == named["of"]; });
            const int warps = kernel["warps_per_multiprocessor"].get<int>();
            text +=
                fmt::format("  {:<44} {:<7} {:>9} {:>11} {:>12} {:>7}  {:<14} {}\n", std::exchange(name, ""),
                            report["architecture"].get<std::string>(), kernel["registers"].get<int>(),
                            kernel["spill_store_bytes"].get<int>() + kernel["spill_load_bytes"].get<int>(),
                            kernel["shared_bytes"].get<int>(), kernel["threads_per_block"].get<int>(),
                            warps == 0 ? "no block fits"
                                       : fmt::format("{} ({:.0f} %)", warps, 100 * kernel["occupancy"].get<double>()),
                            kernel["occupancy_limit"].get<std::string>());
        }
    }
    return text + text_of_library_calls(first);
}

// Adds hardware counters to the report: renders once to count rays, then once under ncu.
void add_counters(const InspectArguments& arguments, const Scene& scene, const Variant& variant,
                  nlohmann::ordered_json& report) {
    RenderRequest request{
        .variant = variant, .backend = Backend::cuda, .settings = default_settings(scene), .samples = arguments.spp};
    request.settings.seed = 1;
    const RenderResult result = render_named(scene, request);
    std::vector<std::string> call{"--scene", arguments.scene, "--backend",
                                  "cuda",    "--spp",         std::to_string(arguments.spp)};
    for (const std::string_view axis : axis_names) {
        call.insert(call.end(), {"--axis", fmt::format("{}={}", axis, variant[axis])});
    }
    for (const auto& [tunable, value] : variant.tuning) {
        call.insert(call.end(), {"--tune", fmt::format("{}={}", tunable, value)});
    }
    std::vector<std::string> kernels;
    for (const auto& kernel : report["kernels"]) {
        kernels.push_back(kernel["name"]);
    }
    const auto counted = cuda::kernel_counters(call, kernels, static_cast<double>(result.work.rays));
    report["rays"] = result.work.rays;
    report["spp"] = arguments.spp;
    report["ceilings"] = counted["ceilings"];
    for (auto& kernel : report["kernels"]) {
        const auto found = counted["kernels"].find(kernel["name"].get<std::string>());
        if (found != counted["kernels"].end()) {
            kernel["counters"] = *found;
        }
    }
}

std::vector<Variant> asked_variants(const InspectArguments& arguments, const Scene& scene) {
    const AxisChoices axes = parse_axis_arguments(arguments.axes, Backend::cuda);
    const TunableValues tunables = parse_tunable_arguments(arguments.tunables);
    if (const std::string tree = tree_in_words(axes, tunables, scene, Backend::cuda); !tree.empty()) {
        say("{}: {}\n", scene.name, tree);
    }
    std::vector<Variant> variants = expand(with_tree(axes, tunables, scene, Backend::cuda), Backend::cuda, tunables);
    for (Variant& variant : variants) {
        variant = with_light_sampling(variant, axes, features_of(scene), Backend::cuda);
    }
    return variants;
}

std::vector<std::string> asked_architectures(const InspectArguments& arguments) {
    if (arguments.architectures.empty()) {
        return {""};  // "" stands for the architecture of this machine's GPU
    }
    const std::vector<std::string> names = split_names(arguments.architectures, "--arch");
    for (const std::string& name : names) {
        if (!cuda::why_not_an_architecture(name).empty()) {
            throw InputError("command line", "--arch", name, cuda::architectures());
        }
    }
    return names;
}

// Inspects a variant's kernels on each architecture. If one does not compile, prints the reason and returns no report.
std::vector<nlohmann::ordered_json> reports_on(const Scene& scene, const Variant& variant,
                                               const std::vector<std::string>& architectures) {
    std::vector<nlohmann::ordered_json> reports;
    for (const std::string& architecture : architectures) {
        try {
            reports.push_back(cuda::inspect_kernels(scene, variant, architecture));
        } catch (const cuda::DoesNotCompile& error) {
            say("ptbench: {}: {}\n", shown_name(variant, Backend::cuda), error.what());
            return {};
        }
    }
    return reports;
}

void check_arguments(const InspectArguments& arguments) {
    if (arguments.counters && !arguments.architectures.empty()) {
        throw InputError("command line", "--counters", "--arch " + arguments.architectures,
                         "no --arch: counters come from this machine's GPU");
    }
    if (!arguments.out.empty()) {
        check_output_file(arguments.out);
        refuse_source(arguments.out);
        refuse_result(arguments.out);
    }
    (void)parse_backend("cuda");  // parse_backend() throws if this build lacks the CUDA backend
}

int run(const InspectArguments& arguments) {
    const Scene scene = find_scene(arguments.scene);
    check_arguments(arguments);
    const std::vector<std::string> architectures = asked_architectures(arguments);
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    std::string not_applicable;
    bool all_compile = true;
    for (const Variant& variant : asked_variants(arguments, scene)) {
        const std::string reason = why_not_applicable(variant, features_of(scene), Backend::cuda);
        if (!reason.empty()) {
            not_applicable +=
                fmt::format("n/a: {} on {}: {}\n", shown_name(variant, Backend::cuda), scene.name, reason);
            continue;
        }
        std::vector<nlohmann::ordered_json> reports = reports_on(scene, variant, architectures);
        if (reports.empty()) {
            all_compile = false;
            continue;
        }
        if (arguments.counters) {
            add_counters(arguments, scene, variant, reports.front());
        }
        fmt::print("{}", reports.size() > 1 ? table_of_reports(reports) : text_of_report(reports.front()));
        for (nlohmann::ordered_json& report : reports) {
            all.push_back(std::move(report));
        }
    }
    if (!all_compile) {
        return exit_check_failed;
    }
    if (all.empty()) {
        throw InputError(not_applicable.substr(0, not_applicable.find('\n')));
    }
    fmt::print("{}", not_applicable);
    if (!arguments.out.empty()) {
        write_file(arguments.out, all.dump(1) + "\n");
    }
    return exit_good;
}

}  // namespace

Command add_inspect_command(CLI::App& app) {
    auto arguments = std::make_shared<InspectArguments>();
    CLI::App* command = app.add_subcommand(
        "inspect", "What a CUDA variant's kernels are made of: registers, occupancy, machine code by pipe");
    command->add_option("--scene", arguments->scene, "Scene by name or .json file")->required();
    command->add_option("--axis", arguments->axes, "AXIS=CHOICE,CHOICE, repeatable")->allow_extra_args(false);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE,VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--arch", arguments->architectures,
                        "GPU architectures, comma-separated, e.g. sm_75,sm_90; needs no such GPU (default: this "
                        "machine's). Of several, a table");
    command->add_flag("--counters", arguments->counters,
                      "Also run them under ncu: lanes, instructions and bytes a ray, and the bound they run at");
    command->add_option("--spp", arguments->spp, "Samples per pixel under --counters (default 16)")
        ->check(CLI::Range(1u, 100000u));
    command->add_option("--out", arguments->out, "Also write the report as JSON, if all of it compiles");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
