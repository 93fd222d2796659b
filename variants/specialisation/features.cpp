// The kernel that contains what the scene needs and as little else as possible. On the CPU kernels are compiled ahead
// of time, for the feature sets in cpu_feature_sets.txt; another scene gets the smallest of them that has all it needs,
// and the output names what was compiled in for nothing.
#include "variants/specialisation/smallest_superset.h"

namespace pt::specialisation::features {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "features",
        .summary = "a kernel with only the features that the scene needs",
        .origin = "Cycles' kernel feature masks",
        .baseline = on_every_backend,
        .backends = on_every_backend,
        .tunables = feature_tunables,
    },
    {.specialisation = smallest_superset});

}  // namespace
}  // namespace pt::specialisation::features
