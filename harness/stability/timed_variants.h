// The variants that findings time on a GPU: kernels compiled for their scene, with each scheduler of paths, in each
// arithmetic with rounding bounds, with and without the planes of a room. Stability must be shown for these kernels
// themselves, not for the generic kernel alone.
#pragma once

#include <vector>

#include "harness/stability/case.h"

namespace pt::stability {

// The timed variants to be checked with one case: every scheduler with every arithmetic (in a quick run every second
// pair, alternating with `turn`), with and without the room in turn. Of the integrators with a queue one is taken,
// which changes with `turn`, the number of the case. Empty on a CPU, where the plain runs cover the kernels for a
// scene.
std::vector<Variant> timed_variants(Backend backend, std::size_t turn, bool quick);

}  // namespace pt::stability
