#include <fmt/format.h>

#include "harness/cli/commands.h"
#include "harness/counted.h"
#include "harness/files_beside.h"
#include "harness/mesh/generate.h"
#include "harness/mesh/write_mesh.h"
#include "harness/write_file.h"

namespace pt {

namespace {

struct GenerateArguments {
    std::string name;
    std::uint32_t size = 0;
    std::string out;
    bool has_size = false;
    bool overwrite = false;
};

void list_generators() {
    for (const Generator& generator : generators()) {
        fmt::print("{:<12} {}; N: {} ({} to {}); {} triangles\n", generator.name, generator.what, generator.size,
                   generator.least_size, generator.most_size, generator.formula);
    }
}

int generate_file(const GenerateArguments& arguments) {
    if (arguments.name.empty()) {
        if (arguments.has_size || !arguments.out.empty()) {
            throw InputError("generate", "NAME", "none", "the name of a mesh (`ptbench generate` lists them)");
        }
        list_generators();
        return exit_good;
    }
    if (find_generator(arguments.name) != nullptr && (!arguments.has_size || arguments.out.empty())) {
        throw InputError("generate", arguments.has_size ? "--out" : "--size", "none", "NAME --size N --out FILE");
    }
    if (!arguments.out.empty()) {
        check_mesh_name(arguments.out);
    }
    const Mesh mesh = generate_mesh(arguments.name, arguments.size);
    const std::string content = mesh_file_of(mesh, arguments.out);
    check_replacement(arguments.out, content, arguments.overwrite);
    write_file(arguments.out, content);
    fmt::print("{} {}: {}, {} vertices{}, {} -> {}\n", arguments.name, arguments.size,
               counted(mesh.triangles.size(), "triangle"), mesh.vertices.size(),
               mesh.degenerate_left_out > 0
                   ? fmt::format(", {} without area left out", counted(mesh.degenerate_left_out, "triangle"))
                   : "",
               content_hash(mesh), one_line(arguments.out));
    return exit_good;
}

}  // namespace

Command add_generate_command(CLI::App& app) {
    auto arguments = std::make_shared<GenerateArguments>();
    CLI::App* command = app.add_subcommand("generate", "Write a triangle mesh that has a name; without one, list them");
    command->add_option("NAME", arguments->name, "The mesh")->check(check_not_empty);
    const CLI::Option* size = command->add_option("--size", arguments->size, "N, what the list says of it");
    command->add_option("--out", arguments->out, "Mesh file to write (.ply or .obj)")->check(check_not_empty);
    command->add_flag("--overwrite", arguments->overwrite, "Replace a file that is there and holds something else");
    return [arguments, size] {
        arguments->has_size = size->count() > 0;
        return generate_file(*arguments);
    };
}

}  // namespace pt
