// The choice light_selection=light_tree: lights are selected by a tree over them, at each node a child in proportion to
// what it shows the vertex over its square distance, times a bound on the cosine at the vertex
// (kernels/light_selection.h).
#include "variants/light_selection/light_selection.h"

namespace pt::light_selection::light_tree {
namespace {

const Registration registration(
    {
        .axis = "light_selection",
        .name = "light_tree",
        .summary = "by a tree over the lights, a branch in proportion to what it may send to the vertex",
        .origin = "Conty Estevez and Kulla 2018; boxes and areas by axis for cones",
        .claim = Claim::statistical,
        .claim_note = light_selection_claim,
        .mean_of = "uniform",
        .traits = LightSelectionTraits{.is_uniform = false},
        .backends = on_every_backend,
        .unsupported_reason = light_selection_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::tree_selection; }});

}  // namespace
}  // namespace pt::light_selection::light_tree
