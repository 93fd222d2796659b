#include "harness/bench/passport.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <limits>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "harness/bench/fastest.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/runner.h"
#include "harness/error/reference.h"
#include "harness/files_read.h"
#include "harness/machine/machine.h"
#include "harness/machine/run_context.h"
#include "harness/say.h"

namespace pt {

namespace {

constexpr const char* schema = "ptbench-passport-1";
constexpr std::uint32_t most_spp = 4096;
constexpr double least_ms_to_measure = 5;  // a shorter render says too little about longer ones
constexpr int renders_to_measure = 3;      // the fastest of them counts, since other processes disturb some
// The seeds of the two runs are far apart, so that no sample of one run is a sample of the other.
constexpr std::uint64_t first_seeds[] = {1, 100001};
constexpr const char* run_names[] = {"first", "second"};

double render_ms(const Scene& scene, RenderRequest& request, std::uint32_t samples) {
    request.samples = samples;
    double fastest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < renders_to_measure; ++i) {
        fastest = std::min(fastest, render_named(scene, request).wall_ms);
    }
    return fastest;
}

// The number of samples per pixel, a power of two, with which a render takes about `wanted_ms`.
std::uint32_t samples_for(const Scene& scene, RenderRequest request, double wanted_ms) {
    std::uint32_t samples = 1;
    double ms = render_ms(scene, request, samples);
    while (ms < least_ms_to_measure && samples < most_spp) {
        samples *= 4;
        ms = render_ms(scene, request, samples);
    }
    const double wanted = wanted_ms * samples / ms;
    return std::bit_floor(static_cast<std::uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(most_spp))));
}

// The folder of an unfinished passport. It holds both runs with their journals, and in about.json what they have in
// common; without that file no passport was begun.
struct Parts {
    std::filesystem::path folder;

    explicit Parts(const std::string& out) : folder(out + ".parts") {}
    std::string about() const { return folder / "about.json"; }
    std::string run(std::size_t number) const { return folder / fmt::format("{}.json", run_names[number]); }
    // A run whose journal is left was interrupted, or its result is not to be trusted.
    bool has_run(std::size_t number) const {
        return std::filesystem::exists(run(number)) && !std::filesystem::exists(journal_of(run(number)));
    }
};

// What must be the same when a passport is continued.
Json identity_of(const PassportOptions& options) {
    return {{"program", program_hash()},
            {"machine", options.machine},
            {"host", BenchmarkContext::now().host_name},
            {"backend", std::string(to_string(options.backend))}};
}

Json about_passport(const Suite& suite, const PassportOptions& options) {
    Json spp = Json::object();
    for (const Study& study : suite.studies) {
        if (!study.convergence) {
            spp[study.name] = study.spp;
        }
    }
    return {{"begun_by", identity_of(options)}, {"chip", options.chip()}, {"spp", spp}};
}

void check_identity(const Json& about, const PassportOptions& options, const std::string& file) {
    const Json begun_by = about.value("begun_by", Json::object()), here = identity_of(options);
    for (const auto& [key, value] : here.items()) {
        if (begun_by.value(key, Json()) != value) {
            throw InputError(file, "$.begun_by." + key, describe(begun_by.value(key, Json())),
                             describe(value) + ", as here; remove the folder to start over");
        }
    }
}

// Gives the studies the numbers of samples per pixel that an unfinished passport uses.
void take_samples_of(Suite& suite, const Json& about, const std::string& file) {
    for (Study& study : suite.studies) {
        if (!study.convergence) {
            const Json asked = about.value("spp", Json::object()).value(study.name, Json());
            const JsonValue spp(asked, file, "$.spp." + study.name);
            study.spp = static_cast<std::uint32_t>(spp.whole(1, most_spp, fmt::format("1 to {}", most_spp)));
            study.spp_on.clear();
        }
    }
}

// Only a passport may take a passport's place, and only if that is allowed.
void check_place(const PassportOptions& options) {
    check_output_file(options.out);
    refuse_source(options.out);
    if (!std::filesystem::exists(options.out)) {
        return;
    }
    const Json there = parse_loosely(options.out);
    const bool is_passport = there.is_object() && there.value("schema", Json()) == schema;
    if (!is_passport || !options.overwrite) {
        throw InputError(options.out, "output file", is_passport ? "a passport" : describe_result(there),
                         is_passport ? "--overwrite, or another name" : "another name");
    }
}

