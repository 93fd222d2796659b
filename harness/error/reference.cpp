#include "harness/error/reference.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "harness/error/closed_form.h"
#include "harness/error/reference_cache.h"
#include "harness/machine/machine.h"
#include "harness/render/renderer.h"
#include "variants/fnv1a.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

constexpr std::uint64_t first_spp = 64;  // samples per pixel with which each half of a reference image begins

std::string hash_of(const Image& first, const Image& second) {
    const std::uint64_t half = fnv1a_of_bytes(first.data(), first.size() * sizeof(double));
    return fmt::format("{:016x}", fnv1a_of_bytes(second.data(), second.size() * sizeof(double), half));
}

void finish(Reference& reference) {
    reference.noise = noise_of(reference.first, reference.second);
    reference.hash = hash_of(reference.first, reference.second);
}

// Renders one half of a reference image, with this seed, and returns the mean image of the samples [from, to).
Image render_half(const ReferenceTask& task, const Variant& variant, std::uint64_t seed, std::uint64_t from,
                  std::uint64_t to) {
    RenderSettings settings{task.width, task.height, depth_for_mean_of(variant, task.backend, task.depth), seed};
    const RenderResult result = render_named(*task.scene, {.variant = variant,
                                                           .backend = task.backend,
                                                           .settings = settings,
                                                           .first_sample = static_cast<std::uint32_t>(from),
                                                           .samples = static_cast<std::uint32_t>(to - from)});
    if (!result.film.faults().none()) {
        throw std::runtime_error(
            fmt::format("the reference {} has {}", task.name(), faults_text(result.film.faults())));
    }
    return image_of(result.film);
}

// Extends a mean image of `done` samples to `next` samples, of which `more` is the mean image of the additional ones.
void add_samples(Image& mean, const Image& more, std::uint64_t done, std::uint64_t next) {
    if (mean.empty()) {
        mean = more;
        return;
    }
    const double weight = static_cast<double>(next - done) / static_cast<double>(next);
    for (std::size_t i = 0; i < mean.size(); ++i) {
        mean[i] += weight * (more[i] - mean[i]);
    }
}

// Doubles the samples of both halves of a reference image, at most up to the task's most_spp.
void double_samples(Reference& reference, const ReferenceTask& task, const Variant& variant) {
    const std::uint64_t done = reference.spp_per_half;
    const std::uint64_t next = std::min(task.most_spp, std::max(first_spp, 2 * done));
    add_samples(reference.first, render_half(task, variant, reference.seeds[0], done, next), done, next);
    add_samples(reference.second, render_half(task, variant, reference.seeds[1], done, next), done, next);
    reference.spp_per_half = next;
    reference.git_sha = git_sha();
    finish(reference);
}

std::string progress_text(const Reference& reference, const ReferenceTask& task) {
    const std::string wanted = task.variance == any_variance ? "" : fmt::format(" (wanted {:.3g})", task.variance);
    return fmt::format("reference {}: {} spp a half, variance {:.3g}{}", reference.name, reference.spp_per_half,
                       reference.noise.variance, wanted);
}

Reference empty_reference(const ReferenceTask& task) {
    Reference reference;
    reference.name = task.name();
    reference.scene = task.scene->name;
    reference.scene_hash = task.scene->hash;
    reference.width = task.width;
    reference.height = task.height;
    reference.depth = task.depth;
    return reference;
}

}  // namespace

Image image_of(const Film& film) {
    Image image;
    image.reserve(std::size_t{3} * film.width() * film.height());
    for (std::uint32_t pixel = 0; pixel < film.width() * film.height(); ++pixel) {
        const Vec3d radiance = film.pixel(pixel);
        image.insert(image.end(), {radiance.x, radiance.y, radiance.z});
    }
    return image;
}

std::string ReferenceTask::name() const {
    std::string text = fmt::format("{}/{}x{}/depth:{}/{}", scene->name, width, height, depth, to_string(backend));
    for (const auto& [axis, choice] : axes) {
        text += fmt::format("/{}={}", axis, choice);
    }
    return text;
}

