// The variants that findings time on a GPU: kernels compiled for their scene, with each scheduler of paths, in each
// arithmetic with rounding bounds, with and without the planes of a room. Stability must be shown for these kernels
// themselves, not for the generic kernel alone.
#pragma once

#include <vector>

#include "harness/stability/case.h"

namespace pt::stability {

// The timed variants with which one stability case runs: every arithmetic with every integrator that findings time (of
// those with a queue only one, by `turn`), alternately with and without the planes of a room. A quick run takes every
// second pair. `turn`: the case's number. Empty on a CPU, where other variants cover the same kernels.
std::vector<Variant> timed_variants(Backend backend, std::size_t turn, bool quick);

}  // namespace pt::stability
