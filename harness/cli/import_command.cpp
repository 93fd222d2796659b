#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/kept_result.h"
#include "harness/cli/commands.h"
#include "harness/counted.h"
#include "harness/interchange/import_scene.h"
#include "harness/json_reader.h"
#include "harness/say.h"
#include "harness/write_file.h"

namespace pt {

namespace {

struct ImportArguments {
    std::string file;
    std::string out;
    std::string name;
    bool has_name = false;
    bool strict = false;
    bool overwrite = false;
};

void check_import_arguments(const ImportArguments& arguments) {
    if (arguments.has_name) {
        const Json name(arguments.name);
        (void)JsonValue(name, "--name", "argument").plain_name();
    }
    check_output_file(arguments.out);
    refuse_result(arguments.out);
    std::error_code ignored;
    if (std::filesystem::equivalent(arguments.out, arguments.file, ignored)) {
        throw InputError("--out", "argument", "\"" + arguments.out + "\", the file to import", "another file");
    }
}

void print_findings(const ImportFindings& findings, const std::string& file, const std::string& kind) {
    for (const std::string& message : findings.messages(file, kind)) {
        say("ptbench: {}\n", message);
    }
}

// Reports how many problems (and warnings, with --strict) prevent the import; returns the exit code.
int refuse_import(const ImportResult& result, const ImportArguments& arguments) {
    const std::size_t problems = result.problems.count(), warnings = arguments.strict ? result.warnings.count() : 0;
    const std::string refused = fmt::format("{}{}{}", problems > 0 ? counted(problems, "problem") : "",
                                            problems > 0 && warnings > 0 ? " and " : "",
                                            warnings > 0 ? counted(warnings, "warning") + " with --strict" : "");
    say("ptbench: {}: {}; no scene is written\n", one_line(arguments.file), refused);
    return exit_bad_input;
}

int import_file(const ImportArguments& arguments) {
    check_import_arguments(arguments);
    const ImportResult result = import_scene(
        {.text = read_import(arguments.file), .file = arguments.file, .out = arguments.out, .name = arguments.name});
    print_findings(result.problems, arguments.file, "");
    const bool is_scene = result.problems.count() == 0;
    if (is_scene || arguments.strict) {  // warnings about a scene with problems would be incomplete
        print_findings(result.warnings, arguments.file, "warning");
    }
    if (!is_scene || (arguments.strict && result.warnings.count() > 0)) {
        return refuse_import(result, arguments);
    }
    check_replacement(arguments.out, result.json, arguments.overwrite);
    print_findings(result.notes, arguments.file, "note");
    result.files.write(result.json);
    const std::string notes = result.notes.count() > 0 ? ", " + counted(result.notes.count(), "note") : "";
    fmt::print("{}: {}, {}, {}{} -> {}\n", one_line(arguments.file), counted(result.objects, "object"),
               counted(result.materials, "material"), counted(result.warnings.count(), "warning"), notes,
               one_line(arguments.out));
    return exit_good;
}

// The formats that can be imported, as "CIS 565 JSON (.json), ..".
std::string import_format_list() {
    std::vector<std::string> formats;
    for (const ImportFormat& format : import_formats()) {
        formats.push_back(fmt::format("{} ({})", format.name, fmt::join(format.endings, ", ")));
    }
    return fmt::format("{}", fmt::join(formats, ", "));
}

}  // namespace

Command add_import_command(CLI::App& app) {
    auto arguments = std::make_shared<ImportArguments>();
    CLI::App* command = app.add_subcommand("import", "Turn another program's scene into a scene file");
    command->add_option("FILE", arguments->file, "The scene: " + import_format_list())->required();
    command->add_option("--out", arguments->out, "Scene file to write (.json)")->required();
    const CLI::Option* name = command->add_option("--name", arguments->name, "The scene's name (default: the file's)");
    command->add_flag("--strict", arguments->strict, "Refuse a file that is not read exactly: warnings are errors");
    command->add_flag("--overwrite", arguments->overwrite,
                      "Replace a scene file that is there and holds something else");
    return [arguments, name] {
        arguments->has_name = name->count() > 0;
        return import_file(*arguments);
    };
}

}  // namespace pt
