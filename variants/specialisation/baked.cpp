// The choice specialisation=baked: as `features`, with the scene's numbers as constants of the kernel, which is the
// most that leaving out can bring. Every scene has its own kernel, so a kernel must be compiled at run time.
#include "variants/registry.h"
#include "variants/specialisation/smallest_superset.h"

namespace pt::specialisation::baked {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "baked",
        .summary = "as features, with the scene's geometry, materials and lights as constants of the kernel",
        .origin = "the constant folding of a compiler, given the numbers",
        .backends = on_cuda,
        .tunables = feature_tunables,
    },
    {.specialisation = smallest_superset, .cuda = {.bakes_scene = true}});

}  // namespace
}  // namespace pt::specialisation::baked