Json Reference::provenance() const {
    Json json{{"name", name},
              {"scene", scene},
              {"scene_hash", scene_hash},
              {"resolution", {width, height}},
              {"depth", depth},
              {"kind", is_closed_form ? "closed_form" : "rendered"},
              {"variance", noise.variance},
              {"mean_square", noise.mean_square},
              {"dual_error", noise.dual_error},
              {"hash", hash}};
    if (is_closed_form) {
        json["formula"] = formula;
        return json;
    }
    json["spp_per_half"] = spp_per_half;
    json["variant"] = variant;
    json["backend"] = backend;
    json["seeds"] = {seeds[0], seeds[1]};
    json["git_sha"] = git_sha;
    return json;
}

Image Reference::mean() const {
    Image image = first;
    for (std::size_t i = 0; i < image.size(); ++i) {
        image[i] = 0.5 * (first[i] + second[i]);
    }
    return image;
}

Variant reference_variant(const ReferenceTask& task) {
    const Backend backend = task.backend;
    Variant variant = fast_reference_on(*task.scene, Registry::instance().baseline(backend), backend);
    static constexpr std::pair<std::string_view, std::string_view> wishes[] = {{axes::integrator, "depth_first"},
                                                                               {axes::integrator, "megakernel"},
                                                                               {axes::sampler, "philox"},
                                                                               {axes::arithmetic, "exact"},
                                                                               {axes::precision, "double"}};
    for (const auto& [axis, choice] : wishes) {
        Variant wished = variant;
        wished.set(axis, std::string(choice));
        if (why_not_applicable(wished, features_of(*task.scene), backend).empty()) {
            variant = std::move(wished);
        }
    }
    for (const auto& [axis, choice] : task.axes) {
        variant.set(axis, choice);
    }
    return without_foreign_tunables(variant, backend);
}

std::uint32_t depth_for_mean_of(const Variant& variant, Backend backend, std::uint32_t depth) {
    const std::uint32_t extra = extra_depth(variant, backend);
    return depth > extra ? depth - extra : 0;
}

Reference ReferenceMaker::make(const ReferenceTask& task, double dual_error) const {
    const RenderSettings settings{task.width, task.height, task.depth};
    Reference reference = empty_reference(task);
    if (std::optional<ClosedForm> form = closed_form(*task.scene, settings)) {
        reference.is_closed_form = true;
        reference.formula = form->formula;
        reference.first = reference.second = std::move(form->image);
        finish(reference);
        return reference;
    }
    const Variant variant = reference_variant(task);
    reference.variant = shown_name(variant, task.backend);
    reference.variant_id = variant_id(variant, task.backend);
    reference.backend = to_string(task.backend);
    reference.git_sha = git_sha();
    std::copy(std::begin(reference_seeds), std::end(reference_seeds), reference.seeds);
    const ReferenceCache cache(folder_, hooks_.says);
    if (cache.load(reference)) {
        finish(reference);
    }
    const auto is_good = [&] {
        return reference.spp_per_half > 0 && reference.noise.variance <= task.variance &&
               reference.noise.dual_error <= dual_error;
    };
    std::uint64_t said_spp = reference.spp_per_half;
    const auto say = [&] {
        if (std::exchange(said_spp, reference.spp_per_half) != reference.spp_per_half) {
            hooks_.says(progress_text(reference, task));
        }
    };
    while (!is_good() && reference.spp_per_half < task.most_spp && !hooks_.is_stopped()) {
        const auto start = std::chrono::steady_clock::now();
        double_samples(reference, task, variant);
        cache.store(reference);
        if (std::chrono::steady_clock::now() - start > std::chrono::seconds(5)) {
            say();
        }
    }
    say();
    return reference;
}

std::string default_reference_folder() {
    const auto value = [](const char* name) {
        const char* text = std::getenv(name);
        return std::filesystem::path(text != nullptr ? text : "");
    };
    const std::filesystem::path xdg = value("XDG_CACHE_HOME");
    const std::filesystem::path home = value("HOME");
    const std::filesystem::path caches = !xdg.empty() ? xdg : (home.empty() ? "/tmp" : home) / ".cache";
    return (caches / "ptbench" / "references").string();
}

}  // namespace pt
