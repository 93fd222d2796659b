#include "harness/cli/render_aovs.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/commands.h"
#include "harness/render/checkpoints.h"
#include "harness/render/first_hits.h"
#include "harness/say.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

constexpr std::array<std::string_view, 6> aov_names{"albedo", "normal", "depth", "coverage", "samples", "variance"};
constexpr std::uint64_t most_rays_unmentioned = 1 << 23;  // more camera rays take seconds, so a message announces them
constexpr std::array<std::string_view, 4> aovs_of_first_hits{"albedo", "normal", "depth", "coverage"};

// Whether the scatter of batches estimates the variance of the mean without bias: samples must be independent, so
// neither a low-discrepancy sampler nor a first-bounce cache of several camera rays, which samples share, may be used.
bool has_unbiased_variance(const RenderRequest& request) {
    const auto& cache = Registry::instance().at(axes::first_bounce, request.variant, request.backend).hook.first_bounce;
    return has_independent_samples(request.variant, request.backend) && cache(request.variant, request.backend) <= 1;
}

}  // namespace

std::vector<std::string> names_of_aovs() { return {aov_names.begin(), aov_names.end()}; }

std::string aov_names_text() { return fmt::format("{}", fmt::join(aov_names, ", ")); }

RenderAovs RenderAovs::parse(const std::string& text) {
    RenderAovs aovs;
    if (text.empty()) {
        return aovs;
    }
    if (text == "all") {
        aovs.names_.assign(aov_names.begin(), aov_names.end());
        return aovs;
    }
    aovs.names_ = split_names(text, "--aovs");
    for (const std::string& name : aovs.names_) {
        if (std::find(aov_names.begin(), aov_names.end(), name) == aov_names.end()) {
            throw InputError("--aovs", "argument", "\"" + name + "\"", aov_names_text() + ", or all");
        }
    }
    return aovs;
}

bool RenderAovs::has(std::string_view name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
}

void RenderAovs::check(const std::string& file, const RenderRequest& request) const {
    if (none()) {
        return;
    }
    if (!file.ends_with(".exr")) {
        throw InputError("--aovs", "argument", "--out \"" + file + "\"",
                         "a name that ends in .exr, whose layers they are");
    }
    if (depends_on_order(request.variant, request.backend)) {
        throw InputError("--aovs", "argument", shown_name(request.variant, request.backend),
                         "a variant whose random numbers do not follow the order of a queue: its camera rays are not "
                         "known outside the render");
    }
    if (has("variance") && stops_change_film(request.variant, request.backend)) {
        throw InputError("--aovs", "argument", "variance of " + shown_name(request.variant, request.backend),
                         "a variant whose film has the same bits if the render stops on the way");
    }
    if (has("variance") && request.samples < 2) {
        throw InputError("--aovs", "argument", "variance with --spp 1", "--spp 2 or more: one sample has no spread");
    }
}

std::vector<ExrLayer> RenderAovs::layers(const Scene& scene, const RenderRequest& request, const RenderResult& result,
                                         nlohmann::ordered_json& summary) const {
    std::vector<ExrLayer> layers;
    if (none()) {
        return layers;
    }
    nlohmann::ordered_json facts{{"names", names_}};
    if (std::any_of(aovs_of_first_hits.begin(), aovs_of_first_hits.end(), [&](auto name) { return has(name); })) {
        const std::uint64_t pixels = std::uint64_t{result.film.width()} * result.film.height();
        if (const std::uint64_t rays = pixels * std::min(request.samples, most_first_hit_rays);
            rays > most_rays_unmentioned) {
            say("render: what {:.0f} million camera rays meet first, on the CPU\n", 1e-6 * static_cast<double>(rays));
        }
        const auto start = std::chrono::steady_clock::now();
        FirstHits hits = first_hits(scene, request);
        facts["camera_rays"] = hits.rays;
        facts["first_hit_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const auto add = [&](const char* name, const char* channels, std::vector<float>& values) {
            if (has(name)) {
                layers.push_back({name, channels, std::move(values)});
            }
        };
        add("albedo", "RGB", hits.albedo);
        add("normal", "XYZ", hits.normal);
        add("depth", "Z", hits.depth);
        add("coverage", "Y", hits.coverage);
    }
    if (has("samples")) {
        const std::size_t pixels = std::size_t{result.film.width()} * result.film.height();
        layers.push_back({"samples", "Y", std::vector<float>(pixels, static_cast<float>(result.film.samples()))});
    }
    if (has("variance")) {
        layers.push_back({"variance", "RGB", variance_.of_mean()});
        facts["variance_batches"] = variance_.batches();
        facts["variance_unbiased"] = has_unbiased_variance(request);
    }
    summary["aovs"] = facts;
    return layers;
}

}  // namespace pt