// Begins a passport, or continues one. Returns the suite to run, and what about.json holds.
std::pair<Suite, Json> begin(const Suite& suite, const PassportOptions& options, const Parts& parts) {
    const bool is_begun = std::filesystem::exists(parts.about());
    if (options.resume && !is_begun) {
        throw InputError("--resume", "passport", "no unfinished one at " + parts.folder.string(), "a call without it");
    }
    if (!options.resume && is_begun) {
        throw InputError(parts.folder, "passport", "an unfinished one",
                         "--resume to go on with it; remove the folder to start over");
    }
    if (is_begun) {
        Suite same = suite;
        Json about = parse_json(read_file(parts.about()), parts.about());
        check_identity(about, options, parts.about());
        take_samples_of(same, about, parts.about());
        return {std::move(same), std::move(about)};
    }
    Suite scaled = scaled_to_machine(suite, options.backend, sample_ms_on(options.backend));
    Json about = about_passport(scaled, options);
    write_file(parts.about(), about.dump(1) + "\n");
    return {std::move(scaled), std::move(about)};
}

int run_once(const Suite& suite, const PassportOptions& options, const Parts& parts, std::size_t number) {
    const std::string file = parts.run(number);
    say("{} of two runs\n", run_names[number]);
    return run_suite(suite, {.backend = options.backend,
                             .out = file,
                             .command_line = options.command_line,
                             .resume = std::filesystem::exists(journal_of(file)),
                             .overwrite = true,
                             .quiet = options.quiet,
                             .reference_cache = default_reference_folder(),
                             .untuned = true,
                             .seed = first_seeds[number]});
}

bool has_failed_cell(const nlohmann::ordered_json& run) {
    const auto& cells = run.at("ptbench").at("cells");
    return std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.at("status") == "failed"; });
}

// The resolution and the first scene of a study decide how many samples per pixel it gets.
using Place = std::tuple<std::string, std::uint32_t, std::uint32_t>;

std::uint32_t samples_at(const Cell& cell, Backend backend, double sample_ms, std::map<Place, std::uint32_t>& known) {
    const Place place{cell.scene->name, cell.settings.width, cell.settings.height};
    const auto [found, is_new] = known.try_emplace(place, 0);
    if (is_new) {
        const AxisChoices with_accelerator = with_tree({}, {}, *cell.scene, backend);
        const RenderRequest request{.variant = fastest_variant(with_accelerator, {}, features_of(*cell.scene), backend),
                                    .backend = backend,
                                    .settings = cell.settings};
        found->second = samples_for(*cell.scene, request, sample_ms);
    }
    return found->second;
}

}  // namespace

std::uint32_t least_samples(const Plan& plan) {
    std::uint32_t most = 1;
    for (const Cell& cell : plan.cells) {
        const auto in_flight = cell.variant.tuning.find("spp_in_flight");
        most = in_flight == cell.variant.tuning.end() ? most : std::max(most, in_flight->second);
    }
    return most;
}

Suite scaled_to_machine(const Suite& suite, Backend backend, double sample_ms) {
    Suite scaled = suite;
    std::map<Place, std::uint32_t> known;
    for (Study& study : scaled.studies) {
        Study first = study;
        first.scenes.resize(1);
        const Plan plan = make_plan({.name = suite.name, .description = "", .studies = {first}}, backend);
        if (!study.convergence && !plan.cells.empty()) {
            study.spp = std::max(samples_at(plan.cells.front(), backend, sample_ms, known), least_samples(plan));
            study.spp_on.clear();
        }
    }
    return scaled;
}

int make_passport(const Suite& suite, const PassportOptions& options) {
    check_place(options);
    const Parts parts(options.out);
    const auto [scaled, about] = begin(suite, options, parts);
    bool has_failed = false;
    nlohmann::ordered_json passport{{"schema", schema}, {"chip", about.at("chip")}, {"spp", about.at("spp")}};
    for (std::size_t number = 0; number < std::size(run_names); ++number) {
        if (!parts.has_run(number)) {
            const int code = run_once(scaled, options, parts, number);
            if (code > exit_check_failed || !parts.has_run(number)) {
                return code;
            }
        }
        passport["runs"].push_back(nlohmann::ordered_json::parse(read_file(parts.run(number), largest_result)));
        has_failed = has_failed || has_failed_cell(passport["runs"].back());
    }
    write_file(options.out, passport.dump(1) + "\n");
    std::filesystem::remove_all(parts.folder);
    fmt::print("passport: {}\npage: python3 -m ptbench passport {}\n", options.out, options.out);
    return has_failed ? exit_check_failed : exit_good;
}

}  // namespace pt
