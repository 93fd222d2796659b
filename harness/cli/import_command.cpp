#include <fmt/format.h>

#include "harness/cli/commands.h"
#include "harness/json_reader.h"
#include "harness/scene/import_seed.h"
#include "harness/write_file.h"

namespace pt {

Command add_import_command(CLI::App& app) {
    struct ImportArguments {
        std::string file;
        std::string out;
    };
    auto arguments = std::make_shared<ImportArguments>();
    CLI::App* command = app.add_subcommand("import", "Turn a scene in the CIS 565 text format into a scene file");
    command->add_option("FILE", arguments->file, "The text file")->required();
    command->add_option("--out", arguments->out, "Scene file to write (.json)")->required();
    return [arguments] {
        write_file(arguments->out, import_seed_scene(read_file(arguments->file), arguments->file));
        fmt::print("{}\n", arguments->out);
        return exit_good;
    };
}

}  // namespace pt
