#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/compile_ahead.h"
#include "harness/bench/progress.h"
#include "harness/bench/suite.h"
#include "harness/bench/verify_statistical.h"
#include "harness/cli/commands.h"
#include "harness/cli/verify_films.h"
#include "harness/counted.h"
#include "harness/scene/places.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// The variant that stands for all variants with the same image, which differ from it only in bitwise choices.
Variant image_of(const Scene& scene, const Variant& variant, Backend backend) {
    return fp_relaxed(variant, backend) ? variant : fast_reference_on(scene, variant, backend);
}

// The variant with the choices of --against, without tunables that its choices lack.
Variant changed(const Scene& scene, Variant variant, const AxisChoices& against, Backend backend) {
    for (const auto& [axis, choices] : against) {
        variant.set(axis, choices.front());
    }
    return fast_reference_on(scene, without_foreign_tunables(variant, backend), backend);
}

AxisChoices parse_against(const std::vector<std::string>& arguments, Backend backend) {
    AxisChoices against;
    for (const std::string& argument : arguments) {
        AxisChoices one;
        add_axis_argument(one, argument, backend);
        for (const auto& [axis, choices] : one) {
            if (choices.size() != 1 || against.contains(axis)) {
                throw InputError("--against", "argument", "\"" + argument + "\"", "one choice an axis");
            }
            against[axis] = choices;
        }
    }
    return against;
}

// The claims on mean radiance to test, one for variants with the same image; `tally` counts variants without a claim.
std::vector<MeanClaim> claims_of(const Scene& scene, const std::vector<Variant>& variants, Backend backend,
                                 const VerifyArguments& arguments, Tally& tally) {
    const AxisChoices against = parse_against(arguments.against, backend);
    const std::uint32_t depth = settings_of(scene, arguments).depth;
    std::vector<MeanClaim> claims;
    NotApplicableLines not_applicable;
    std::set<Variant> images;
    for (const Variant& variant : variants) {
        const Variant image = image_of(scene, variant, backend);
        if (!images.insert(image).second || (against.empty() && claim_of(image, backend) == Claim::bitwise)) {
            continue;  // a claim of equal bits is tested more strictly, by comparing films
        }
        std::string reason = why_not_applicable(image, features_of(scene), backend);
        if (reason.empty() && against.empty() && claim_of(image, backend) == Claim::biased) {
            reason = "claims no mean (--against AXIS=CHOICE compares it with the variant that has this choice)";
        }
        if (reason.empty()) {
            const MeanClaim claim = against.empty()
                                        ? claim_of_mean(image, depth, backend)
                                        : claim_against(image, changed(scene, image, against, backend), depth, backend);
            reason = why_not_applicable(claim.baseline, features_of(scene), backend);
            if (reason.empty() && !(claim.tested == claim.baseline)) {
                claims.push_back(claim);
            }
        }
        if (!reason.empty()) {
            tally.not_applicable += 1;
            not_applicable.add(shown_name(image, backend), reason);
        }
    }
    if (!arguments.quiet) {
        not_applicable.print(scene.name);
    }
    return claims;
}

void verify_means(const Scene& scene, const std::vector<MeanClaim>& claims, Backend backend,
                  const VerifyArguments& arguments, Tally& tally) {
    StatisticalVerifier verifier(scene, settings_of(scene, arguments),
                                 {.runs = arguments.runs, .spp = arguments.samples()}, backend);
    Progress progress = progress_of(claims.size(), arguments);
    for (const MeanClaim& claim : claims) {
        const std::string name = shown_name(claim.tested, backend);
        progress.begin(name);
        MeanVerdict verdict;
        try {
            verdict = verifier.check(claim);
        } catch (const std::exception& exception) {
            verdict = {false, exception.what()};
        }
        (verdict.holds ? tally.held : tally.failed) += 1;
        if (!verdict.holds || !arguments.quiet) {
            fmt::print("{} {} on {} at depth {}: {}\n", verdict.holds ? "ok     " : "FAILED ", name, scene.name,
                       claim.depth, verdict.message);
            std::fflush(stdout);
        }
        progress.step(name);
    }
}

// Variants that differ from the reference in a single choice, one for each choice.
std::vector<Variant> single_steps(Backend backend) {
    const Registry& registry = Registry::instance();
    const Variant plainest = registry.reference(registry.baseline(backend), backend);
    std::vector<Variant> variants{plainest};
    for (const auto& [axis, choices] : all_choices(backend)) {
        for (const std::string& choice : choices) {
            Variant variant = plainest;
            variant.set(axis, choice);
            if (!(variant == plainest)) {
                variants.push_back(without_foreign_tunables(variant, backend));
            }
        }
    }
    return variants;
}

