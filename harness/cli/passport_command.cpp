#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/bench/passport.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/machine/chip_rates.h"
#include "harness/machine/machine.h"
#include "harness/scene/places.h"

namespace pt {

namespace {

struct PassportArguments {
    std::string backend, out, command_line;
    bool resume = false, overwrite = false, quiet = false;
};

int run(const PassportArguments& arguments) {
    const Backend backend = parse_backend(arguments.backend);
    require_backend(backend);
    const bool is_gpu = backend == Backend::cuda;
    const std::string machine = is_gpu ? cuda::machine_name() : machine_name();
    return make_passport(
        load_suite(find_suite_file("passport")),
        {.backend = backend,
         .machine = machine,
         .chip =
             [is_gpu] {
                 nlohmann::ordered_json chip{{"cpu", measure_chip_rates()}};
                 if (is_gpu) {
                     chip["gpu"] = cuda::ceilings();
                     chip["gpu_rates"] = cuda::gpu_rates();
                 }
                 return chip;
             },
         .out = arguments.out.empty() ? fmt::format("results/passports/{}.json", machine) : arguments.out,
         .command_line = arguments.command_line,
         .resume = arguments.resume,
         .overwrite = arguments.overwrite,
         .quiet = arguments.quiet});
}

}  // namespace

Command add_passport_command(CLI::App& app, const std::string& command_line) {
    auto arguments = std::make_shared<PassportArguments>();
    arguments->command_line = command_line;
    CLI::App* command =
        app.add_subcommand("passport", "Ask this machine the seven questions, twice; minutes, one file");
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--out", arguments->out, "Passport file (default: results/passports/MACHINE.json)")
        ->check(check_not_empty);
    command->add_flag("--resume", arguments->resume, "Go on with a passport that was interrupted");
    command->add_flag("--overwrite", arguments->overwrite, "Replace the passport that is there, once this is complete");
    command->add_flag("--quiet", arguments->quiet, "No progress on stderr");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
