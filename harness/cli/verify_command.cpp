#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/compile_ahead.h"
#include "harness/bench/progress.h"
#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/bench/verify_statistical.h"
#include "harness/cli/commands.h"
#include "harness/counted.h"
#include "harness/scene/places.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

struct VerifyArguments {
    std::string scenes;
    std::vector<std::string> axes;
    std::string devices;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolution;  // empty and 0: the test's own
    std::uint32_t spp = 0;
    std::uint32_t depth = 0;
    std::uint64_t seed = 1;
    bool quick = false;
    CompileOnly compile_only;
    bool quiet = false;
    bool statistical = false;
    std::vector<std::string> against;
    std::uint32_t runs = 16;

    std::string size() const { return !resolution.empty() ? resolution : statistical ? "32x32" : "64x64"; }
    bool names_no_size() const { return resolution.empty() && spp == 0; }
    std::uint32_t samples() const { return spp != 0 ? spp : statistical ? 64 : 4; }
};

struct Tally {
    std::size_t held = 0, failed = 0, not_applicable = 0;
};

// Collects what does not apply in a scene: most of a product of axes, for few reasons, of which each is a line.
class NotApplicableLines {
public:
    void add(const std::string& variant, const std::string& reason) {
        const auto known =
            std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.reason == reason; });
        if (known == groups_.end()) {
            groups_.push_back({reason, variant, 1});
        } else {
            known->variants += 1;
        }
    }
    void print(const std::string& scene) const {
        for (const Group& group : groups_) {
            fmt::print(
                "n/a              {} on {}: {}\n",
                group.variants == 1 ? group.first : fmt::format("{} and {} more", group.first, group.variants - 1),
                scene, group.reason);
        }
    }

private:
    struct Group {
        std::string reason, first;
        std::size_t variants;
    };
    std::vector<Group> groups_;  // in the order of their first variants
};

// Seconds until `--quiet` says that it goes on.
constexpr double patience = 5;

Progress progress_of(std::size_t steps, const VerifyArguments& arguments) {
    return {"verify", steps, arguments.quiet ? Progress::Lines::shown : Progress::Lines::hidden, patience};
}

// A variant that throws fails; the others go on.
Verdict check_or_fail(const std::function<Verdict(const Variant&)>& check, const Variant& variant) {
    try {
        return check(variant);
    } catch (const std::exception& exception) {
        return {false, "no film", exception.what()};
    }
}

RenderSettings settings_of(const Scene& scene, const VerifyArguments& arguments) {
    RenderSettings settings = default_settings(scene);
    std::tie(settings.width, settings.height) = parse_resolution(arguments.size());
    settings.depth = arguments.depth != 0 ? arguments.depth : scene.max_depth;
    settings.seed = arguments.seed;
    return settings;
}

// A queue of more than ten thousand paths, compacted more than sixty times: what goes wrong in large queues alone, or
// after many calls, is nowhere to be seen at 64x64 and 4 spp. Once for each choice, as it takes several times as long.
class LargeCheck {
public:
    LargeCheck(const Scene& scene, Backend backend, const std::vector<Variant>& variants,
               const VerifyArguments& arguments)
        : spp_(samples_for(settings_of(scene, arguments).depth)),
          verifier_(scene, large(scene, arguments), spp_, backend) {
        if (arguments.names_no_size()) {
            checked_ = plainest_of_each_choice(scene, variants, backend);
        }
    }

    static std::string size() { return fmt::format("{}x{}", width, height); }

    // The variant's own verdict, or that of its film at the larger size if it fails only there.
    Verdict after(const Verdict& verdict, const Variant& variant) {
        if (!verdict.holds || !checked_.contains(variant)) {
            return verdict;
        }
        Verdict at_large = verifier_.check_film(variant);
        at_large.message = fmt::format("at {}, {} spp: {}", size(), spp_, at_large.message);
        return at_large.holds ? verdict : at_large;
    }

private:
    static constexpr std::uint32_t width = 128, height = 96;

    static std::uint32_t samples_for(std::uint32_t depth) {
        constexpr std::uint32_t compactions = 70;  // one a segment but the last
        return std::max(4u, compactions / std::max(1u, depth - 1) + 1);
    }
    static RenderSettings large(const Scene& scene, const VerifyArguments& arguments) {
        RenderSettings settings = settings_of(scene, arguments);
        settings.width = width;
        settings.height = height;
        return settings;
    }
    // For each choice, the variant that has it and otherwise the fewest choices other than the baseline's.
    static std::set<Variant> plainest_of_each_choice(const Scene& scene, const std::vector<Variant>& variants,
                                                     Backend backend) {
        const Variant baseline = Registry::instance().baseline(backend);
        const auto distance = [&](const Variant& variant) {
            return std::count_if(axis_names.begin(), axis_names.end(),
                                 [&](std::string_view axis) { return variant[axis] != baseline[axis]; });
        };
        std::map<std::pair<std::string_view, std::string>, std::pair<std::ptrdiff_t, const Variant*>> plainest;
        const FeatureSet features = features_of(scene);
        for (const Variant& variant : variants) {
            if (!why_not_applicable(variant, features, backend).empty()) {
                continue;
            }
            const std::pair here(distance(variant), &variant);
            for (const std::string_view axis : axis_names) {
                const auto [known, is_new] = plainest.try_emplace({axis, variant[axis]}, here);
                if (here.first < known->second.first) {
                    known->second = here;
                }
            }
        }
        std::set<Variant> chosen;
        for (const auto& [choice, of_choice] : plainest) {
            chosen.insert(*of_choice.second);
        }
        return chosen;
    }

