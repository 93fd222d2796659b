#include <fmt/format.h>

#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/machine/machine.h"

namespace pt {

Command add_machine_command(CLI::App& app) {
    app.add_subcommand("machine",
                       "Print this machine's name (its GPU's, where there is one), as used for folders in results/");
    return [] {
        fmt::print("{}\n", cuda::not_available().empty() ? cuda::machine_name() : machine_name());
        return exit_good;
    };
}

}  // namespace pt
