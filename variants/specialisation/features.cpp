// The kernel that contains what the scene needs and as little else as possible. On the CPU kernels are compiled ahead
// of time, for the feature sets in cpu_feature_sets.txt; another scene gets the smallest of them that has all it needs,
// and the output names what was compiled in for nothing.
#include <bit>

#include "variants/registry.h"

namespace pt {
namespace {

FeatureSet smallest_superset(FeatureSet needed, const std::vector<FeatureSet>& compiled) {
    FeatureSet best = all_features;
    for (const FeatureSet candidate : compiled) {
        if (is_superset(candidate, needed) && std::popcount(candidate) < std::popcount(best)) {
            best = candidate;
        }
    }
    return best;
}

const Registration registration(
    {
        .axis = "specialisation",
        .name = "features",
        .summary = "a kernel with only the features that the scene needs",
        .origin = "Cycles' kernel feature masks",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {.specialisation = smallest_superset});

}  // namespace
}  // namespace pt
