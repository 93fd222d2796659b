// Chooses a kernel that has what the scene needs and as little else as possible.
#pragma once

#include <bit>

#include "variants/registry.h"

namespace pt {

inline constexpr Tunable feature_tunables[] = {
    {.name = "room",
     .default_value = 1,
     .lowest = 0,
     .highest = 1,
     .summary = "1: a ray in a room of axis-aligned walls meets the planes of its sides, not every wall's slabs",
     .is_shortcut = true},
};

inline constexpr FeatureSet only_where_asked = formulas | traversals | mesh_levels | path_trees;

// Returns the features of a kernel for all scenes: every feature of scenes and estimators (meshes only where the scene
// has one), formulas and path trees that the variant asks for, and the fewest samplings that serve the variant. The
// last three do not depend on the scene.
inline FeatureSet every_feature(const KernelOffer& offer) {
    FeatureSet best = all_features | samplings | (offer.needed & only_where_asked);
    for (const FeatureSet candidate : offer.compiled) {
        const bool fits = is_superset(candidate, all_features | offer.needed) && is_superset(best, candidate);
        best = fits ? candidate : best;
    }
    return best;
}

// Whether a kernel samples as the variant asks, in one of `ways`: the kernel has none of them, or chooses among several
// at run time, or has exactly that one. A kernel with one way alone does nothing else.
inline bool does_as_asked(FeatureSet candidate, FeatureSet needed, FeatureSet ways) {
    const FeatureSet compiled = candidate & ways;
    return std::popcount(compiled) != 1 || compiled == (needed & ways);
}

// Picks the compiled kernel with the fewest features beyond those needed and, among those, the most shortcuts.
inline FeatureSet smallest_superset(const KernelOffer& offer, const Variant& variant, Backend backend) {
    const FeatureSet allowed = tunable(variant, "room", backend) != 0 ? offer.shortcuts : no_features;
    FeatureSet best = every_feature(offer);
    const auto surplus = [](FeatureSet set) { return std::popcount(set & (all_features | samplings)); };
    for (const FeatureSet candidate : offer.compiled) {
        const bool fits =
            is_superset(candidate, offer.needed) && does_as_asked(candidate, offer.needed, light_samplings) &&
            does_as_asked(candidate, offer.needed, light_selections) &&
            is_superset(all_features | samplings | allowed | (offer.needed & only_where_asked), candidate);
        if (fits && (surplus(candidate) < surplus(best) ||
                     (surplus(candidate) == surplus(best) && std::popcount(candidate) > std::popcount(best)))) {
            best = candidate;
        }
    }
    return best;
}

}  // namespace pt
