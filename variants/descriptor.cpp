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

std::size_t Variant::place(std::string_view axis) {
    // Most callers pass an element of axis_names itself, so comparing the names' addresses usually suffices.
    const auto* found = std::find_if(axis_names.begin(), axis_names.end(),
                                     [&](std::string_view name) { return name.data() == axis.data(); });
    if (found == axis_names.end() || *found != axis) {
        found = std::find(axis_names.begin(), axis_names.end(), axis);
    }
    return static_cast<std::size_t>(found - axis_names.begin());
}

std::size_t Variant::index(std::string_view axis) {
    const std::size_t found = place(axis);
    if (found == axis_count) {
        throw std::out_of_range("no axis '" + std::string(axis) + "'");
    }
    return found;
}

std::string Variant::spelled_out() const {
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

namespace {

struct NamedFeature {
    Feature feature;
    const char* name;
};

// The features with their names, in the order in which results list them.
constexpr NamedFeature named_features[] = {
#define PT_NAMED(name, array, Type) {Feature::name, #name},
    PT_SHAPES(PT_NAMED)
#undef PT_NAMED
        {Feature::motion, "motion"},
#define PT_NAMED(name, Type, traits) {Feature::name, #name},
    PT_MATERIALS(PT_NAMED)
#undef PT_NAMED
        {Feature::emission, "emission"},
    {Feature::absorption, "absorption"},
    {Feature::subsurface_boundary, "subsurface_boundary"},
    {Feature::multiple_scattering, "multiple_scattering"},
    {Feature::environment, "environment"},
    {Feature::jitter, "jitter"},
    {Feature::lens, "lens"},
    {Feature::final_bounce, "final_bounce"},
    {Feature::next_event, "next_event"},
    {Feature::multiple_importance, "multiple_importance"},
    {Feature::area_sampling, "area_sampling"},
    {Feature::projected_sampling, "projected_sampling"},
    {Feature::automatic_sampling, "automatic_sampling"},
    {Feature::power_selection, "power_selection"},
    {Feature::tree_selection, "tree_selection"},
    {Feature::one_sample, "one_sample"},
    {Feature::environment_map, "environment_map"},
    {Feature::russian_roulette, "russian_roulette"},
    {Feature::adjoint_roulette, "adjoint_roulette"},
    {Feature::splitting, "splitting"},
    {Feature::enclosure, "enclosure"},
    {Feature::matrix, "matrix"},
#define PT_NAMED(name) {Feature::name, #name},
    PT_SAMPLERS(PT_NAMED)
#undef PT_NAMED
        {Feature::double_intersection, "double_intersection"},
    {Feature::naive, "naive"},
    {Feature::near_sphere, "near_sphere"},
    {Feature::textures, "textures"},
    {Feature::shading_normals, "shading_normals"},
    {Feature::object_tree, "object_tree"},
    {Feature::flat_tree, "flat_tree"},
    {Feature::guided_walk, "guided_walk"},
};

constexpr FeatureSet all_named() {
    FeatureSet set = no_features;
    for (const NamedFeature& named : named_features) {
        set |= static_cast<FeatureSet>(named.feature);
    }
    return set;
}
static_assert(all_named() == (all_features | traversals | mesh_levels | shortcuts | Feature::matrix | samplings |
                              formulas | path_trees));

}  // namespace

std::vector<std::string> feature_names(FeatureSet features) {
    std::vector<std::string> present;
    for (const auto& [feature, name] : named_features) {
        if (contains(features, feature)) {
            present.emplace_back(name);
        }
    }
    return present;
}

}  // namespace pt
