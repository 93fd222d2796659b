#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/compile_ahead.h"
#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/cli/commands.h"
#include "harness/places.h"

namespace pt {

namespace {

struct VerifyArguments {
    std::string scenes;
    std::vector<std::string> axes;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolution = "64x64";
    std::uint32_t spp = 4;
    std::uint32_t depth = 0;
    std::uint64_t seed = 1;
    bool quiet = false;
};

struct Tally {
    std::size_t held = 0, failed = 0, not_applicable = 0;
};

// A variant that throws fails; the others go on.
Verdict check_or_fail(Verifier& verifier, const Variant& variant) {
    try {
        return verifier.check(variant);
    } catch (const std::exception& exception) {
        return {false, "no film", exception.what()};
    }
}

void verify_scene(const Scene& scene, Backend backend, const std::vector<Variant>& variants,
                  const VerifyArguments& arguments, Tally& tally) {
    RenderSettings settings = default_settings(scene);
    std::tie(settings.width, settings.height) = parse_resolution(arguments.resolution);
    settings.depth = arguments.depth != 0 ? arguments.depth : scene.max_depth;
    settings.seed = arguments.seed;
    Verifier verifier(scene, settings, arguments.spp, backend);
    const FeatureSet features = features_of(scene);
    for (const Variant& variant : variants) {
        if (const std::string reason = why_not_applicable(variant, features, backend); !reason.empty()) {
            tally.not_applicable += 1;
            if (!arguments.quiet) {
                fmt::print("n/a              {}/scene:{}  {}\n", variant.name(), scene.name, reason);
            }
            continue;
        }
        const Verdict verdict = check_or_fail(verifier, variant);
        (verdict.holds ? tally.held : tally.failed) += 1;
        if (!verdict.holds || !arguments.quiet) {
            fmt::print("{} {}/scene:{}  {}  {}\n", verdict.film_hash, variant.name(), scene.name,
                       verdict.holds ? "ok" : "FAILED", verdict.message);
            std::fflush(stdout);
        }
    }
}

// A product of all choices is small on the CPU backend. On CUDA it is half a million: without --axis a covering set is
// verified instead, in which every two choices of two axes meet.
std::vector<Variant> variants_to_verify(const VerifyArguments& arguments, Backend backend, const Scene& scene) {
    AxisChoices axes = all_choices(backend);
    TunableValues tunables;
    for (const std::string& argument : arguments.axes) {
        add_axis_argument(axes, argument, backend);
    }
    for (const std::string& argument : arguments.tunables) {
        add_tunable_argument(tunables, argument);
    }
    if (backend == Backend::cpu) {
        return expand(axes, backend, tunables);
    }
    if (!arguments.axes.empty() || !tunables.empty()) {
        AxisChoices named;
        for (const std::string& argument : arguments.axes) {
            add_axis_argument(named, argument, backend);
        }
        return expand(named, backend, tunables);
    }
    return covering_variants(axes, features_of(scene), backend);
}

int run(const VerifyArguments& arguments) {
    const Backend backend = parse_backend(arguments.backend);
    require_backend(backend);
    const std::vector<std::string> names = arguments.scenes == "all" ? scene_names() : split_names(arguments.scenes);
    std::vector<Scene> scenes;
    for (const std::string& name : names) {
        scenes.push_back(find_scene(name));
    }
    std::vector<CompileTask> compilations;
    std::vector<std::vector<Variant>> variants;
    for (const Scene& scene : scenes) {
        variants.push_back(variants_to_verify(arguments, backend, scene));
        for (const Variant& variant : variants.back()) {
            compilations.push_back({&scene, variant});
        }
    }
    if (backend == Backend::cuda) {
        compile_ahead(compilations);
    }
    Tally tally;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        verify_scene(scenes[i], backend, variants[i], arguments, tally);
    }
    fmt::print("{} held, {} failed, {} not applicable on {}; {} at {} spp, scenes: {}\n", tally.held, tally.failed,
               tally.not_applicable, to_string(backend), arguments.resolution, arguments.spp, fmt::join(names, ", "));
    return tally.failed == 0 && tally.held > 0 ? exit_good : exit_check_failed;
}

}  // namespace

Command add_verify_command(CLI::App& app) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command =
        app.add_subcommand("verify", "Hold every applicable variant to its claim; exit code 1 if one fails");
    command->add_option("--scene", arguments->scenes, "Scenes by name or .json file, comma-separated, or \"all\"")
        ->required();
    command
        ->add_option(
            "--axis", arguments->axes,
            "AXIS=CHOICE,CHOICE, repeatable (default: every choice; on cuda a set in which every two choices meet)")
        ->allow_extra_args(false);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE,VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolution, "WxH (default 64x64)");
    command->add_option("--spp", arguments->spp, "Samples per pixel (default 4)")->check(CLI::Range(1u, 1000000u));
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--seed", arguments->seed, "Seed (default 1)")->check(check_seed);
    command->add_flag("--quiet", arguments->quiet, "Print failures and the tally only");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
