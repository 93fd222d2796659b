// `ptbench autotune`: searches the tunables of one variant on this machine, one tunable at a time, and stores the
// fastest values.
#include <algorithm>

#include <fmt/format.h>

#include "harness/bench/fastest.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/suite.h"
#include "harness/bench/tuning.h"
#include "harness/bench/verify.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/machine/cpu_quota.h"
#include "harness/machine/machine.h"
#include "harness/scene/places.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

struct AutotuneArguments {
    std::string scene;
    std::vector<std::string> axes;
    std::string backend;
    std::string resolution;
    std::uint32_t spp = 16;
    std::uint32_t depth = 0;
    std::uint32_t passes = 2;
    std::string out;
};

constexpr int samples_per_value = 5;
constexpr int samples_at_the_end = 9;
constexpr double least_gain = 0.01;  // relative gain in time below which a tunable keeps its default, as noise

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

class Search {
public:
    Search(const Scene& scene, Backend backend, const RenderSettings& settings, std::uint32_t spp)
        : scene_(scene), backend_(backend), settings_(settings), spp_(spp) {}

    double milliseconds(const Variant& variant, std::uint64_t seed) const {
        RenderRequest request{.variant = variant, .backend = backend_, .settings = settings_, .samples = spp_};
        request.settings.seed = seed;
        return render_named(scene_, request).device_ms;
    }

    double typical(const Variant& variant) const {
        (void)milliseconds(variant, 1);  // an untimed first render compiles the kernels and warms up
        std::vector<double> all;
        for (std::uint64_t seed = 1; seed <= samples_per_value; ++seed) {
            all.push_back(milliseconds(variant, seed));
        }
        return median(all);
    }

    // Returns the variant with the value of `tunable` that renders fastest, and updates `best_ms`, its time.
    Variant improved(const Variant& variant, const Tunable& tunable, double& best_ms) const {
        Variant best = variant;
        for (const std::uint32_t value : candidates(tunable)) {
            Variant tried = variant;
            tried.tuning.erase(std::string(tunable.name));
            if (value != tunable.default_value) {
                tried.tuning[std::string(tunable.name)] = value;
            }
            if (tried.tuning == variant.tuning) {
                continue;
            }
            if (const std::string reason = why_not_applicable(tried, features_of(scene_), backend_); !reason.empty()) {
                fmt::print("  {}={}: n/a: {}\n", tunable.name, value, reason);
                continue;
            }
            try {
                const double ms = typical(tried);
                const bool wins = ms < (1 - least_gain) * best_ms;
                fmt::print("  {}={}: {:.4f} ms{}\n", tunable.name, value, ms, wins ? ", the best so far" : "");
                if (wins) {
                    best_ms = ms;
                    best = tried;
                }
            } catch (const std::exception& error) {
                fmt::print("  {}={}: not possible: {}\n", tunable.name, value, error.what());
            }
            std::fflush(stdout);
        }
        return best;
    }

    // Times two variants alternately, so that drift affects both equally.
    std::pair<double, double> compared(const Variant& a, const Variant& b) const {
        std::vector<double> of_a, of_b;
        for (std::uint64_t seed = 1; seed <= samples_at_the_end; ++seed) {
            of_a.push_back(milliseconds(a, seed));
            of_b.push_back(milliseconds(b, seed));
        }
        return {median(of_a), median(of_b)};
    }

private:
    const Scene& scene_;
    Backend backend_;
    RenderSettings settings_;
    std::uint32_t spp_;
};

int run(const AutotuneArguments& arguments) {
    const Scene scene = find_scene(arguments.scene);
    const Backend backend = parse_backend(arguments.backend);
    const AxisChoices axes = parse_axis_arguments(arguments.axes, backend);
    const std::vector<Variant> variants = expand(with_tree(axes, {}, scene, backend), backend);
    if (variants.size() != 1) {
        throw InputError("--axis", "argument", fmt::format("{} variants", variants.size()),
                         "one choice an axis for autotune");
    }
    const Variant standard = with_light_sampling(variants[0], axes, features_of(scene), backend);
    if (const std::string reason = why_not_applicable(standard, features_of(scene), backend); !reason.empty()) {
        throw InputError(fmt::format("n/a: {} on {}: {}", shown_name(standard, backend), scene.name, reason));
    }
    require_backend(backend);
    // The output file is checked before the search, which takes minutes.
    const std::string file = arguments.out.empty() ? tuning_file(backend) : arguments.out;
    check_output_file(file);
    refuse_result(file);
    Tuning tuning = Tuning::load(file, backend);
    RenderSettings settings = default_settings(scene);
    if (!arguments.resolution.empty()) {
        std::tie(settings.width, settings.height) = parse_resolution(arguments.resolution);
    }
    settings.depth = arguments.depth != 0 ? arguments.depth : settings.depth;
    say_cpu_warnings(backend);
    const Search search(scene, backend, settings, arguments.spp);

    double best_ms = search.typical(standard);
    fmt::print("{}: {:.4f} ms\n", shown_name(standard, backend), best_ms);
    Variant best = standard;
    for (std::uint32_t pass = 0; pass < arguments.passes; ++pass) {
        const Variant before = best;
        for (const Tunable& tunable : tunables_of(standard, backend)) {
            best = search.improved(best, tunable, best_ms);
        }
        if (best.tuning == before.tuning) {
            break;
        }
    }
    auto [standard_ms, tuned_ms] = search.compared(standard, best);
    if (!(tuned_ms < (1 - least_gain) * standard_ms)) {
        best = standard;
        tuned_ms = standard_ms;
    }
    // A variant whose image is wrong must not be stored as tuned, however fast it is.
    RenderSettings small = settings;
    small.width = small.height = 48;
    small.seed = 1;
    const Verdict verdict = Verifier(scene, small, 4, backend).check(best);
    fmt::print("{}: {:.4f} ms, {:.3f} of the standard's {:.4f}; {}\n", shown_name(best, backend), tuned_ms,
               tuned_ms / standard_ms, standard_ms, verdict.holds ? "verified" : "FAILED: " + verdict.message);
    if (!verdict.holds) {
        return exit_check_failed;
    }
    tuning.put({shown_name(standard, backend),
                variant_id(standard, backend),
                {best.tuning.begin(), best.tuning.end()},
                scene.name,
                settings.width,
                settings.height,
                settings.depth,
                arguments.spp,
                standard_ms,
                tuned_ms});
    tuning.save(file, backend == Backend::cuda ? cuda::machine_name() : machine_name());
    fmt::print("{}\n", file);
    return exit_good;
}

}  // namespace

Command add_autotune_command(CLI::App& app) {
    auto arguments = std::make_shared<AutotuneArguments>();
    CLI::App* command = app.add_subcommand(
        "autotune", "Search the tunables of one variant on this machine; `run` and `render` use what was found");
    command->add_option("--scene", arguments->scene, "Scene by name or .json file")->required();
    command->add_option("--axis", arguments->axes, "AXIS=CHOICE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolution, "WxH (default: the scene's)");
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--spp", arguments->spp, "Samples per pixel and sample (default 16)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--passes", arguments->passes, "Times round all tunables at most (default 2)")
        ->check(CLI::Range(1u, 100u));
    command->add_option("--out", arguments->out, "Tuning file (default results/MACHINE/tuning.json)");
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
