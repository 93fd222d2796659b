#include "harness/cli/verify_arguments.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "harness/bench/suite.h"

namespace pt {

namespace {

// Seconds after which `ptbench verify --quiet` shows progress all the same.
constexpr double patience = 5;

}  // namespace

RenderSettings settings_of(const Scene& scene, const VerifyArguments& arguments) {
    RenderSettings settings = default_settings(scene);
    std::tie(settings.width, settings.height) = parse_resolution(arguments.size());
    settings.depth = arguments.depth != 0 ? arguments.depth : scene.max_depth;
    settings.seed = arguments.seed;
    return settings;
}

void NotApplicableLines::add(const std::string& variant, const std::string& reason) {
    variants_ += 1;
    const auto known = std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.reason == reason; });
    if (known == groups_.end()) {
        groups_.push_back({reason, variant, 1});
    } else {
        known->variants += 1;
    }
}

void NotApplicableLines::print(const std::string& scene) const {
    for (const Group& group : groups_) {
        fmt::print("n/a              {} on {}: {}\n",
                   group.variants == 1 ? group.first : fmt::format("{} and {} more", group.first, group.variants - 1),
                   scene, group.reason);
    }
}

Progress progress_of(std::size_t steps, const VerifyArguments& arguments) {
    return {"verify", steps, arguments.quiet ? Progress::Lines::shown : Progress::Lines::hidden, patience};
}

}  // namespace pt
