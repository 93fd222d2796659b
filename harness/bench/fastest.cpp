#include "harness/bench/fastest.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt {

namespace {

std::vector<std::string> integrators_by_speed(Backend backend) {
    return backend == Backend::cpu ? std::vector<std::string>{"packet", "depth_first"}
                                   : std::vector<std::string>{"persistent", "megakernel"};
}

std::vector<std::string> accelerators_by_speed(Backend backend) {
    return backend == Backend::cpu ? std::vector<std::string>{"bvh8", "bvh2"}
                                   : std::vector<std::string>{"cwbvh", "bvh2"};
}

// The light_sampling for commands that name none: its weights stay bounded close to a light, and no other choice is
// much better on any scene.
constexpr const char* best_light_sampling = "auto";

bool any_applies(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend) {
    const std::vector<Variant> variants = expand(axes, backend, tunables);
    return std::any_of(variants.begin(), variants.end(), [&](const Variant& variant) {
        return why_not_applicable(variant, features_of(scene), backend).empty();
    });
}

}  // namespace

AxisChoices with_tree(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend) {
    if (axes.contains(axes::accelerator) || triangles_of(scene) < fewest_for_a_tree) {
        return axes;
    }
    for (const std::string& accelerator : accelerators_by_speed(backend)) {
        AxisChoices tried = axes;
        tried[axes::accelerator] = {accelerator};
        if (!any_applies(tried, tunables, scene, backend)) {
            continue;
        }
        AxisChoices over_objects = tried;
        const bool has_many = objects_with_meshes(scene) > most_objects_in_turn;
        const bool adds_levels =
            has_many && over_objects.try_emplace(axes::levels, std::vector<std::string>{"two_level"}).second;
        return adds_levels && any_applies(over_objects, tunables, scene, backend) ? over_objects : tried;
    }
    return axes;
}

std::string tree_in_words(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend) {
    std::vector<std::string> added;
    for (const auto& [axis, choices] : with_tree(axes, tunables, scene, backend)) {
        if (!axes.contains(axis)) {
            added.push_back(fmt::format("{}={}", axis, choices.front()));
        }
    }
    return added.empty() ? "" : fmt::format("{} for its {} triangles", fmt::join(added, " and "), triangles_of(scene));
}

Variant with_light_sampling(Variant variant, const AxisChoices& axes, FeatureSet scene, Backend backend) {
    if (axes.contains(axes::light_sampling)) {
        return variant;
    }
    Variant tried = variant;
    tried.set(axes::light_sampling, best_light_sampling);
    return why_not_applicable(tried, scene, backend).empty() ? tried : variant;
}

std::string light_sampling_in_words(const Variant& variant, const AxisChoices& axes) {
    const std::string& choice = variant[axes::light_sampling];
    return axes.contains(axes::light_sampling) || choice != best_light_sampling
               ? ""
               : fmt::format("{}={} for its connections", axes::light_sampling, choice);
}

Variant fastest_variant(const AxisChoices& axes, const TunableValues& tunables, FeatureSet scene, Backend backend) {
    for (const std::string& integrator : integrators_by_speed(backend)) {
        AxisChoices tried = axes;
        tried[axes::integrator] = {integrator};
        const Variant variant = expand(tried, backend, tunables).front();
        if (why_not_applicable(variant, scene, backend).empty()) {
            return variant;
        }
    }
    return expand(axes, backend, tunables).front();
}

}  // namespace pt
