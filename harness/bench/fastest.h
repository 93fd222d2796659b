// The variant that renders an image where the call names no integrator: the fastest that is known of its backend.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

// Integrators by speed, as docs/findings/cpu.md and docs/findings/schedulers.md found them. Of these the first that
// applies to the scene together with the choices and tunables of `axes` and `tunables`, all else at its baseline; where
// none does, the baseline. Precondition: one choice an axis, one value a tunable, and no integrator among them.
Variant fastest_variant(const AxisChoices& axes, const TunableValues& tunables, FeatureSet scene, Backend backend);

}  // namespace pt