// The accelerator used while other axes vary: for a scene with meshes one with a tree, since brute force takes long.
std::string plain_accelerator(const Scene& scene, Backend backend) {
    std::string name = Registry::instance().baseline(backend)[axes::accelerator];
    for (const Choice* choice : Registry::instance().choices(axes::accelerator, backend)) {
        if (!scene.meshes.empty() && traits_in<AcceleratorTraits>(choice->descriptor).has_tree) {
            name = choice->descriptor.name;
        }
    }
    return name;
}

// Every choice of light sampling and of light selection, each with all estimators that make connections and with
// specialised and generic kernels; on a CPU also with every integrator. A covering set has only pairs of choices.
std::vector<Variant> lit_variants(Backend backend, const Scene& scene) {
    const Registry& registry = Registry::instance();
    AxisChoices axes{{axes::accelerator, {plain_accelerator(scene, backend)}}};
    const AxisChoices all = all_choices(backend);
    for (const Choice* choice : registry.choices(axes::direct_light, backend)) {
        if (traits_in<DirectLightTraits>(choice->descriptor).connects) {
            axes[axes::direct_light].emplace_back(choice->descriptor.name);
        }
    }
    for (const Choice* choice : registry.choices(axes::specialisation, backend)) {
        if (!traits_in<SpecialisationTraits>(choice->descriptor).by_matrix) {
            axes[axes::specialisation].emplace_back(choice->descriptor.name);
        }
    }
    if (backend == Backend::cpu) {
        axes[axes::integrator] = all.at(axes::integrator);
    }
    std::vector<Variant> variants;
    for (const char* axis : {axes::light_sampling, axes::light_selection}) {
        AxisChoices with_axis = axes;
        with_axis[axis] = all.at(axis);
        for (const Variant& variant : expand(with_axis, backend)) {
            variants.push_back(variant);
        }
    }
    return variants;
}

void add_unknown(std::vector<Variant>& variants, const std::vector<Variant>& more) {
    std::set<Variant> known(variants.begin(), variants.end());
    for (const Variant& variant : more) {
        if (known.insert(variant).second) {
            variants.push_back(variant);
        }
    }
}

// The variants of a scene that `ptbench verify` checks. Without --axis, a CPU checks the product of all choices, except
// on accelerators and axes marked `by_pairs` (roulette, samplers, robustness, builders, levels, light sampling, light
// selection, walks), which would multiply it by hundreds; those, and on CUDA all axes, whose product has millions, are
// checked by a covering set (every pair of choices of two axes) and lit_variants. Means are checked by single choices.
std::vector<Variant> variants_to_verify(const VerifyArguments& arguments, Backend backend, const Scene& scene) {
    const bool none_named = arguments.axes.empty() && arguments.devices.empty() && arguments.tunables.empty();
    if (arguments.quick) {
        AxisChoices axes = all_choices(backend);
        for (const auto& [axis, choices] : parse_axis_arguments(arguments.axes, arguments.devices, backend)) {
            axes[axis] = choices;
        }
        return covering_variants(axes, features_of(scene), backend);
    }
    if (arguments.statistical && none_named) {
        return single_steps(backend);
    }
    AxisChoices axes;
    if (backend == Backend::cpu) {
        axes = all_choices(backend);
        for (const Axis& axis : axis_table) {
            if (axis.by_pairs) {
                axes.erase(std::string(axis.key));
            }
        }
        axes[axes::accelerator] = {plain_accelerator(scene, backend)};
    }
    for (const auto& [axis, choices] : parse_axis_arguments(arguments.axes, arguments.devices, backend)) {
        axes[axis] = choices;
    }
    const TunableValues tunables = parse_tunable_arguments(arguments.tunables);
    std::vector<Variant> variants;
    if (!none_named || backend == Backend::cpu) {
        variants = expand(axes, backend, tunables);
    }
    if (none_named) {
        add_unknown(variants, covering_variants(all_choices(backend), features_of(scene), backend));
        add_unknown(variants, lit_variants(backend, scene));
    }
    return variants;
}

int run_statistical(const VerifyArguments& arguments, Backend backend, const std::vector<Scene>& scenes,
                    const std::vector<std::vector<Variant>>& variants) {
    if (arguments.samples() < 2) {
        throw InputError("--spp", "argument", "1", "with --statistical at least 2: a run is compared with its parts");
    }
    Tally tally;
    std::vector<std::vector<MeanClaim>> claims;
    std::vector<CompileTask> compilations;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        claims.push_back(claims_of(scenes[i], variants[i], backend, arguments, tally));
        for (const MeanClaim& claim : claims.back()) {
            compilations.push_back({&scenes[i], claim.tested});
            compilations.push_back({&scenes[i], claim.baseline});
        }
    }
    if (backend == Backend::cuda) {
        compile_ahead(compilations);
    }
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        verify_means(scenes[i], claims[i], backend, arguments, tally);
    }
    fmt::print("{} held, {} failed, {} not applicable on {}; {} runs of {} spp a side, {}\n",
               counted(tally.held, "mean"), tally.failed, tally.not_applicable, to_string(backend), arguments.runs,
               arguments.samples(), arguments.size());
    return tally.failed == 0 && tally.held > 0 ? exit_good : exit_check_failed;
}

