#include "variants/descriptor.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace pt {

WorkCounters& WorkCounters::operator+=(const WorkCounters& other) {
    static constexpr std::uint64_t WorkCounters::*fields[] = {
        &WorkCounters::paths,        &WorkCounters::rays,        &WorkCounters::unfinished_walks,
        &WorkCounters::bounces,      &WorkCounters::compactions, &WorkCounters::compacted_away,
        &WorkCounters::last_bounces, &WorkCounters::last_paths,  &WorkCounters::sorts,
        &WorkCounters::sorted,       &WorkCounters::cache_fills, &WorkCounters::cache_hits,
        &WorkCounters::connections,  &WorkCounters::launches,    &WorkCounters::graph_nodes,
        &WorkCounters::loop_rounds,  &WorkCounters::host_waits};
    static_assert(sizeof(WorkCounters) == std::size(fields) * sizeof(std::uint64_t));
    for (const auto field : fields) {
        this->*field += other.*field;
    }
    return *this;
}

std::size_t Variant::index(std::string_view axis) {
    const auto* found = std::find(std::begin(axis_names), std::end(axis_names), axis);
    if (found == std::end(axis_names)) {
        throw std::out_of_range("no axis '" + std::string(axis) + "'");
    }
    return static_cast<std::size_t>(found - std::begin(axis_names));
}

std::string Variant::name() const {
    std::string joined;
    for (const std::string& choice : choices_) {
        joined += (joined.empty() ? "" : ".") + choice;
    }
    for (const auto& [tunable, value] : tuning) {
        joined += "+" + tunable + "=" + std::to_string(value);
    }
    return joined;
}

std::string_view to_string(Claim claim) {
    switch (claim) {
        case Claim::bitwise:
            return "bitwise";
        case Claim::statistical:
            return "statistical";
        default:
            return "biased";
    }
}

std::string_view to_string(Backend backend) { return backend == Backend::cpu ? "cpu" : "cuda"; }

std::vector<std::string> feature_names(FeatureSet features) {
    static constexpr const char* names[] = {"sphere",
                                            "ellipsoid",
                                            "axis_box",
                                            "oriented_box",
                                            "quad",
                                            "motion",
                                            "diffuse",
                                            "emitter",
                                            "mirror",
                                            "mix",
                                            "dielectric",
                                            "subsurface",
                                            "emission",
                                            "absorption",
                                            "subsurface_boundary",
                                            "environment",
                                            "jitter",
                                            "lens",
                                            "final_bounce",
                                            "next_event",
                                            "multiple_importance",
                                            "russian_roulette",
                                            "enclosure",
                                            "matrix",
                                            "philox",
                                            "sobol_owen",
                                            "minstd",
                                            "double_intersection",
                                            "naive",
                                            "near_sphere"};
    static_assert((all_features | shortcuts | Feature::matrix | samplers | formulas) == (1u << std::size(names)) - 1u);
    std::vector<std::string> present;
    for (std::size_t bit = 0; bit < std::size(names); ++bit) {
        if ((features >> bit & 1u) != 0) {
            present.emplace_back(names[bit]);
        }
    }
    return present;
}

}  // namespace pt
