// How a kernel is chosen that has what the scene needs and as little else as possible.
#pragma once

#include <bit>

#include "variants/registry.h"

namespace pt {

inline constexpr Tunable feature_tunables[] = {
    {"room", 1, 0, 1, 1,
     "1: a ray in a room of axis-aligned walls meets the planes of its sides, not every wall's slabs"},
};

// The least surplus counts first, then the most shortcuts.
inline FeatureSet smallest_superset(const KernelOffer& offer, const Variant& variant, Backend backend) {
    const FeatureSet allowed = tunable(variant, "room", backend) != 0 ? offer.shortcuts : no_features;
    FeatureSet best = all_features;
    const auto surplus = [](FeatureSet set) { return std::popcount(set & all_features); };
    for (const FeatureSet candidate : offer.compiled) {
        const bool fits = is_superset(candidate, offer.needed) && is_superset(all_features | allowed, candidate);
        if (fits && (surplus(candidate) < surplus(best) ||
                     (surplus(candidate) == surplus(best) && std::popcount(candidate) > std::popcount(best)))) {
            best = candidate;
        }
    }
    return best;
}

}  // namespace pt