    std::uint32_t spp_;
    Verifier verifier_;
    std::set<Variant> checked_;
};

void verify_scene(const Scene& scene, Backend backend, const std::vector<Variant>& variants,
                  const VerifyArguments& arguments, Tally& tally) {
    const RenderSettings settings = settings_of(scene, arguments);
    Verifier verifier(scene, settings, arguments.samples(), backend);
    LargeCheck large_check(scene, backend, variants, arguments);
    const FeatureSet features = features_of(scene);
    NotApplicableLines not_applicable;
    Progress progress = progress_of(variants.size(), arguments);
    for (const Variant& variant : variants) {
        const std::string name = shown_name(variant, backend);
        progress.begin(name);
        if (const std::string reason = why_not_applicable(variant, features, backend); !reason.empty()) {
            tally.not_applicable += 1;
            not_applicable.add(name, reason);
            progress.step(name);
            continue;
        }
        const Verdict verdict =
            check_or_fail([&](const Variant& one) { return large_check.after(verifier.check(one), one); }, variant);
        (verdict.holds ? tally.held : tally.failed) += 1;
        if (!verdict.holds || !arguments.quiet) {
            fmt::print("{} {} on {}: {}, {}\n", verdict.film_hash, name, scene.name, verdict.holds ? "ok" : "FAILED",
                       verdict.message);
            std::fflush(stdout);
        }
        progress.step(name);
    }
    if (!arguments.quiet) {
        not_applicable.print(scene.name);
    }
}

// The variant whose image is compared, which all that differ in bitwise choices share.
Variant image_of(const Scene& scene, const Variant& variant, Backend backend) {
    return fp_relaxed(variant, backend) ? variant : fast_reference_on(scene, variant, backend);
}

// The variant with the choices of --against, and without tunables that are none of theirs.
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

// The claims to test of a scene's variants, each image once; what makes none is tallied.
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
            continue;  // of bitwise claims the film's bits say more, without --statistical
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

// The plainest variant of each image: one choice away from the reference.
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

// The accelerator of variants in which another axis is varied: every triangle in turn is the reference, and too slow
// for every other choice.
std::string plain_accelerator(const Scene& scene, Backend backend) {
    std::string name = Registry::instance().baseline(backend)[axes::accelerator];
    for (const Choice* choice : Registry::instance().choices(axes::accelerator, backend)) {
        if (!scene.meshes.empty() && traits_in<AcceleratorTraits>(choice->descriptor).has_tree) {
            name = choice->descriptor.name;
        }
    }
    return name;
}

// Every way to draw lights and directions to them with every estimator that connects, by kernels that know the scene
// and by the general one: what pairs of choices leave out. On a CPU with every integrator.
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

// A product of all choices is small on the CPU backend but for roulette, samplers, robustness, accelerators,
// builders, levels and ways to draw lights and walks, which multiply it by hundreds; on CUDA it is millions. So without
// --axis these meet the rest in a covering set, in which every two choices of two axes meet, on CUDA all axes do, and
// of means each choice is tested by itself. Ways to draw lights meet all estimators that connect besides.
std::vector<Variant> variants_to_verify(const VerifyArguments& arguments, Backend backend, const Scene& scene) {
    const bool none_named = arguments.axes.empty() && arguments.devices.empty() && arguments.tunables.empty();
    if (arguments.quick) {
        AxisChoices axes = all_choices(backend);
        for (const auto& [axis, choices] : parse_axis_arguments(arguments.axes, arguments.devices, backend)) {
            axes[axis] = choices;
        }
        return each_choice_once(covering_variants(axes, features_of(scene), backend));
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

int run(const VerifyArguments& arguments) {
    const Backend backend = arguments.compile_only.is_asked ? Backend::cuda : parse_backend(arguments.backend);
    if (!arguments.compile_only.is_asked) {
        require_backend(backend);
    }
    (void)parse_resolution(arguments.size());  // before variants are listed, which takes seconds
    const std::vector<std::string> names = scenes_asked_for(arguments.scenes);
    const std::vector<Scene> scenes = find_scenes(names);
    std::vector<CompileTask> compilations;
    std::vector<std::vector<Variant>> variants;
    for (const Scene& scene : scenes) {
        variants.push_back(variants_to_verify(arguments, backend, scene));
        for (const Variant& variant : variants.back()) {
            compilations.push_back({&scene, variant});
        }
    }
    if (arguments.compile_only.is_asked) {
        compile_for(arguments.compile_only.architecture, std::move(compilations));
        return exit_good;
    }
    if (arguments.statistical) {
        return run_statistical(arguments, backend, scenes, variants);
    }
    if (backend == Backend::cuda) {
        compile_ahead(compilations);
    }
    Tally tally;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        verify_scene(scenes[i], backend, variants[i], arguments, tally);
    }
    fmt::print("{} held, {} failed, {} not applicable on {}; {} at {} spp{}, scenes: {}\n", tally.held, tally.failed,
               tally.not_applicable, to_string(backend), arguments.size(), arguments.samples(),
               arguments.names_no_size() ? ", each choice once at " + LargeCheck::size() : "", fmt::join(names, ", "));
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
    command->add_flag("--quick", arguments->quick,
                      "Every choice of every axis once, in few variants, instead of every pair of choices");
    add_compile_options(*command, arguments->compile_only);
    command->add_flag("--quiet", arguments->quiet,
                      "Print failures and the tally only; from 5 s on progress, on stderr");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
