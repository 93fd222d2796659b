// The variants that findings time on a GPU: kernels compiled for their scene, with each scheduler of paths, in each
// arithmetic with rounding bounds, with and without the planes of a room. Stability must be shown for these kernels
// themselves, not for the generic kernel alone.
#pragma once

#include <vector>

#include "harness/stability/case.h"

namespace pt::stability {

// The timed variants with which one stability case runs: every arithmetic with every integrator that findings time (of
// integrators with a queue only one, chosen by `turn`), alternately with and without the planes of a room (an enclosing
// box). In a quick run every second one. `turn`: the case's number. Empty on a CPU: other variants cover its kernels.
std::vector<Variant> timed_variants(Backend backend, std::size_t turn, bool quick);

}  // namespace pt::stability
