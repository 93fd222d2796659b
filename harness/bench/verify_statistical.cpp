#include "harness/bench/verify_statistical.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/error/reference.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// Whether two variants draw their samples in the same way, so that a pixel's samples are black equally often.
bool samples_alike(const Variant& a, const Variant& b) {
    return std::all_of(std::begin(axis_table), std::end(axis_table),
                       [&](const Axis& axis) { return a[axis.key] == b[axis.key] || !axis.decides_samples; });
}

const Descriptor& descriptor_at(std::string_view axis, const Variant& variant, Backend backend) {
    return Registry::instance().at(axis, variant, backend).descriptor;
}

// The number of equal parts into which a run's samples are divided: the largest divisor up to 8, or `spp` itself if it
// has none above 1.
std::uint32_t parts_of(std::uint32_t spp) {
    for (std::uint32_t parts = 8; parts > 1; --parts) {
        if (spp % parts == 0) {
            return parts;
        }
    }
    return spp;
}

}  // namespace

MeanClaim claim_of_mean(const Variant& variant, std::uint32_t depth, Backend backend) {
    Variant plain = variant;
    for (const std::string_view axis : axis_names) {
        while (descriptor_at(axis, plain, backend).claim == Claim::statistical) {
            plain.set(axis, std::string(descriptor_at(axis, plain, backend).mean_of));
        }
    }
    return claim_against(variant, Registry::instance().reference(plain, backend), depth, backend);
}

MeanClaim claim_against(const Variant& variant, const Variant& baseline, std::uint32_t depth, Backend backend) {
    const std::uint32_t extra = extra_depth(variant, backend), baseline_extra = extra_depth(baseline, backend);
    const std::uint32_t expected = std::max(depth + extra, 1 + baseline_extra);
    return {variant, baseline, expected - extra, expected - baseline_extra,
            extra == baseline_extra && samples_alike(variant, baseline)};
}

ImageRuns StatisticalVerifier::render_runs(const Variant& variant, std::uint32_t depth,
                                           std::uint64_t first_seed) const {
    ImageRuns runs(settings_.width, settings_.height);
    const std::uint32_t parts = parts_of(effort_.spp);
    for (std::uint32_t run = 0; run < effort_.runs; ++run) {
        std::vector<Radiance> images;
        for (std::uint32_t part = 0; part < parts; ++part) {
            RenderRequest request{.variant = variant, .backend = backend_, .settings = settings_};
            request.settings.depth = depth;
            request.settings.seed = first_seed + run;
            request.samples = effort_.spp / parts;
            request.first_sample = part * request.samples;
            const RenderResult result = render_named(scene_, request);
            if (!result.film.faults().none()) {
                throw std::runtime_error(faults_text(result.film.faults()) + " of " + shown_name(variant, backend_));
            }
            images.push_back(image_of(result.film));
        }
        runs.add(images);
    }
    return runs;
}

const ImageRuns& StatisticalVerifier::baseline_runs(const Variant& variant, std::uint32_t depth) {
    const auto key = std::pair(variant, depth);
    const auto known = baselines_.find(key);
    return known != baselines_.end()
               ? known->second
               : baselines_.emplace(key, render_runs(variant, depth, settings_.seed + effort_.runs)).first->second;
}

MeanVerdict StatisticalVerifier::check(const MeanClaim& claim) {
    const ImageRuns& baseline = baseline_runs(claim.baseline, claim.baseline_depth);
    const ImageRuns tested = render_runs(claim.tested, claim.depth, settings_.seed);
    const SameMeanReport report =
        test_same_mean(tested, baseline, {.family_error = effort_.family_error, .same_sampling = claim.same_sampling});
    const std::string against =
        fmt::format("{} at depth {}", shown_name(claim.baseline, backend_), claim.baseline_depth);
    if (report.same()) {
        return {true, fmt::format("same mean as {}: {}", against, report.text())};
    }
    const Statistic& strongest = report.strongest();
    // The last statistic tests whether samples are independent; they may repeat errors although their mean is right.
    const bool dependent = &strongest == &report.statistics.back();
    return {false, fmt::format("{} {}: {} ({}): {}",
                               dependent ? "samples are not independent, tested with" : "not the mean of", against,
                               strongest.name, strongest.where, report.text())};
}

}  // namespace pt
