// The accelerator brute_force tests every triangle of a mesh in turn; the other accelerators are verified against it.
#pragma once

#include "kernels/intersect.h"

namespace pt::accelerator::brute_force {

using Traversal = BruteForce;

}  // namespace pt::accelerator::brute_force
