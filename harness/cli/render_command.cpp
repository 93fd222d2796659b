#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/bench/fastest.h"
#include "harness/bench/phase_watch.h"
#include "harness/bench/progress.h"
#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/cli/render_aovs.h"
#include "harness/crash.h"
#include "harness/files_read.h"
#include "harness/machine/machine.h"
#include "harness/ranks/ranks.h"
#include "harness/ranks/render_on_ranks.h"
#include "harness/render/checkpoints.h"
#include "harness/render/image.h"
#include "harness/say.h"
#include "harness/scene/places.h"
#include "harness/variant_json.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

struct RenderArguments {
    std::string scene;
    std::vector<std::string> axes;
    std::string devices;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolution;
    std::uint32_t spp = 16;
    std::uint32_t depth = 0;
    std::uint64_t seed = 1;
    std::uint32_t repetitions = 0;
    bool untuned = false;
    std::string aovs;
    std::string out;
};

constexpr double shortest_to_mention = 2;  // seconds; for shorter renders no time estimate is printed
// Number of samples over all pixels that a CPU renders within seconds. Above it, a render of too few samples per pixel
// for a trial is announced as long.
constexpr double most_samples_unmentioned = 1 << 23;

struct Trial {
    std::optional<double> seconds = {};  // estimated time of the whole render; none if unknown
    std::optional<CudaFacts> cuda = {};  // facts of the trial renders on CUDA; none if none was made
    bool is_long = false;                // whether the whole render is sure to take long
};

double pixels_of(const RenderSettings& settings) { return static_cast<double>(settings.width) * settings.height; }

// Times one sample per pixel of an image with about `pixels` pixels. On a GPU the time is used only if it exceeds a
// threshold, since small images take no less time than larger ones.
Trial try_with_pixels(const Scene& scene, RenderRequest request, double pixels) {
    constexpr double least_ms_on_gpu = 50;
    const double whole = pixels_of(request.settings) * request.samples;
    const double shrink = std::sqrt(pixels / pixels_of(request.settings));
    request.settings.width = std::max(1u, static_cast<std::uint32_t>(request.settings.width * shrink));
    request.settings.height = std::max(1u, static_cast<std::uint32_t>(request.settings.height * shrink));
    request.samples = 1;
    const double times = whole / pixels_of(request.settings) / ranks().count;
    const RenderResult cold = render(scene, request);
    double ms = cold.wall_ms;
    if (1e-3 * ms * times >= shortest_to_mention) {
        ms = std::min(ms, render(scene, request).wall_ms);
    }
    const bool is_known = request.backend == Backend::cpu || ms >= least_ms_on_gpu;
    return {is_known ? std::optional(1e-3 * ms * times) : std::nullopt, cold.cuda};
}

// Estimates a render's time from that of a small image or, if it may take long, from that of a larger image that takes
// little. Gives no estimate if the render is so small that it would end before the estimate.
Trial try_small(const Scene& scene, const RenderRequest& request) {
    constexpr double least_times = 16, most_seconds = 0.5;
    const double whole = pixels_of(request.settings) * request.samples;
    Trial trial;
    for (const double pixels : {256.0, 4096.0}) {
        const double known = trial.seconds.value_or(shortest_to_mention);
        if (pixels >= pixels_of(request.settings) || whole < least_times * pixels || known < shortest_to_mention ||
            known * pixels / whole > most_seconds) {
            break;
        }
        const Trial larger = try_with_pixels(scene, request, pixels);
        trial.seconds = larger.seconds;
        if (trial.cuda) {
            trial.cuda->add_compilation(*larger.cuda);
        } else {
            trial.cuda = larger.cuda;
        }
    }
    return trial;
}

// Times one sample per pixel after a warm-up; for long renders only a small image is timed.
Trial try_out(const Scene& scene, RenderRequest request) {
    constexpr std::uint32_t fewest_samples = 32;
    Trial trial = try_small(scene, request);
    const std::uint32_t samples = request.samples;
    trial.is_long = trial.seconds.value_or(0) >= shortest_to_mention * samples;
    if (trial.is_long || samples < fewest_samples) {
        return trial;
    }
    request.samples = 1;
    const auto seconds = [&](const RenderResult& result) { return 1e-3 * result.wall_ms * samples / ranks().count; };
    const RenderResult cold = render(scene, request);
    const bool is_short = seconds(cold) < shortest_to_mention;
    trial.seconds = seconds(is_short ? cold : render(scene, request));
    trial.is_long = *trial.seconds >= shortest_to_mention;
    if (trial.cuda) {
        trial.cuda->add_compilation(cold.cuda);
    } else {
        trial.cuda = cold.cuda;
    }
    return trial;
}

