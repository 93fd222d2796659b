// The choices for a command that names none on an axis: the fastest ones known on its backend.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

// The number of triangles in a scene from which on a command that names no accelerator gets an acceleration tree.
// Smaller scenes test every triangle in turn, as the baseline does.
inline constexpr std::uint64_t fewest_for_a_tree = 256;

// Adds the accelerator that was found to be fastest on large meshes, if it applies together with the other choices, the
// scene has at least fewest_for_a_tree triangles and `axes` names no accelerator. With more than most_objects_in_turn
// mesh objects, adds a top-level tree too, unless `axes` names `levels`.
AxisChoices with_tree(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend);

// The choices that with_tree added, as "accelerator=bvh8 for its 81920 triangles"; empty if it added none.
std::string tree_in_words(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend);

// Returns `variant` with the light_sampling that was found to leave the least error in a given time
// (docs/findings/error_against_time.md), or `variant` itself where `axes` names light_sampling or that choice does not
// apply.
Variant with_light_sampling(Variant variant, const AxisChoices& axes, FeatureSet scene, Backend backend);

// The choice that with_light_sampling made, as "light_sampling=auto for its connections"; empty if it made none.
std::string light_sampling_in_words(const Variant& variant, const AxisChoices& axes);

// The variant with the fastest integrator (docs/findings/cpu.md, docs/findings/schedulers.md) that applies to the scene
// with the given choices and tunables, and all else at the baseline; the baseline integrator where none applies.
// Precondition: one choice per axis, one value per tunable, and no integrator among them.
Variant fastest_variant(const AxisChoices& axes, const TunableValues& tunables, FeatureSet scene, Backend backend);

}  // namespace pt
