#include "harness/bench/passport.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/bench/fastest.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/runner.h"
#include "harness/error/reference.h"
#include "harness/say.h"

namespace pt {

namespace {

constexpr std::uint32_t most_spp = 4096;
constexpr double least_ms_to_measure = 5;  // shorter renders do not tell how long renders with more samples take
// The seeds of a passport's two runs lie apart, so that no sample of one run is a sample of the other.
constexpr std::uint64_t first_seeds[] = {1, 100001};
constexpr const char* run_names[] = {"first", "second"};

double render_ms(const Scene& scene, RenderRequest& request, std::uint32_t samples) {
    request.samples = samples;
    return render_named(scene, request).wall_ms;
}

// Samples per pixel at which a render takes about `wanted_ms`.
std::uint32_t samples_for(const Scene& scene, RenderRequest request, double wanted_ms) {
    (void)render_ms(scene, request, 1);  // an untimed render that compiles the kernels and warms up
    std::uint32_t samples = 1;
    double ms = render_ms(scene, request, samples);
    while (ms < least_ms_to_measure && samples < most_spp) {
        samples *= 4;
        ms = render_ms(scene, request, samples);
    }
    const double wanted = wanted_ms * samples / ms;
    return std::bit_floor(static_cast<std::uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(most_spp))));
}

// The folder of a passport that is being made: its chip and samples per pixel, and both runs with their journals.
struct Parts {
    std::filesystem::path folder;

    explicit Parts(const std::string& out) : folder(out + ".parts") {}
    std::string about() const { return folder / "about.json"; }
    std::string run(std::size_t number) const { return folder / fmt::format("{}.json", run_names[number]); }
};

Json about_passport(const Suite& suite, const PassportOptions& options) {
    Json spp = Json::object();
    for (const Study& study : suite.studies) {
        if (!study.convergence) {
            spp[study.name] = study.spp;
        }
    }
    return {{"chip", options.chip}, {"spp", spp}};
}

// Gives the studies the samples per pixel with which an unfinished passport began.
void take_samples_of(Suite& suite, const Json& about, const std::string& file) {
    for (Study& study : suite.studies) {
        if (!study.convergence) {
            const JsonValue spp(about.value("spp", Json::object()).value(study.name, Json()), file,
                                "$.spp." + study.name);
            study.spp = static_cast<std::uint32_t>(spp.whole(1, most_spp, fmt::format("1 to {}", most_spp)));
            study.spp_on.clear();
        }
    }
}

// Begins or continues a passport: returns the suite scaled to the machine, and the chip and spp for the passport.
std::pair<Suite, Json> begin(const Suite& suite, const PassportOptions& options, const Parts& parts) {
    const bool is_begun = std::filesystem::exists(parts.about());
    if (options.resume && !is_begun) {
        throw InputError("--resume", "passport", "no unfinished one at " + parts.folder.string(), "a call without it");
    }
    if (!options.resume && std::filesystem::exists(parts.folder)) {
        throw InputError(parts.folder, "passport", "an unfinished one",
                         "--resume to go on with it; remove the folder to start over");
    }
    if (is_begun) {
        Suite same = suite;
        Json about = parse_json(read_file(parts.about()), parts.about());
        take_samples_of(same, about, parts.about());
        return {std::move(same), std::move(about)};
    }
    Suite scaled = scaled_to_machine(suite, options.backend, options.sample_ms);
    Json about = about_passport(scaled, options);
    write_file(parts.about(), about.dump(1) + "\n");
    return {std::move(scaled), std::move(about)};
}

int run_once(const Suite& suite, const PassportOptions& options, const Parts& parts, std::size_t number) {
    const std::string file = parts.run(number);
    const bool is_complete = std::filesystem::exists(file) && is_complete_result(parse_loosely(file));
    if (is_complete) {
        return exit_good;
    }
    say("{} of two runs\n", run_names[number]);
    RunOptions how{.backend = options.backend,
                   .out = file,
                   .command_line = options.command_line,
                   .resume = std::filesystem::exists(file + ".journal.jsonl"),
                   .overwrite = true,
                   .quiet = options.quiet,
                   .reference_cache = default_reference_folder(),
                   .untuned = true,
                   .seed = first_seeds[number]};
    return run_suite(suite, how);
}

}  // namespace

Suite scaled_to_machine(const Suite& suite, Backend backend, double sample_ms) {
    Suite scaled = suite;
    for (Study& study : scaled.studies) {
        Study first = study;
        first.scenes.resize(1);
        const Plan plan = make_plan({.name = suite.name, .description = "", .studies = {first}}, backend);
        if (study.convergence || plan.cells.empty()) {
            continue;
        }
        const Cell& cell = plan.cells.front();
        const AxisChoices with_accelerator = with_tree({}, {}, *cell.scene, backend);
        const RenderRequest request{.variant = fastest_variant(with_accelerator, {}, features_of(*cell.scene), backend),
                                    .backend = backend,
                                    .settings = cell.settings};
        study.spp = samples_for(*cell.scene, request, sample_ms);
        study.spp_on.clear();
    }
    return scaled;
}

int make_passport(const Suite& suite, const PassportOptions& options) {
    check_output_file(options.out);
    check_overwrite(options.out, options.overwrite);
    const Parts parts(options.out);
    const auto [scaled, about] = begin(suite, options, parts);
    int worst = exit_good;
    nlohmann::ordered_json passport{
        {"schema", "ptbench-passport-1"}, {"chip", about.at("chip")}, {"spp", about.at("spp")}};
    for (std::size_t number = 0; number < std::size(run_names); ++number) {
        const int code = run_once(scaled, options, parts, number);
        if (code > exit_check_failed) {
            return code;
        }
        worst = std::max(worst, code);
        passport["runs"].push_back(nlohmann::ordered_json::parse(read_file(parts.run(number), largest_result)));
    }
    write_file(options.out, passport.dump(1) + "\n");
    std::filesystem::remove_all(parts.folder);
    fmt::print("passport: {}\npage: python3 -m ptbench passport {}\n", options.out, options.out);
    return worst;
}

}  // namespace pt
