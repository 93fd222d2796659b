#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "harness/bench/kept_result.h"
#include "harness/cli/commands.h"
#include "harness/counted.h"
#include "harness/interchange/export_mitsuba.h"
#include "harness/interchange/import_findings.h"
#include "harness/interchange/mitsuba_limits.h"
#include "harness/json_reader.h"
#include "harness/say.h"
#include "harness/scene/places.h"
#include "harness/write_file.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

struct ExportArguments {
    std::string scene;
    std::string format;
    std::string out;
    std::string resolution;
    std::uint32_t depth = 0;
    std::uint32_t spp = 64;
    double scale = 1;
    bool overwrite = false;
};

void check_arguments(const ExportArguments& arguments) {
    if (arguments.format != "mitsuba") {
        throw InputError("--format", "argument", "\"" + arguments.format + "\"", "mitsuba");
    }
    int exponent = 0;
    if (std::frexp(arguments.scale, &exponent) != 0.5 || exponent < -59 || exponent > 61) {
        throw InputError("--scale", "argument", fmt::format("{}", arguments.scale),
                         "a power of two from 2^-60 to 2^60, so that no length is rounded");
    }
}

// The XML file to export to: `out` if its name ends in .xml, otherwise the scene's name with .xml in the folder `out`.
fs::path xml_file(const ExportArguments& arguments, const Scene& scene) {
    const fs::path out(arguments.out);
    return out.extension() == ".xml" ? out : out / (scene.name + ".xml");
}

MitsubaSettings settings_of(const ExportArguments& arguments, const Scene& scene) {
    MitsubaSettings settings{.width = scene.camera.width,
                             .height = scene.camera.height,
                             .depth = arguments.depth != 0 ? arguments.depth : scene.max_depth,
                             .samples = arguments.spp,
                             .scale = arguments.scale};
    if (!arguments.resolution.empty()) {
        std::tie(settings.width, settings.height) = parse_resolution(arguments.resolution);
    }
    return settings;
}

int refuse(const std::vector<std::string>& problems, const std::string& scene) {
    for (const std::string& problem : problems) {
        say("ptbench: {}\n", problem);
    }
    say("ptbench: {}: {}; nothing is written\n", one_line(scene), counted(problems.size(), "problem"));
    return exit_bad_input;
}

int run(const ExportArguments& arguments) {
    check_arguments(arguments);
    const Scene scene = find_scene(arguments.scene);
    const MitsubaSettings settings = settings_of(arguments, scene);
    const std::vector<std::string> problems = mitsuba_problems(scene, arguments.scene, settings.depth);
    if (!problems.empty()) {
        return refuse(problems, arguments.scene);
    }
    const fs::path xml = xml_file(arguments, scene);
    check_output_file(xml.string());
    refuse_result(xml.string());
    const MitsubaScene exported = mitsuba_scene(scene, settings, xml);
    check_replacement(xml.string(), exported.xml, arguments.overwrite);
    exported.files.write(exported.xml);
    constexpr double visible = 0.5;
    if (const double offset = mitsuba_offset_by_thickness(scene, arguments.scale); offset > visible) {
        say("ptbench: {}: note: Mitsuba's rays start up to {:.2g} of the thinnest object's thickness off a "
            "surface; a larger --scale may lessen it\n",
            one_line(arguments.scene), offset);
    }
    fmt::print("{}: {}, {} -> {}\n", scene.name, counted(scene.objects.size(), "object"),
               counted(exported.meshes, "mesh file"), one_line(xml.string()));
    return exit_good;
}

}  // namespace

Command add_export_command(CLI::App& app) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command = app.add_subcommand("export", "Write a scene for another renderer (docs/other_renderers.md)");
    command->add_option("SCENE", arguments->scene, "Scene by name or .json file")->required()->check(check_not_empty);
    command->add_option("--format", arguments->format, "mitsuba: Mitsuba 3's XML, meshes as PLY and images beside it")
        ->required();
    command->add_option("--out", arguments->out, "The file (.xml), or a folder for it")
        ->required()
        ->check(check_not_empty);
    command->add_option("--resolution", arguments->resolution, "WxH (default: the scene's)");
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--spp", arguments->spp, "Samples per pixel that the file asks for (default 64)")
        ->check(CLI::Range(1u, 100000000u));
    command->add_option("--scale", arguments->scale, "Every length times this power of two (default 1)");
    command->add_flag("--overwrite", arguments->overwrite, "Replace a file that is there and holds something else");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