// The scenes and variants that a call of `ptbench verify` names. Throws InputError for unknown names.
FilmsToVerify films_of(const VerifyArguments& arguments, Backend backend) {
    (void)parse_resolution(arguments.size());  // reports a bad --size before listing variants, which takes seconds
    FilmsToVerify films{backend, find_scenes(scenes_asked_for(arguments.scenes)), {}};
    for (const Scene& scene : films.scenes) {
        films.variants.push_back(variants_to_verify(arguments, backend, scene));
    }
    if (arguments.quick) {
        films.variants = each_choice_once(std::move(films.variants));
    }
    return films;
}

std::vector<CompileTask> compilations_of(const FilmsToVerify& films) {
    std::vector<CompileTask> compilations;
    for (std::size_t i = 0; i < films.scenes.size(); ++i) {
        for (const Variant& variant : films.variants[i]) {
            compilations.push_back({&films.scenes[i], variant});
        }
    }
    return compilations;
}

int run(const VerifyArguments& arguments) {
    if (arguments.compile_only.is_asked) {
        compile_for(arguments.compile_only.architecture, compilations_of(films_of(arguments, Backend::cuda)));
        return exit_good;
    }
    // Workers are forked before the backend is initialised, since a process that has started CUDA cannot be forked.
    const std::size_t processes = arguments.statistical ? 1 : processes_for_films(arguments);
    Workers workers = film_checkers(processes > 1 ? processes : 0, arguments,
                                    [&arguments] { return films_of(arguments, parse_backend(arguments.backend)); });
    const Backend backend = parse_backend(arguments.backend);
    require_backend(backend);
    const FilmsToVerify films = films_of(arguments, backend);
    if (arguments.statistical) {
        return run_statistical(arguments, backend, films.scenes, films.variants);
    }
    if (backend == Backend::cuda) {
        compile_ahead(compilations_of(films));
    }
    const Tally tally = verify_films(films, arguments, uses_processes(arguments, backend) ? &workers : nullptr);
    fmt::print("{} held, {} failed, {} not applicable on {}; {} at {} spp{}, scenes: {}\n", tally.held, tally.failed,
               tally.not_applicable, to_string(backend), arguments.size(), arguments.samples(),
               arguments.names_no_size() ? ", each choice once at " + size_of_large_films() : "",
               fmt::join(scenes_asked_for(arguments.scenes), ", "));
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
        ->add_option("--axis", arguments->axes,
                     "AXIS=CHOICE,CHOICE, repeatable (default: every choice, but roulette, samplers, robustness, "
                     "accelerators, builders and levels by "
                     "pairs with the rest; on cuda a set in which every two choices meet; on both every way to draw "
                     "lights with every estimator that connects)")
        ->allow_extra_args(false);
    command
        ->add_option("--devices", arguments->devices,
                     "Numbers of GPUs of this host: N,N, as --axis devices=N,N (default 1)")
        ->check(check_not_empty);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE,VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolution,
                        "WxH (default 64x64, and each choice once at 128x96; with --statistical 32x32)");
    command->add_option("--spp", arguments->spp, "Samples per pixel (default 4; with --statistical 64 a run)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--seed", arguments->seed, "Seed (default 1)")->check(check_seed);
    CLI::Option* const statistical = command->add_flag(
        "--statistical", arguments->statistical,
        "Instead: hold the variants that claim another one's mean to it, by independent runs of both");
    command
        ->add_option("--against", arguments->against,
                     "AXIS=CHOICE, repeatable: hold every variant, whatever it claims, to the mean of that with this "
                     "choice")
        ->allow_extra_args(false)
        ->needs(statistical);
    command->add_option("--runs", arguments->runs, "Runs of each side, with seeds of their own (default 16)")
        ->check(CLI::Range(3u, 10000u))
        ->needs(statistical);
    command->add_flag(
        "--quick", arguments->quick,
        "Every choice of every axis once, in few variants that the scenes share, instead of every pair of "
        "choices");
    command
        ->add_option("--jobs", arguments->jobs,
                     "Processes that check films at once (default: on cuda one for each processor, at most 4; one on "
                     "cpu). What is printed does not depend on it")
        ->check(CLI::Range(1u, 256u))
        ->excludes(statistical);
    add_compile_options(*command, arguments->compile_only);
    command->add_flag("--quiet", arguments->quiet,
                      "Print failures and the tally only; from 5 s on progress, on stderr");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