// The numbers of samples after which a long render reports progress: every two seconds or less often, at multiples of
// the samples that kernels have in flight; renders of few samples report after each.
std::vector<std::uint32_t> stops_of(const RenderRequest& request, std::optional<double> seconds) {
    constexpr std::uint32_t multiple = 16;
    std::uint32_t step = 1;
    if (seconds && request.samples >= 2 * multiple) {
        const double parts = std::clamp(*seconds / shortest_to_mention, 1.0, 1000.0);
        step = static_cast<std::uint32_t>(std::ceil(request.samples / parts / multiple)) * multiple;
    }
    std::vector<std::uint32_t> stops;
    for (std::uint64_t done = step; done < request.samples; done += step) {
        stops.push_back(static_cast<std::uint32_t>(done));
    }
    stops.push_back(request.samples);
    return stops;
}

// Prints the estimated time of a long render on standard error, if known, and then its progress. `variance`: the
// estimator to feed at the stops, or null.
RankedRender render_aloud(const Scene& scene, RenderRequest request, const Trial& trial, PixelVariance* variance,
                          PhaseWatch& watch) {
    const std::optional<double>& seconds = trial.seconds;
    const bool has_many = pixels_of(request.settings) * request.samples >= most_samples_unmentioned;
    const bool is_short = !trial.is_long && !has_many;
    const bool may_be_long = seconds.value_or(0) >= shortest_to_mention;
    watch.begin("rendering", seconds);
    if (is_short && !may_be_long && variance == nullptr) {
        return render_on_ranks(scene, request);
    }
    if (!is_short) {
        say("render: {}x{}, {} spp, {}{}\n", request.settings.width, request.settings.height, request.samples,
            shown_name(request.variant, request.backend), seconds ? ": about " + clock_text(*seconds) : "");
    }
    // A render on several MPI ranks has no progress stops, since all ranks would have to wait for each other.
    if (stops_change_film(request.variant, request.backend) || (ranks().count > 1 && variance == nullptr)) {
        return render_on_ranks(scene, request);
    }
    request.checkpoints = variance != nullptr ? variance_stops(request.samples) : stops_of(request, seconds);
    Progress progress("render", request.checkpoints.size(),
                      is_short ? Progress::Lines::hidden : Progress::Lines::shown);
    request.on_checkpoint = [&](const Checkpoint& checkpoint) {
        if (variance != nullptr) {
            variance->add(checkpoint.film);
        }
        if (is_short) {
            watch.reached(static_cast<double>(checkpoint.samples) / request.samples);
        } else {
            watch.end();  // the progress bar replaces the display of phases ("rendering")
            progress.step(fmt::format("{} of {} spp", checkpoint.samples, request.samples));
        }
    };
    return render_on_ranks(scene, request);
}

struct Chosen {
    Variant variant;
    std::string by;  // who chose the variant (user or ptbench), for a message
};

// The variant that --axis options name. Other axes get the fastest known choice that suits the scene (fastest.h).
Chosen choose_variant(const RenderArguments& arguments, const Scene& scene, Backend backend) {
    const AxisChoices asked = parse_axis_arguments(arguments.axes, arguments.devices, backend);
    const TunableValues tunables = parse_tunable_arguments(arguments.tunables);
    const AxisChoices axes = with_tree(asked, tunables, scene, backend);
    const std::vector<Variant> named = expand(axes, backend, tunables);
    if (named.size() != 1) {
        throw InputError("--axis", "argument", fmt::format("{} variants", named.size()),
                         "one choice an axis and one value a tunable for render");
    }
    const FeatureSet features = features_of(scene);
    const bool is_named = axes.contains(axes::integrator);
    const Variant variant = with_light_sampling(
        is_named ? named[0] : fastest_variant(axes, tunables, features, backend), axes, features, backend);
    const std::string reason = why_not_applicable(variant, features, backend);
    if (!reason.empty()) {
        throw InputError(fmt::format("n/a: {} on {}: {}", shown_name(variant, backend), scene.name, reason));
    }
    require_backend(backend);
    std::vector<std::string> added{tree_in_words(asked, tunables, scene, backend),
                                   light_sampling_in_words(variant, asked)};
    std::erase(added, "");
    const std::string by = fmt::format(
        "{}{}", is_named ? "the call" : "ptbench: the fastest integrator known that goes with the scene and the call",
        added.empty() ? "" : fmt::format(";{} {}", is_named ? " ptbench:" : "", fmt::join(added, ", ")));
    if (arguments.untuned) {
        return {variant, by};
    }
    std::set<std::string> kept;
    for (const auto& [tunable, values] : tunables) {
        kept.insert(tunable);
    }
    return {Tuning::load(tuning_file(backend), backend).applied(variant, kept), by};
}

