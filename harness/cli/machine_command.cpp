#include <fmt/format.h>

#include "harness/bench/machine.h"
#include "harness/cli/commands.h"
#include "harness/error.h"

namespace pt {

Command add_machine_command(CLI::App& app) {
    app.add_subcommand("machine", "Print this machine's name, as used for folders in results/");
    return [] {
        fmt::print("{}\n", machine_name());
        return exit_good;
    };
}

}  // namespace pt
