// `ptbench replay`: one path bounce by bounce, in single and double precision side by side.
#include <fmt/format.h>

#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/scene/places.h"
#include "harness/stability/replay.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

struct ReplayArguments {
    std::string scene;
    std::string pixel;
    std::uint32_t sample = 0;
    std::vector<std::string> axes;
    std::string resolution;
    std::uint32_t depth = 0;
    std::uint64_t seed = 1;
    std::uint32_t diverging = 0;
};

std::string text_of(const Vec3d& v) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z); }

void print_side(const char* name, const std::vector<stability::Step>& steps, std::size_t i) {
    if (i >= steps.size()) {
        fmt::print("  {:<7} over\n", name);
        return;
    }
    const stability::Step& step = steps[i];
    fmt::print("  {:<7} {} at t {:.9g}\n", name, step.object, step.t);
    if (step.object != "nothing") {
        fmt::print("          point {} normal {}\n", text_of(step.position), text_of(step.normal));
    }
    if (step.is_alive) {
        fmt::print("          leaves in {} carrying {}\n", text_of(step.direction), text_of(step.throughput));
    }
    fmt::print("          collected {}{}\n", text_of(step.radiance), step.is_alive ? "" : "; ends");
}

// Parses a pixel, "x,y", and returns its row-major index.
std::uint32_t parse_pixel(const std::string& text, const RenderSettings& settings) {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    int used = 0;
    const bool good = std::sscanf(text.c_str(), "%u,%u%n", &x, &y, &used) == 2 &&
                      static_cast<std::size_t>(used) == text.size() && x < settings.width && y < settings.height &&
                      text.find_first_not_of("0123456789,") == std::string::npos;
    if (!good) {
        throw InputError("--pixel", "argument", "\"" + text + "\"",
                         fmt::format("X,Y with X below {} and Y below {}", settings.width, settings.height));
    }
    return y * settings.width + x;
}

int run(const ReplayArguments& arguments) {
    const Scene scene = find_scene(arguments.scene);
    const AxisChoices axes = parse_axis_arguments(arguments.axes, Backend::cpu);
    Variant variant = Registry::instance().reference(Registry::instance().baseline(Backend::cpu), Backend::cpu);
    for (const auto& [axis, choices] : axes) {
        if (choices.size() != 1) {
            throw InputError("--axis", axis, fmt::format("{} choices", choices.size()), "one, for a replay");
        }
        variant.set(axis, choices.front());
    }
    if (const std::string reason = why_not_applicable(variant, features_of(scene), Backend::cpu); !reason.empty()) {
        throw InputError(fmt::format("n/a: {} on {}: {}", shown_name(variant, Backend::cpu), scene.name, reason));
    }
    RenderRequest request{.variant = variant, .settings = default_settings(scene)};
    request.settings.seed = arguments.seed;
    if (!arguments.resolution.empty()) {
        std::tie(request.settings.width, request.settings.height) = parse_resolution(arguments.resolution);
    }
    if (arguments.depth != 0) {
        request.settings.depth = arguments.depth;
    }
    const KernelChoice kernel = choose_kernel(scene, variant);
    const RenderSettings settings = settings_for(request, kernel);
    const FeatureSet formula = kernel.needed & formulas;
    if (arguments.diverging != 0) {
        const stability::Divergence divergence = stability::divergence(scene, settings, formula, arguments.diverging);
        fmt::print("{} of {} paths go another way in double precision; mean radiance differs by {:.3g} +- {:.2g}\n",
                   divergence.parted(), divergence.paths, divergence.difference, divergence.standard_error);
        for (std::size_t segment = 0; segment < divergence.parted_at.size(); ++segment) {
            fmt::print("  at segment {}: {}\n", segment + 1, divergence.parted_at[segment]);
        }
        return exit_good;
    }
    const std::uint32_t pixel = parse_pixel(arguments.pixel, settings);
    const auto single = stability::replay_single(scene, settings, formula, pixel, arguments.sample);
    const auto fp64 = stability::replay_double(scene, settings, formula, pixel, arguments.sample);
    fmt::print("{} pixel {} sample {} seed {}, {}\n", scene.name, arguments.pixel, arguments.sample, arguments.seed,
               shown_name(variant, Backend::cpu));
    const auto parting = stability::first_parting(single, fp64);
    for (std::size_t i = 0; i < std::max(single.size(), fp64.size()); ++i) {
        fmt::print("segment {}{}\n", i + 1, parting == i + 1 ? "  <- the two part here" : "");
        print_side(traits_of(variant, Backend::cpu).precision.is_mixed() ? "mixed" : "float", single, i);
        print_side("double", fp64, i);
    }
    fmt::print("{}\n", parting ? fmt::format("they part at segment {}", *parting) : "both go the same way");
    return exit_good;
}

}  // namespace

Command add_replay_command(CLI::App& app) {
    auto arguments = std::make_shared<ReplayArguments>();
    CLI::App* command =
        app.add_subcommand("replay", "One path bounce by bounce, in single and double precision side by side");
    command->add_option("--scene", arguments->scene, "Scene by name or .json file")->required();
    CLI::Option* const pixel =
        command->add_option("--pixel", arguments->pixel, "X,Y from the image's upper left corner");
    command->add_option("--sample", arguments->sample, "Number of the sample (default 0)");
    command->add_option("--axis", arguments->axes, "AXIS=CHOICE, repeatable")->allow_extra_args(false);
    command->add_option("--resolution", arguments->resolution, "WxH (default: the scene's)");
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--seed", arguments->seed, "Seed (default 1)")->check(check_seed);
    command
        ->add_option("--diverging", arguments->diverging,
                     "Instead: how many paths of so many samples a pixel go another way in double precision, and where")
        ->check(CLI::Range(1u, 1000000u))
        ->excludes(pixel);
    return [arguments] {
        if (arguments->pixel.empty() && arguments->diverging == 0) {
            throw InputError("replay", "arguments", "neither --pixel nor --diverging", "one of them");
        }
        return run(*arguments);
    };
}

}  // namespace pt
