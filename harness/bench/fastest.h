// The choices of a call that leaves them open: the fastest that are known of its backend.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

// Triangles of all objects together from which on a call that names no accelerator gets a tree. With fewer every
// triangle is tried in turn, as the baseline does.
inline constexpr std::uint64_t fewest_for_a_tree = 256;

// `axes` with the accelerator that was found to be fastest over large meshes, of those that go with the rest, if the
// scene has that many triangles and `axes` names none; beyond most_objects_in_turn objects with meshes also with a tree
// over them, unless `axes` names `levels`. Else `axes`.
AxisChoices with_tree(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend);

// What with_tree added, for people: "accelerator=bvh8 for its 81920 triangles"; empty: nothing.
std::string tree_in_words(const AxisChoices& axes, const TunableValues& tunables, const Scene& scene, Backend backend);

// `variant` with points on lights drawn by the choice that was found to leave the least error in a time
// (docs/findings/error_against_time.md), if it connects vertices to lights, `axes` names no light_sampling, and that
// choice applies to the scene. Else `variant`.
Variant with_light_sampling(Variant variant, const AxisChoices& axes, FeatureSet scene, Backend backend);

// What with_light_sampling added to this variant, for people: "light_sampling=auto for its connections"; empty:
// nothing.
std::string light_sampling_in_words(const Variant& variant, const AxisChoices& axes);

// Integrators by speed, as docs/findings/cpu.md and docs/findings/schedulers.md found them. Of these the first that
// applies to the scene together with the choices and tunables of `axes` and `tunables`, all else at its baseline; where
// none does, the baseline. Precondition: one choice an axis, one value a tunable, and no integrator among them.
Variant fastest_variant(const AxisChoices& axes, const TunableValues& tunables, FeatureSet scene, Backend backend);

}  // namespace pt