// Repeats a render after the warm-up and returns its times, for programs that compare them with other renderers'.
nlohmann::ordered_json timed_again(const Scene& scene, const RenderRequest& request) {
    const ForeignLoad before = ForeignLoad::now();
    const auto [result, ranked] = render_on_ranks(scene, request);
    ForeignLoad foreign = ForeignLoad::now() - before;
    foreign.cpu_ms -= ranked.neighbours_cpu_ms;
    return {{"render_seconds", 1e-3 * result.wall_ms},
            {"device_seconds", 1e-3 * result.device_ms},
            {"foreign_cpu_seconds", 1e-3 * foreign.cpu_ms}};
}

// Tells people on a terminal where the render ran and where its file is; programs read the summary instead.
void say_where(const RenderArguments& arguments, const RenderRequest& request, const std::string& chosen_by) {
    if (::isatty(STDERR_FILENO) == 0) {
        return;
    }
    const std::string file = std::filesystem::absolute(arguments.out).lexically_normal().string();
    say("rendered with {} on {}, chosen by {}\nwritten: {}\nopen it: {} '{}'\n",
        shown_name(request.variant, request.backend), to_string(request.backend), chosen_by, file,
        file.ends_with(".png") ? "xdg-open" : "tev", file);
}

// Facts about the render for the header of the .exr file, so that the file explains itself.
std::vector<std::pair<std::string, std::string>> exr_texts(const nlohmann::ordered_json& summary) {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const char* const key : {"scene", "scene_hash", "variant", "backend", "depth", "spp", "seed", "film_hash"}) {
        const nlohmann::ordered_json& value = summary.at(key);
        texts.emplace_back(fmt::format("ptbench.{}", key), value.is_string() ? value.get<std::string>() : value.dump());
    }
    return texts;
}

nlohmann::ordered_json summary_of(const Scene& scene, const RenderRequest& request, const RenderArguments& arguments,
                                  const std::string& chosen_by, const RenderResult& result) {
    const Vec3d mean = result.film.mean();
    return {
        {"scene", scene.name},
        {"scene_hash", scene.hash},
        {"variant", shown_name(request.variant, request.backend)},
        {"variant_id", variant_id(request.variant, request.backend)},
        {"chosen_by", chosen_by},
        {"axes", axes_json(request.variant)},
        {"backend", to_string(request.backend)},
        {"resolution", {request.settings.width, request.settings.height}},
        {"depth", request.settings.depth},
        {"spp", arguments.spp},
        {"seed", arguments.seed},
        {"mean_rgb", {mean.x, mean.y, mean.z}},
        {"film_hash", result.film.hash()},
        {"nonfinite", result.film.faults().nonfinite},
        {"negative", result.film.faults().negative},
        {"saturated", result.film.faults().saturated},
        {"paths", result.work.paths},
        {"rays", result.work.rays},
        {"unfinished_walks", result.work.unfinished_walks},
        {"kernel", choose_kernel(scene, request.variant, request.backend).note()},
        {"render_seconds", 1e-3 * result.wall_ms},
        {"device_seconds", 1e-3 * result.device_ms},
        {"compile_seconds", result.cuda.compile_seconds},
        {"kernels_from_cache", result.cuda.from_cache},
    };
}

void add_ranks(nlohmann::ordered_json& summary, const RankFacts& ranked) {
    if (ranked.count > 1) {
        summary["ranks"] = ranked.count;
        summary["slowest_rank_seconds"] = 1e-3 * ranked.slowest_ms;
        summary["reduce_seconds"] = 1e-3 * ranked.reduce_ms;
    }
}

