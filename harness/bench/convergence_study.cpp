#include "harness/bench/convergence_study.h"

#include <algorithm>

#include <fmt/format.h>

namespace pt {

namespace {

constexpr long long largest_spp = 1LL << 31;

// Samples per pixel of the preparatory renders (verification, instrumented pass) of a cell with checkpoints. So few
// suffice to test caches, kernels and the film's bits; the full number would take as long as a timed sample.
constexpr std::uint32_t prepared_samples = 64;

std::uint64_t read_most(const JsonValue& value) {
    return static_cast<std::uint64_t>(value.whole(1, largest_spp, "a whole number from 1 to 2147483648"));
}

// Reads `variance`, a study's limit for its reference image: a number, or one for each backend (a GPU renders more).
void read_variance(const JsonValue& value, ConvergenceSettings& settings) {
    const auto variance = [](const JsonValue& v) { return v.number(1e-300, 1e300, "a number above 0"); };
    if (!value.json().is_object()) {
        settings.variance = variance(value);
        return;
    }
    const JsonObject by_backend(value, {"cpu", "cuda"});
    for (const Backend backend : all_backends) {
        settings.variance_on[backend] = variance(by_backend.required(std::string(to_string(backend))));
    }
}

void read_reference(const JsonValue& value, ConvergenceSettings& settings) {
    const JsonObject object(value, {"scene", "axes", "variance", "most_spp"});
    if (object.has("scene")) {
        settings.reference_scene = object.at("scene").text();
    }
    if (object.has("axes")) {
        const JsonValue axes = object.at("axes");
        if (!axes.json().is_object()) {
            axes.fail("an object of choices, by axis");
        }
        for (const auto& [axis, choice] : axes.json().items()) {
            settings.reference_axes[axis] = JsonValue(choice, axes.file(), axes.path() + "." + axis).text();
            check_choices({{axis, {settings.reference_axes[axis]}}}, axes.file(), axes.path());
        }
    }
    if (object.has("variance")) {
        read_variance(object.at("variance"), settings);
    }
    if (!object.has("most_spp")) {
        return;
    }
    const JsonValue most = object.at("most_spp");
    if (!most.json().is_object()) {
        settings.most_spp = read_most(most);
        return;
    }
    const JsonObject by_backend(most, {"cpu", "cuda"});
    for (const Backend backend : all_backends) {
        settings.most_spp_on[backend] = read_most(by_backend.required(std::string(to_string(backend))));
    }
}

}  // namespace

ConvergenceSettings read_convergence(const JsonObject& study) {
    ConvergenceSettings settings;
    if (study.has("reference")) {
        read_reference(study.at("reference"), settings);
    }
    settings.images = study.has("images") && study.at("images").boolean();
    settings.without_checkpoints = !study.has("without_checkpoints") || study.at("without_checkpoints").boolean();
    return settings;
}

std::vector<std::uint32_t> octaves(std::uint32_t spp) {
    std::vector<std::uint32_t> samples;
    for (std::uint64_t n = 1; n < spp; n *= 2) {
        samples.push_back(static_cast<std::uint32_t>(n));
    }
    samples.push_back(spp);
    return samples;
}

void add_checkpoints(Cell& cell, const ConvergenceSettings& settings, std::shared_ptr<const Scene> reference_scene,
                     std::uint32_t reference_depth) {
    const auto own_most = settings.most_spp_on.find(cell.backend);
    const auto own_variance = settings.variance_on.find(cell.backend);
    CellConvergence convergence;
    convergence.checkpoints = octaves(cell.spp);
    convergence.images = settings.images;
    convergence.reference = {
        .scene = std::move(reference_scene),
        .width = cell.settings.width,
        .height = cell.settings.height,
        .depth = reference_depth,
        .backend = cell.backend,
        .axes = settings.reference_axes,
        .variance = own_variance != settings.variance_on.end() ? own_variance->second : settings.variance,
        .most_spp = own_most != settings.most_spp_on.end() ? own_most->second : settings.most_spp};
    cell.convergence = std::move(convergence);
    cell.prepared_spp = std::min(cell.spp, prepared_samples);
    cell.name += checkpoints_suffix;
}

std::vector<std::string> declared_biases(const Cell& cell) {
    std::vector<std::string> biases;
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = Registry::instance().at(axis, cell.variant, cell.backend).descriptor;
        if (descriptor.claim == Claim::biased) {
            biases.push_back(fmt::format("{}={}: {}", axis, descriptor.name, descriptor.claim_note));
        }
    }
    const Scene& reference = *cell.convergence->reference.scene;
    if (reference.hash != cell.scene->hash) {
        biases.push_back(fmt::format("the scene is {}, the reference's is {}", cell.scene->name, reference.name));
    }
    return biases;
}

}  // namespace pt
