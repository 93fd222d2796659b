#include "harness/bench/error_book.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "harness/bench/convergence_study.h"
#include "harness/render/image.h"

namespace pt {

namespace {

// The mean images of the first samples of a film (`half`) and of its remaining samples, by subtracting radiance sums.
Halves halves_of(const Film& half, const Film& whole) {
    Halves halves{image_of(half), {}};
    const double unit = 1 / (whole.scale() * static_cast<double>(whole.samples() - half.samples()));
    halves.second.reserve(whole.sums().size());
    for (std::size_t i = 0; i < whole.sums().size(); ++i) {
        halves.second.push_back(static_cast<double>(whole.sums()[i] - half.sums()[i]) * unit);
    }
    return halves;
}

std::string file_name(std::string name) {
    for (char& c : name) {
        const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                              std::string_view("._+=-").find(c) != std::string_view::npos;
        c = is_plain ? c : '_';
    }
    return name;
}

}  // namespace

ErrorBook::ErrorBook(const Plan& plan, ReferenceMaker maker) : maker_(std::move(maker)) {
    for (const Cell& cell : plan.cells) {
        if (!cell.convergence) {
            continue;
        }
        const ReferenceTask& task = cell.convergence->reference;
        ReferenceTask& kept = tasks_.try_emplace(task.name(), task).first->second;
        kept.variance = std::min(kept.variance, task.variance);
        kept.most_spp = std::max(kept.most_spp, task.most_spp);
    }
}

void ErrorBook::make_references() {
    for (const auto& [name, task] : tasks_) {
        try {
            references_.insert_or_assign(name, maker_.make(task));
        } catch (const std::exception& exception) {
            failures_[name] = exception.what();
        }
    }
}

void ErrorBook::improve(const std::string& name, double dual_error) {
    const auto known = references_.find(name);
    if (known != references_.end() && known->second.noise.dual_error > dual_error) {
        known->second = maker_.make(tasks_.at(name), dual_error);
    }
}

const Reference& ErrorBook::reference(const Cell& cell) const {
    const std::string name = cell.convergence->reference.name();
    const auto known = references_.find(name);
    if (known == references_.end()) {
        const auto failure = failures_.find(name);
        throw std::runtime_error("no reference " + name + (failure != failures_.end() ? ": " + failure->second : ""));
    }
    return known->second;
}

double ErrorBook::expected_mse(const Cell& cell, const Film& film) const {
    const Reference& right = reference(cell);
    const std::optional<Errors> errors = errors_of(image_of(film), nullptr, right.first, right.second);
    return errors ? errors->mse_dual * static_cast<double>(film.samples()) / cell.spp : 0;
}

std::string ErrorBook::refusal(const Cell& cell, double expected_mse) const {
    const Reference& right = reference(cell);
    const double allowed = allowed_reference_error * std::max(0.0, expected_mse);
    if (right.noise.dual_error <= allowed) {
        return "";
    }
    const std::string would_do =
        allowed > 0 ? fmt::format("{:.0f} spp a half would do",
                                  std::ceil(static_cast<double>(right.spp_per_half) * right.noise.dual_error / allowed))
                    : std::string("the cell has no error that could be told from it");
    return fmt::format(
        "its reference {} is too noisy with {} spp a half: {:.3g} of error in mse_dual, allowed: {} of the expected "
        "{:.3g}; {} (most_spp: {})",
        right.name, right.spp_per_half, right.noise.dual_error, allowed_reference_error, expected_mse, would_do,
        tasks_.at(right.name).most_spp);
}

ConvergenceFacts ErrorBook::cell_facts(const Cell& cell) const {
    ConvergenceFacts facts{.biases = declared_biases(cell),
                           .checkpoints = cell.convergence->checkpoints,
                           .independent_samples = has_independent_samples(cell.variant, cell.backend),
                           .reference = reference(cell).provenance()};
    for (const auto& [name, definition] : metric_definitions) {
        facts.metrics[std::string(name)] = definition;
    }
    return facts;
}

std::optional<Errors> ErrorBook::errors_at(const Cell& cell, const Hashed& whole, const Hashed& half) {
    const Reference& right = reference(cell);
    const Film& film = whole.snapshot->film;
    const std::string key = fmt::format("{}/{}/{}/{}", right.hash, whole.snapshot->samples, whole.hash, half.hash);
    const auto known = known_.find(key);
    if (known != known_.end()) {
        return known->second;
    }
    std::optional<Errors> errors;
    if (film.faults().nonfinite == 0 && half.snapshot != nullptr) {
        const Halves halves = halves_of(half.snapshot->film, film);
        errors = errors_of(image_of(film), &halves, right.first, right.second);
    } else if (film.faults().nonfinite == 0) {
        errors = errors_of(image_of(film), nullptr, right.first, right.second);
    }
    return known_.emplace(key, errors).first->second;
}

std::vector<CheckpointFacts> ErrorBook::rows(const Cell& cell, const std::vector<Snapshot>& snapshots) {
    const bool has_halves = has_independent_samples(cell.variant, cell.backend);
    std::map<std::uint64_t, Hashed> by_samples;
    std::vector<CheckpointFacts> rows;
    for (const Snapshot& snapshot : snapshots) {
        const Hashed& whole = by_samples[snapshot.samples] = {&snapshot, snapshot.film.hash()};
        const auto half = by_samples.find(snapshot.samples / 2);
        const bool is_half = has_halves && half != by_samples.end() && snapshot.samples % 2 == 0;
        rows.push_back({.spp = snapshot.samples,
                        .wall_ms = snapshot.wall_ms,
                        .device_ms = snapshot.device_ms,
                        .cpu_ms = snapshot.cpu_ms,
                        .film_hash = whole.hash,
                        .nonfinite = snapshot.film.faults().nonfinite});
        rows.back().set_errors(errors_at(cell, whole, is_half ? half->second : Hashed{}));
    }
    return rows;
}

namespace {

constexpr const char* unfinished_suffix = ".unfinished";

}  // namespace

std::string images_folder(const std::string& result_file, bool keeps_earlier) {
    const std::filesystem::path result(result_file);
    const std::string name = result.stem().string() + "_images";
    return (result.parent_path() / (name + (keeps_earlier ? unfinished_suffix : ""))).string();
}

void replace_images(const std::string& result_file, const std::vector<std::string>& earlier) {
    const std::filesystem::path fresh = images_folder(result_file, true);
    const std::filesystem::path old = images_folder(result_file, false);
    if (!std::filesystem::is_directory(fresh)) {
        return;
    }
    for (const std::filesystem::path name : earlier) {
        if (name.parent_path() == old.filename()) {
            std::filesystem::remove(old / name.filename());
        }
    }
    std::filesystem::create_directories(old);
    for (const auto& entry : std::filesystem::directory_iterator(fresh)) {
        std::filesystem::rename(entry.path(), old / entry.path().filename());
    }
    std::filesystem::remove(fresh);
}

ImageFacts write_images(const std::string& images_folder, const Cell& cell, const Reference& reference,
                        const std::vector<Snapshot>& snapshots) {
    const std::filesystem::path folder(images_folder);
    std::string name_of_folder = folder.filename().string();
    if (name_of_folder.ends_with(unfinished_suffix)) {
        name_of_folder.resize(name_of_folder.size() - std::string_view(unfinished_suffix).size());
    }
    const auto keep = [&](const std::string& name, const Image& image) {
        const std::string file = file_name(name) + ".pfm";
        write_pfm({image.begin(), image.end()}, cell.settings.width, cell.settings.height, (folder / file).string());
        return name_of_folder + "/" + file;
    };
    ImageFacts names{.reference = keep("reference/" + reference.name, reference.mean())};
    for (const Snapshot& snapshot : snapshots) {
        names.by_spp[std::to_string(snapshot.samples)] =
            keep(fmt::format("{}/at:{}", cell.name, snapshot.samples), image_of(snapshot.film));
    }
    return names;
}

}  // namespace pt