RenderRequest request_of(const RenderArguments& arguments, const Scene& scene, const Variant& variant,
                         Backend backend) {
    RenderRequest request{
        .variant = variant, .backend = backend, .settings = default_settings(scene), .samples = arguments.spp};
    request.settings.seed = arguments.seed;
    if (!arguments.resolution.empty()) {
        std::tie(request.settings.width, request.settings.height) = parse_resolution(arguments.resolution);
    }
    if (arguments.depth != 0) {
        request.settings.depth = arguments.depth;
    }
    return request;
}

int run(const RenderArguments& arguments) {
    check_image_name(arguments.out);
    check_output_file(arguments.out);
    RenderAovs aovs = RenderAovs::parse(arguments.aovs);
    const auto start = std::chrono::steady_clock::now();
    PhaseWatch watch("render");
    watch.begin("reading the scene");
    const Scene scene = find_scene(arguments.scene);
    refuse_source(arguments.out);
    const Backend backend = parse_backend(arguments.backend);
    const auto [variant, chosen_by] = choose_variant(arguments, scene, backend);
    const RenderRequest request = request_of(arguments, scene, variant, backend);
    aovs.check(arguments.out, request);
    const AtWork at_work(description_of(scene, request));
    watch.begin("getting ready");
    const Trial trial = try_out(scene, request);
    RankedRender rendered = render_aloud(scene, request, trial, aovs.variance(), watch);
    watch.begin("writing " + one_line(arguments.out));
    if (trial.cuda) {
        rendered.result.cuda.add_compilation(*trial.cuda);
    }
    const RenderResult& result = rendered.result;
    nlohmann::ordered_json summary = summary_of(scene, request, arguments, chosen_by, result);
    add_ranks(summary, rendered.ranks);
    if (arguments.out.ends_with(".exr")) {
        std::vector<ExrLayer> layers = aovs.layers(scene, request, result, summary);
        layers.push_back({"", "RGB", result.film.radiance()});
        write_file(arguments.out, encode_exr(layers, result.film.width(), result.film.height(), exr_texts(summary)));
    } else {
        write_image(result.film, arguments.out);
    }
    watch.end();
    nlohmann::ordered_json again = nlohmann::ordered_json::array();
    while (again.size() < arguments.repetitions) {
        again.push_back(timed_again(scene, request));
    }
    if (!again.empty()) {
        summary["repetitions"] = again;
    }
    summary["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    summary["out"] = arguments.out;
    fmt::print("{}\n", summary.dump(1));
    std::fflush(stdout);
    say_where(arguments, request, chosen_by);
    return exit_good;
}

}  // namespace

Command add_render_command(CLI::App& app) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command = app.add_subcommand("render", "Render one image; a JSON summary goes to stdout");
    command->add_option("--scene", arguments->scene, "Scene by name or .json file")->required();
    command
        ->add_option(
            "--axis", arguments->axes,
            "AXIS=CHOICE, repeatable (default: the fastest integrator known, and over many triangles a tree; lights "
            "that are connected are drawn by light_sampling=auto; all else at its baseline)")
        ->allow_extra_args(false);
    command
        ->add_option("--devices", arguments->devices, "GPUs of this host that render it together: a number (default 1)")
        ->check(check_not_empty);
    command->add_option("--tune", arguments->tunables, "TUNABLE=VALUE, repeatable")->allow_extra_args(false);
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--resolution", arguments->resolution, "WxH (default: the scene's)");
    command->add_option("--spp", arguments->spp, "Samples per pixel (default 16)")->check(CLI::Range(1u, 100000000u));
    command->add_option("--depth", arguments->depth, "Ray segments in a path (default: the scene's)")
        ->check(CLI::Range(1u, 1000000u));
    command->add_option("--seed", arguments->seed, "Seed (default 1)")->check(check_seed);
    command->add_option("--repetitions", arguments->repetitions, "Render so often again, warm, and tell each time")
        ->check(CLI::Range(0u, 10000u));
    command->add_flag("--untuned", arguments->untuned,
                      "Leave tunables at their standards, whatever `ptbench autotune` found on this machine");
    command
        ->add_option("--aovs", arguments->aovs,
                     "Also into an .exr: all, or some of " + aov_names_text() + ", separated by commas")
        ->check(check_not_empty);
    command->add_option("--out", arguments->out, "Image to write: .png (sRGB), .pfm or .exr (linear)")->required();
    return [arguments] { return run(*arguments); };
}

}  // namespace pt
