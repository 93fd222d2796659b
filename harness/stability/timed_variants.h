// The kernels that findings time on a GPU: compiled for their scene, by the schedulers of paths that are timed, in each
// arithmetic that rounding bounds hold in, with and without a room's planes. That they are sound has to be shown of
// them, not of the general kernel alone.
#pragma once

#include <vector>

#include "harness/stability/case.h"

namespace pt::stability {

// The variants that are timed with one case. Every scheduler meets every arithmetic in each case (of a quick run: in
// every two), and both of them both values of the room; one of the integrators with a queue at a time, which changes
// with `turn`, the case's number. There are none on a CPU, whose kernels for a scene are among those of the plain runs.
std::vector<Variant> timed_variants(Backend backend, std::size_t turn, bool quick);

}  // namespace pt::stability
